"""Finite element reference of a scene at the points of one batch."""

from bondcell.jobs.batch import Batch
from bondcell.jobs.batch_files import describe, write_batch
from bondcell.jobs.job import job
from bondcell.jobs.job_bounds import Bounds
from bondcell.jobs.reference_batch import compute_reference
from bondcell.scenes.planned_scene import planned_scene
from bondcell.scenes.study import build_study

batch = Batch.parse(f"fe_{snakemake.wildcards.bc}_{snakemake.wildcards.part}")
bound = snakemake.resources
bounds = Bounds(60 * bound.runtime, bound.mem_mb, bound.attempt, bound.attempts)
with job(f"{snakemake.wildcards.scene}: {batch.name}") as log, bounds.held():
    digest = snakemake.params.digest
    scene = planned_scene(snakemake.input.scene, reference_digest=digest)
    tolerance = scene.reference.tolerance
    result = compute_reference(build_study(scene), batch, tolerance, log.progress, bounds)
    write_batch(result, snakemake.output[0], digest)
    log.result = describe(result)
