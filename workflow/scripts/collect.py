"""A scene's batches into one file."""

from bondcell.collect import collect, collect_convergence, collect_other_loads
from bondcell.jobs import job
from bondcell.planned_scene import planned_scene
from bondcell.storage import write_dataset
from bondcell.study import build_study

files = snakemake.input
with job(f"{snakemake.wildcards.scene}: collect") as log:
    scene = planned_scene(files.scene, digest=snakemake.params.digest)
    study = build_study(scene) if scene.has_points else None
    result = collect(scene, study, files.analytic, files.reference)
    groups = collect_other_loads(scene, study, files.analytic, files.reference)
    groups |= collect_convergence(scene, files.convergence)
    write_dataset(result, snakemake.output[0], groups)
    log.result = f"{scene.points} points, {len(groups)} groups"
