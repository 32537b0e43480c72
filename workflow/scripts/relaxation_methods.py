"""Methods in time of a scene, timed on one thread of a machine that does nothing else."""

import os

os.environ["OMP_NUM_THREADS"] = os.environ["OPENBLAS_NUM_THREADS"] = "1"

from bondcell.jobs.batch_files import write_batch
from bondcell.jobs.job import job
from bondcell.jobs.relaxation_methods import run_methods
from bondcell.provenance import measuring
from bondcell.scenes.planned_scene import planned_scene

with job(f"{snakemake.wildcards.scene}: methods in time") as log:
    log.unit = "cases"
    digest = snakemake.params.digest
    scene = planned_scene(snakemake.input.scene, methods_digest=digest)
    about = measuring()
    result = run_methods(scene, log.progress).assign_attrs(about)
    write_batch(result, snakemake.output[0], digest)
    log.result = f"{result.sizes['case']} cases"
