"""Error of each model against the reference."""

from bondcell.accuracy import accuracy_of_loads
from bondcell.jobs import job
from bondcell.load_groups import read_loads
from bondcell.storage import replacing

with job(f"{snakemake.wildcards.scene}: accuracy.csv") as log:
    table = accuracy_of_loads(read_loads(snakemake.input.study))
    with replacing(snakemake.output[0]) as path:
        table.to_csv(path, index=False)
    log.result = f"{len(table)} rows"
