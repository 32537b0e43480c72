"""The smoke study on a real Slurm gives what it gives here, also when a job of it is cancelled."""

import os
import re
import subprocess
import sys
import time
from pathlib import Path

import pytest
import xarray as xr
import yaml

from bondcell.storage import read_dataset

HERE = Path(__file__).parent
ROOT = HERE.parents[1]
PROFILE = ROOT / "workflow/profiles/slurm/config.yaml"
STUDY = "results/smoke/study.nc"
WANTED = (STUDY, "results/smoke/accuracy.csv", "results/smoke/figures")
NODE = HERE / "slurm_node.sh"
# This Slurm keeps no accounts, so that `squeue` tells how jobs ended.
ON_SLURM = (
    *("--profile", "workflow/profiles/slurm"),
    *("--slurm-status-command", "squeue"),
    *("--slurm-init-seconds-before-status-checks", "4"),
)


def rules():
    """Name of each rule -> its text."""
    texts = [path.read_text() for path in (ROOT / "workflow/rules").glob("*.smk")]
    return dict(re.findall(r"^rule (\w+):\n(.*?)(?=^\S|\Z)", "\n".join(texts), re.M | re.S))


def test_what_measures_time_gets_a_node_of_its_own():
    """Such a rule claims more cores than there are, which no node of a cluster has."""
    timed = {name for name, text in rules().items() if "threads: WHOLE_MACHINE" in text}
    profile = yaml.safe_load(PROFILE.read_text())
    assert {"convergence", "relaxation_methods", "specimen_elastic"} < timed
    assert profile["set-threads"] == dict.fromkeys(timed, 1)
    assert set(profile["set-resources"]) == timed
    for resources in profile["set-resources"].values():
        assert resources["slurm_extra"] == "'--exclusive'"


def test_only_what_computes_goes_to_the_cluster():
    local = re.findall(r"\w+", (ROOT / "Snakefile").read_text().split("localrules:")[1])
    local = set(local[: local.index("rule")]) - {"all"}
    assert local < set(rules())
    texts = {name: text for name, text in rules().items() if name not in local}
    assert set(yaml.safe_load(PROFILE.read_text())["groups"]) < set(texts)
    writes = [name for name, text in texts.items() if ".csv" in text or ".html" in text]
    assert writes == []


@pytest.fixture(scope="module")
def node(tmp_path_factory):
    """Folder of a Slurm of one node that runs while the tests do."""
    if os.name != "posix" or os.geteuid() != 0:
        pytest.skip("a Slurm of its own needs root")
    folder = tmp_path_factory.mktemp("slurm")
    started = subprocess.run([NODE, "start", folder], capture_output=True, text=True, check=False)
    if started.returncode in (3, 4):
        pytest.skip(started.stderr.strip())
    assert started.returncode == 0, started.stderr
    yield folder
    subprocess.run([NODE, "stop", folder], check=True)


@pytest.fixture(scope="module")
def local(make_workspace, tmp_path_factory):
    """The study as it is without Slurm."""
    workspace = make_workspace(tmp_path_factory.mktemp("here"), smoke=smoke())
    done = workspace.snakemake(STUDY)
    assert done.returncode == 0, done.stdout
    return workspace


def smoke():
    text = (ROOT / "params/smoke.yaml").read_text()
    return text.replace("bc: roller", "bc: [roller, confined]")


def but_times(path, group=None):
    dataset = read_dataset(path, group)
    return dataset.drop_vars([name for name in dataset if "seconds" in name])


def finished(node, before=0):
    """Lines of Slurm on the jobs that ended, without the first ones."""
    log = node / "completed.log"
    return log.read_text().splitlines()[before:] if log.exists() else []


def check_same(there, here):
    xr.testing.assert_identical(but_times(there / STUDY), but_times(here / STUDY))
    ladders = (but_times(place / STUDY, "convergence") for place in (there, here))
    xr.testing.assert_equal(*(ladder.drop_vars("model_stiffness") for ladder in ladders))


@pytest.mark.slow
def test_smoke_study_on_slurm_is_the_local_one(node, local, make_workspace, tmp_path):
    there = make_workspace(tmp_path, smoke=smoke())
    before = len(finished(node))
    done = there.snakemake(*ON_SLURM, *WANTED)
    assert done.returncode == 0, done.stdout
    jobs = finished(node, before)
    assert len(jobs) == 3, jobs  # both batches in one, the convergence study, the collection
    assert all("JobState=COMPLETED" in job and "Tres=cpu=1," in job for job in jobs)
    check_same(there, local)
    assert "Nothing to be done" in there.snakemake(*WANTED).stdout


@pytest.mark.slow
def test_cancelled_job_is_sent_again_with_more(node, local, make_workspace, tmp_path):
    there = make_workspace(tmp_path, smoke=smoke())
    before = len(finished(node))
    command = [sys.executable, "-m", "snakemake", *ON_SLURM, STUDY]
    log = there / "slurm.log"
    with log.open("w") as output:
        run = subprocess.Popen(
            command, cwd=there.folder, env=there.environment, stdout=output, stderr=output
        )
    cancelled = cancel_a_running_job(run)
    assert run.wait(timeout=570) == 0, log.read_text()
    jobs = finished(node, before)
    states = [re.search(r"JobState=(\w+)", job)[1] for job in jobs]
    assert sorted(states) == ["CANCELLED", "COMPLETED", "COMPLETED", "COMPLETED"], (cancelled, jobs)
    assert "Trying to restart" in log.read_text()
    check_same(there, local)


def cancel_a_running_job(run):
    """Cancel the first job that runs."""
    while run.poll() is None:
        queue = subprocess.run(
            ["squeue", "-h", "-t", "R", "-o", "%i"], capture_output=True, text=True, check=True
        )
        if queue.stdout.split():
            job = queue.stdout.split()[0]
            subprocess.run(["scancel", job], check=True)
            return job
        time.sleep(0.2)
    return None
