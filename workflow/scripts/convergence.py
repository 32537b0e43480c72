"""One case of a scene's convergence study, timed on a single thread of a machine of its own."""

import os

os.environ["OMP_NUM_THREADS"] = os.environ["OPENBLAS_NUM_THREADS"] = "1"

from bondcell.batch_files import write_batch
from bondcell.convergence import run_case
from bondcell.jobs import job
from bondcell.planned_scene import planned_scene

case = snakemake.wildcards.case
with job(f"{snakemake.wildcards.scene}: convergence of {case}") as log:
    digest = snakemake.params.digest
    scene = planned_scene(snakemake.input.scene, convergence_digest=digest)
    result = run_case(scene, case)
    write_batch(result, snakemake.output[0], digest)
    log.result = f"{result.sizes}"
