"""Killed jobs, a killed Snakemake, two at once, clocks that jump: the next run ends it all well."""

import contextlib
import os
import random
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
import xarray as xr
import yaml

from bondcell.jobs.batch_plan import plan
from bondcell.scenes.parsing import parse_scene
from bondcell.storage import read_dataset

SCENE = """\
title: Some points
cell: {radius_i: 7.5 mm, young_i: 30 GPa, young_m: 1 MPa, poisson_i: 0.25, poisson_m: 0.3}
sweep: {gap: [0.5 mm, 2 mm]}
models: [fsi]
reference: {tolerance: 1e-2}
"""
STUDY = "results/some/study.nc"
BATCH = f"results/some/batches/{plan(parse_scene(yaml.safe_load(SCENE))).needed[0]}.nc"
KILLS = 20


def but_times(path):
    dataset = read_dataset(path)
    return dataset.drop_vars([name for name in dataset if "seconds" in name])


class Run:
    """Snakemake in the background, in a session of its own."""

    def __init__(self, workspace, *arguments):
        self.log = workspace / "background.log"
        with self.log.open("w") as log:
            self.process = subprocess.Popen(
                [sys.executable, "-m", "snakemake", "--cores", "2", *arguments],
                cwd=workspace.folder,
                env=workspace.environment,
                stdout=log,
                stderr=subprocess.STDOUT,
                start_new_session=True,
            )

    def jobs(self):
        """Processes of the session that run a script of a rule."""
        found = []
        for folder in Path("/proc").glob("[0-9]*"):
            try:
                own = os.getsid(int(folder.name)) == self.process.pid
                words = (folder / "cmdline").read_bytes()
            except (OSError, ProcessLookupError):
                continue
            if own and b"/scripts/tmp" in words and b"bash" not in words.split(b"\0")[0]:
                found.append(int(folder.name))
        return found

    def wait_for_job(self):
        """A running job's process."""
        while self.process.poll() is None:
            if jobs := self.jobs():
                return jobs[0]
            time.sleep(0.02)
        raise AssertionError(self.log.read_text())

    def stop_a_job(self):
        """A job's process, halted, so that the run cannot end."""
        while True:
            job = self.wait_for_job()
            with contextlib.suppress(ProcessLookupError):
                os.kill(job, signal.SIGSTOP)
                if job in self.jobs():
                    return job

    def end(self):
        """Wait for its end: exit status and output."""
        return self.process.wait(timeout=300), self.log.read_text()


@pytest.fixture(scope="module")
def some(make_workspace, tmp_path_factory):
    """A workspace whose scene was computed, and what came out."""
    workspace = make_workspace(tmp_path_factory.mktemp("kills"), some=SCENE)
    del workspace.environment["MODULES_FOLDER"]
    done = workspace.snakemake(STUDY)
    assert done.returncode == 0, done.stdout
    return workspace, but_times(workspace / STUDY)


def forget(workspace):
    shutil.rmtree(workspace / "results")


def check_resumes(workspace, before):
    done = workspace.snakemake(STUDY)
    assert done.returncode == 0, done.stdout
    xr.testing.assert_identical(but_times(workspace / STUDY), before)
    assert not list((workspace / "results").rglob("*.tmp"))


@pytest.mark.skipif(sys.platform != "linux", reason="finds the jobs' processes in /proc")
def test_second_run_at_once_is_refused_and_a_killed_one_is_resumed(some):
    workspace, before = some
    forget(workspace)
    first = Run(workspace, STUDY)
    job = first.stop_a_job()
    second = workspace.snakemake(STUDY)
    assert second.returncode == 1
    assert "Directory cannot be locked" in second.stdout
    assert "--unlock" in second.stdout
    os.kill(job, signal.SIGKILL)
    first.process.kill()
    first.end()
    assert workspace.snakemake("--unlock").returncode == 0
    check_resumes(workspace, before)


@pytest.mark.slow
@pytest.mark.skipif(sys.platform != "linux", reason="finds the jobs' processes in /proc")
def test_killed_job_fails_its_attempt_only(some):
    workspace, before = some
    forget(workspace)
    run = Run(workspace, STUDY)
    os.kill(run.wait_for_job(), signal.SIGKILL)
    status, output = run.end()
    assert status == 0
    assert "Trying to restart job" in output
    xr.testing.assert_identical(but_times(workspace / STUDY), before)


@pytest.mark.slow
@pytest.mark.skipif(sys.platform != "linux", reason="finds the jobs' processes in /proc")
def test_kills_at_random_times_lose_nothing(some):
    """Half of them hit Snakemake alone, whose job goes on as an orphan; half hit both."""
    workspace, before = some
    chance = random.Random(7)
    started = time.monotonic()
    forget(workspace)
    check_resumes(workspace, before)
    whole = time.monotonic() - started
    hits = 0
    while hits < KILLS:
        forget(workspace)
        run = Run(workspace, STUDY)
        time.sleep(chance.uniform(0.0, whole))
        if run.process.poll() is not None:  # the machine has become quicker
            whole *= 0.8
            continue
        hits += 1
        if hits % 2:
            os.killpg(run.process.pid, signal.SIGKILL)
        else:
            run.process.kill()
        run.end()
        assert workspace.snakemake("--unlock").returncode == 0
        check_resumes(workspace, before)


def shift(folder, seconds):
    """Give all files the times of a clock that is fast or slow."""
    for path in folder.rglob("*"):
        if path.is_file():
            times = path.stat()
            os.utime(path, (times.st_atime + seconds, times.st_mtime + seconds))


@pytest.mark.parametrize("hours", [pytest.param(-1000, marks=pytest.mark.slow), 1000])
def test_results_from_another_clock_follow_edits(some, hours):
    """An edit is noticed by its content, whether it looks older or newer than the results."""
    workspace, _ = some
    shift(workspace / "results", 3600 * hours)
    source = workspace / "src/bondcell/fem/reference.py"
    text = source.read_text()
    source.write_text(text + "\n# edited\n")
    planned = workspace.snakemake("--dry-run", STUDY).stdout
    source.write_text(text)
    shift(workspace / "results", -3600 * hours)
    for rule in ("reference", "collect"):
        assert f"\n{rule} " in planned
    assert "Nothing to be done" in workspace.snakemake("--dry-run", STUDY).stdout
