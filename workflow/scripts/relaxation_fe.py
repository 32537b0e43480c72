"""Relaxation by the finite element reference at the points of one batch."""

import bondcell.fem.relaxing_reference  # noqa: F401  (an edit of it runs this job again)
from bondcell.jobs.batch import Batch
from bondcell.jobs.batch_files import write_batch
from bondcell.jobs.job import job
from bondcell.jobs.relaxation_batch import asked_fe, compute_relaxation
from bondcell.scenes.planned_scene import planned_scene
from bondcell.scenes.study import build_study

load = snakemake.wildcards.load
batch = Batch.parse(f"relaxation_fe_{load}_{snakemake.wildcards.part}")
with job(f"{snakemake.wildcards.scene}: {batch.name}") as log:
    log.unit = "geometries"
    digest = snakemake.params.digest
    scene = planned_scene(snakemake.input.scene, relaxation_digest=digest)
    asked = asked_fe(scene, load)
    study = build_study(scene)
    result = compute_relaxation(study, batch, scene.prony, asked, load, log.progress)
    write_batch(result, snakemake.output[0], digest)
    log.result = f"{result.sizes['series']} series at {result.sizes['point']} points"
