"""Error of each model against the reference."""

from bondcell.jobs.job import job
from bondcell.results.accuracy import accuracy_of_loads
from bondcell.results.load_groups import read_loads
from bondcell.storage import replacing

with job(f"{snakemake.wildcards.scene}: accuracy.csv") as log:
    table = accuracy_of_loads(read_loads(snakemake.input.study))
    with replacing(snakemake.output[0]) as path:
        table.to_csv(path, index=False)
    log.result = f"{len(table)} rows"
