"""A scene's batches into one file."""

from bondcell.jobs.collect import collect, collect_convergence, collect_other_loads
from bondcell.jobs.collect_relaxation import collect_methods
from bondcell.jobs.job import job
from bondcell.scenes.planned_scene import planned_scene
from bondcell.scenes.study import build_study
from bondcell.specimen.files import collect_specimen
from bondcell.storage import write_dataset

files = snakemake.input
with job(f"{snakemake.wildcards.scene}: collect") as log:
    scene = planned_scene(files.scene, digest=snakemake.params.digest)
    study = build_study(scene) if scene.has_points else None
    points = scene, study, files.analytic, files.reference
    result = collect(*points, relaxation=files.relaxation)
    groups = collect_other_loads(*points, files.relaxation)
    groups |= collect_convergence(scene, files.convergence)
    groups |= collect_methods(scene, files.methods)
    if scene.specimen:
        result, groups = collect_specimen(scene, files.specimen)
    write_dataset(result, snakemake.output[0], groups, sealed=True)
    log.result = f"{scene.points} points, {len(groups)} groups"
