"""Every point of the reference with its estimate, flag and cost, worst first."""

from bondcell.jobs.job import job
from bondcell.results.load_groups import read_loads
from bondcell.results.stability import stability_table
from bondcell.storage import replacing

with job(f"{snakemake.wildcards.scene}: stability.csv") as log:
    table = stability_table(read_loads(snakemake.input.study))
    with replacing(snakemake.output[0]) as path:
        table.to_csv(path, index=False)
    log.result = f"{len(table)} rows"
