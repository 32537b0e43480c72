"""The report on all scenes of the study."""

from pathlib import Path

from bondcell.jobs import job
from bondcell.planned_scene import planned_scene
from bondcell.report import write_report
from bondcell.storage import replacing

with job("report") as log:
    digests = snakemake.params.digests.values()
    files = zip(snakemake.input.scenes, digests, strict=True)
    scenes = [planned_scene(path, digest=digest) for path, digest in files]
    with replacing(snakemake.output[0]) as path:
        write_report(Path(snakemake.output[0]).parent, scenes, path)
    log.result = f"{len(scenes)} scenes"
