"""The bonds' own series of a scene, for discrete element codes."""

from bondcell.jobs.job import job
from bondcell.results.load_groups import read_loads
from bondcell.results.relaxation_bonds import bond_series, bond_table
from bondcell.scenes.planned_scene import planned_scene
from bondcell.storage import replacing, write_dataset

with job(f"{snakemake.wildcards.scene}: bond_series.csv") as log:
    scene = planned_scene(snakemake.input.scene, digest=snakemake.params.digest)
    series = bond_series(scene, read_loads(snakemake.input.study)[scene.load])
    table = bond_table(series)
    write_dataset(series, snakemake.output.netcdf)
    with replacing(snakemake.output.csv) as path:
        table.to_csv(path, index=False)
    log.result = f"{len(table)} rows"
