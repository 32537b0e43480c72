"""The summary of the atlas that the package ships."""

import os

os.environ["OMP_NUM_THREADS"] = os.environ["OPENBLAS_NUM_THREADS"] = "1"

from pathlib import Path

from bondcell.jobs.job import job
from bondcell.provenance import machine, software
from bondcell.results.accuracy_map_build import build
from bondcell.results.load_groups import read_loads
from bondcell.storage import replacing

with job("accuracy map") as log:
    loads = read_loads(snakemake.input.study)
    with replacing(snakemake.output[0]) as path:
        build(Path(path), loads, software() | machine())
    log.result = f"{Path(snakemake.output[0]).stat().st_size} bytes"
