"""Analytic models of a scene at the points of one batch."""

from bondcell.jobs.analytic_batch import compute_analytic
from bondcell.jobs.batch_files import describe, write_batch
from bondcell.jobs.job import job
from bondcell.jobs.manifest import read_entry

with job(f"{snakemake.wildcards.scene}: {snakemake.params.batch}") as log:
    batch = read_entry(snakemake.params.entry)
    result = compute_analytic(batch)
    write_batch(result, snakemake.output[0], batch.name)
    log.result = describe(result)
