"""Analytic models of a scene at the points of one batch."""

from bondcell.jobs.analytic_batch import compute_analytic
from bondcell.jobs.batch import Batch
from bondcell.jobs.batch_files import describe, write_batch
from bondcell.jobs.job import job
from bondcell.results.names import models_with
from bondcell.scenes.planned_scene import planned_scene
from bondcell.scenes.study import build_study

batch = Batch.parse(f"analytic_{snakemake.wildcards.part}")
with job(f"{snakemake.wildcards.scene}: {batch.name}") as log:
    digest = snakemake.params.digest
    scene = planned_scene(snakemake.input.scene, models_digest=digest)
    load = batch.method.partition("_")[2] or scene.load
    models = models_with(scene, load)
    result = compute_analytic(build_study(scene), batch, models, load, scene.contributions)
    write_batch(result, snakemake.output[0], digest)
    log.result = describe(result)
