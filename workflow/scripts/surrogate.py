"""The surrogate's data file from the finite element reference."""

from pathlib import Path

from bondcell.fem.surrogate_build import build
from bondcell.jobs.job import job
from bondcell.provenance import machine, software
from bondcell.storage import replacing

with job("surrogate") as log:
    log.unit = "gaps"
    about = software() | machine()
    with replacing(snakemake.output[0]) as path:
        build(Path(path), provenance=about, progress=lambda _, done, gaps: log.progress(done, gaps))
    log.result = "all loads"
