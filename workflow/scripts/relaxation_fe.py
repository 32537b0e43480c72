"""Relaxation by the finite element reference at the points of one batch."""

import bondcell.fem.relaxing_reference  # noqa: F401  (an edit of it runs this job again)
from bondcell.jobs.batch_files import write_batch
from bondcell.jobs.job import job
from bondcell.jobs.manifest import read_entry
from bondcell.jobs.relaxation_batch import compute_relaxation
from bondcell.scenes.planned_scene import planned_scene

with job(f"{snakemake.wildcards.scene}: {snakemake.params.batch}") as log:
    log.unit = "geometries"
    batch = read_entry(snakemake.params.entry)
    options = dict(batch.rows[0].options)
    scene = planned_scene(snakemake.input.scene, prony_digest=options["prony"])
    result = compute_relaxation(batch, scene.prony, log.progress)
    write_batch(result, snakemake.output[0], batch.name)
    log.result = f"{result.sizes['series']} series at {result.sizes['point']} points"
