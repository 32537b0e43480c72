"""The fullest lattice of a specimen under one loading, for ParaView."""

from bondcell.jobs.job import job
from bondcell.specimen.view import first_walls, fullest
from bondcell.specimen.vtk import write_lattice_result
from bondcell.storage import read_dataset, replacing

with job(f"{snakemake.wildcards.scene}: lattice, {snakemake.wildcards.loading}"):
    study, bonds = (read_dataset(snakemake.input.study, group) for group in (None, "bonds"))
    chosen = {"method": fullest(study), "walls": first_walls(study)}
    at = {**chosen, "loading": snakemake.wildcards.loading}
    with replacing(snakemake.output[0]) as path:
        write_lattice_result(path, study.sel(at), bonds.sel(at))
