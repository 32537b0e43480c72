"""Error by region, the cheapest good models, error against run time of an atlas."""

from bondcell.jobs.job import job
from bondcell.results.atlas import atlas_tables
from bondcell.results.load_groups import read_loads
from bondcell.storage import replacing

with job(f"{snakemake.wildcards.scene}: atlas tables") as log:
    tables = atlas_tables(read_loads(snakemake.input.study))
    for target, (_, table) in zip(snakemake.output, tables, strict=True):
        with replacing(target) as path:
            table.to_csv(path, index=False)
        log.result = f"{len(table)} rows"
