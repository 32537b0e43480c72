"""Error of each model against the reference."""

from bondcell.accuracy import accuracy_table
from bondcell.jobs import job
from bondcell.storage import read_dataset, replacing

with job(f"{snakemake.wildcards.scene}: accuracy.csv") as log:
    table = accuracy_table(read_dataset(snakemake.input.study))
    with replacing(snakemake.output[0]) as path:
        table.to_csv(path, index=False)
    log.result = f"{len(table)} rows"
