"""Figures of a scene."""

from pathlib import Path

from bondcell.figures import draw_scene
from bondcell.figures.specimen import draw_specimen
from bondcell.jobs.job import job
from bondcell.results.load_groups import read_loads
from bondcell.results.relaxation_names import METHODS
from bondcell.scenes.planned_scene import planned_scene
from bondcell.specimen.view import read_specimen
from bondcell.storage import read_dataset

with job(f"{snakemake.wildcards.scene}: figures") as log:
    scene = planned_scene(snakemake.input.scene, digest=snakemake.params.digest)
    study, *others = read_loads(snakemake.input.study).values()
    group = "convergence" if scene.convergence else None
    convergence = read_dataset(snakemake.input.study, group) if group else None
    timed = scene.prony is not None and scene.prony.methods is not None
    methods = read_dataset(snakemake.input.study, METHODS) if timed else None
    folder = Path(snakemake.output[0])
    folder.mkdir(parents=True, exist_ok=True)
    if scene.specimen:
        paths = draw_specimen(read_specimen(snakemake.input.study), folder)
    else:
        paths = draw_scene(scene, study, convergence, folder, others, methods)
    log.result = f"{len(paths)} files"
