"""Accuracy over time, or stability, of a scene's relaxation."""

from bondcell.jobs.job import job
from bondcell.results.load_groups import read_loads
from bondcell.results.relaxation_tables import accuracy_over_time, relaxation_stability
from bondcell.storage import replacing

kinds = {"accuracy_over_time": accuracy_over_time, "relaxation_stability": relaxation_stability}
name = snakemake.params.table
with job(f"{snakemake.wildcards.scene}: {name}.csv") as log:
    table = kinds[name](read_loads(snakemake.input.study))
    with replacing(snakemake.output[0]) as path:
        table.to_csv(path, index=False)
    log.result = f"{len(table)} rows"
