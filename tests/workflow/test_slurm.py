"""The smoke study on a real Slurm gives what it gives here."""

import os
import subprocess
from pathlib import Path

import pytest
import xarray as xr

from bondcell.storage import read_dataset

HERE = Path(__file__).parent
PARAMS = HERE.parents[1] / "params"
STUDY = "results/smoke/study.nc"
NODE = HERE / "slurm_node.sh"
# This Slurm keeps no accounts, so that `squeue` tells how jobs ended.
ON_SLURM = (
    *("--profile", "workflow/profiles/slurm"),
    *("--slurm-status-command", "squeue"),
    *("--slurm-init-seconds-before-status-checks", "4"),
)


@pytest.fixture
def node(tmp_path):
    """Folder of a Slurm of one node that runs while the test does."""
    if os.name != "posix" or os.geteuid() != 0:
        pytest.skip("a Slurm of its own needs root")
    folder = tmp_path / "slurm"
    started = subprocess.run([NODE, "start", folder], capture_output=True, text=True, check=False)
    if started.returncode in (3, 4):
        pytest.skip(started.stderr.strip())
    assert started.returncode == 0, started.stderr
    yield folder
    subprocess.run([NODE, "stop", folder], check=True)


def but_times(path, group=None):
    dataset = read_dataset(path, group)
    return dataset.drop_vars([name for name in dataset if "seconds" in name])


@pytest.mark.slow
def test_smoke_study_on_slurm_is_the_local_one(node, make_workspace, tmp_path):
    scene = (PARAMS / "smoke.yaml").read_text().replace("bc: roller", "bc: [roller, confined]")
    here, there = (make_workspace(tmp_path / name, smoke=scene) for name in ("here", "there"))
    done = there.snakemake(*ON_SLURM, STUDY)
    assert done.returncode == 0, done.stdout
    jobs = (node / "completed.log").read_text().splitlines()
    assert len(jobs) == 3, jobs  # both batches in one, the convergence study, the collection
    assert all("JobState=COMPLETED" in job and "Tres=cpu=1," in job for job in jobs)
    done = here.snakemake(STUDY)
    assert done.returncode == 0, done.stdout
    xr.testing.assert_identical(but_times(there / STUDY), but_times(here / STUDY))
    ladders = (but_times(place / STUDY, "convergence") for place in (there, here))
    xr.testing.assert_equal(*(ladder.drop_vars("model_stiffness") for ladder in ladders))
    assert "Nothing to be done" in there.snakemake(STUDY).stdout
