"""Error, work and observed order of each discretisation."""

from bondcell.convergence import convergence_table
from bondcell.jobs import job
from bondcell.storage import read_dataset, replacing

with job(f"{snakemake.wildcards.scene}: convergence.csv") as log:
    table = convergence_table(read_dataset(snakemake.input.study, "convergence"))
    with replacing(snakemake.output[0]) as path:
        table.to_csv(path, index=False)
    log.result = f"{len(table)} rows"
