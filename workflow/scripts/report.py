"""The report on all scenes of the study."""

from pathlib import Path

from bondcell.jobs.job import job
from bondcell.report import write_report
from bondcell.results.kept import was_computed
from bondcell.scenes.parsing import load_scene
from bondcell.scenes.planned_scene import planned_scene
from bondcell.storage import replacing

with job("report") as log:
    digests = snakemake.params.digests.values()
    files = zip(snakemake.input.scenes, digests, strict=True)
    scenes = [planned_scene(path, digest=digest) for path, digest in files]
    for name in snakemake.params.kept:
        kept = load_scene(f"params/{name}.yaml")
        if was_computed(kept, f"results/{name}/study.nc"):
            scenes.append(kept)
        else:
            log.say(f"{name} was edited since its results were computed: left out")
    page = snakemake.output.page
    written = write_report(Path(page).parent, Path(page), scenes)
    with replacing(snakemake.output.findings) as path:
        path.write_text("\n  ".join([f"{page}:", *written.sentences]), encoding="utf-8")
    log.result = f"{len(written.scenes)} scenes"
