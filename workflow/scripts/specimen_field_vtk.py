"""The solid's field under one loading, for ParaView."""

from bondcell.jobs.batch_files import read_batch
from bondcell.jobs.job import job
from bondcell.scenes.planned_scene import planned_scene
from bondcell.specimen.vtk import write_field
from bondcell.storage import replacing

with job(f"{snakemake.wildcards.scene}: solid, {snakemake.wildcards.loading}"):
    digest = snakemake.params.digest
    planned_scene(snakemake.input.scene, specimen_digest=digest)
    field = read_batch(snakemake.input.field, digest)
    with replacing(snakemake.output[0]) as path:
        write_field(path, field, snakemake.wildcards.loading)
