"""Finite element reference of a scene at the points of one batch."""

from bondcell.jobs.batch_files import describe, write_batch
from bondcell.jobs.job import job
from bondcell.jobs.job_bounds import Bounds
from bondcell.jobs.manifest import read_entry
from bondcell.jobs.reference_batch import compute_reference

bound = snakemake.resources
bounds = Bounds(60 * bound.runtime, bound.mem_mb, bound.attempt, bound.attempts)
with job(f"{snakemake.wildcards.scene}: {snakemake.params.batch}") as log, bounds.held():
    batch = read_entry(snakemake.params.entry)
    result = compute_reference(batch, log.progress, bounds)
    write_batch(result, snakemake.output[0], batch.name)
    log.result = describe(result)
