"""One job of a specimen scene, timed on one thread of a machine that does nothing else."""

import os
from pathlib import Path

os.environ["OMP_NUM_THREADS"] = os.environ["OPENBLAS_NUM_THREADS"] = "1"

from bondcell.fem import reduced_basis, reference, structured, sweep  # noqa: F401
from bondcell.jobs.batch_files import write_batch
from bondcell.jobs.job import job
from bondcell.provenance import measuring
from bondcell.scenes.planned_scene import planned_scene
from bondcell.solid import finite_strain, layer_cells, moduli  # noqa: F401
from bondcell.specimen import finite_strain as specimen_finite_strain  # noqa: F401
from bondcell.specimen import relaxation as specimen_relaxation  # noqa: F401
from bondcell.specimen import solid_half as specimen_solid  # noqa: F401
from bondcell.specimen.run import run_part

part = Path(snakemake.output[0]).stem.removeprefix("specimen_")
with job(f"{snakemake.wildcards.scene}: {part}") as log:
    digest = snakemake.params.digest
    scene = planned_scene(snakemake.input.scene, specimen_digest=digest)
    about = measuring()
    for result, path in zip(run_part(scene, part), snakemake.output, strict=True):
        write_batch(result.assign_attrs(about), path, digest)
