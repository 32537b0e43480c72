"""A job over its memory or time bound is tried again with more; at last its points are flagged."""

import re
import signal
import subprocess
import sys

import numpy as np
import pytest

from bondcell.errors import BoundExceeded, PointLost
from bondcell.jobs.job_bounds import Bounds
from bondcell.status import Status
from bondcell.storage import read_dataset


def last(seconds=600.0):
    return Bounds(seconds, megabytes=3000.0)


def first():
    return Bounds(seconds=600.0, megabytes=3000.0, attempt=1, attempts=2)


SCENE = """\
title: One gap needs too much
cell: {radius_i: 7.5 mm, young_i: 30 GPa, young_m: 1 MPa, poisson_i: 0.25, poisson_m: 0.3}
sweep: {gap: [0.5 mm, 1 mm, 2 mm]}
models: [fsi]
reference: {tolerance: 1e-2}
"""
STUDY = "results/hungry/study.nc"

# What a gap above 1 mm asks for beyond its solution.
GREED = {
    "memory": "bytearray(40 * 10**9)",
    "time": "__import__('time').sleep(600)",
    "crash": "__import__('os').kill(__import__('os').getpid(), 9)",
}
GREEDY = """

_solve = solve


def solve(cell, **options):
    if cell.gap[0] > 1e-3:
        {greed}
    return _solve(cell, **options)
"""


def test_answers_and_errors_come_through():
    for bounds in (first(), last()):
        assert bounds.bounded(divmod)(7, 2) == (3, 1)
        with pytest.raises(ZeroDivisionError):
            bounds.bounded(divmod)(7, 0)


def test_last_attempt_loses_only_what_exceeds_it():
    with pytest.raises(PointLost, match="over the bound of 3000 MB in attempt 1 of 1"):
        last().bounded(bytearray)(4 * 10**9)
    with pytest.raises(PointLost, match="ended with -9"):
        last().bounded(lambda: signal.raise_signal(signal.SIGKILL))()
    with pytest.raises(PointLost, match=r"over the bound of 0\.4 s"):
        last(0.4).bounded(signal.pause)()
    assert last().bounded(len)("still there") == 11


def test_time_that_is_over_is_given_to_nobody():
    with pytest.raises(PointLost, match="over the bound of 0 s"):
        last(0.0).bounded(len)("")


EARLIER = """\
import sys, time
from bondcell.jobs.job_bounds import Bounds
bounds = Bounds(float(sys.argv[1]), 3000.0, attempt=1, attempts=3)
with bounds.held():
    bounds.bounded(bytearray)(4 * 10**9) if sys.argv[2] == "memory" else time.sleep(60)
"""


@pytest.mark.parametrize(("need", "bound"), [("memory", "3000 MB"), ("time", "0.5 s")])
def test_earlier_attempts_end_with_a_message(need, bound):
    command = [sys.executable, "-c", EARLIER, "0.5" if need == "time" else "60", need]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 1
    assert f"over the bound of {bound} in attempt 1 of 3, the next has more" in done.stderr
    assert (BoundExceeded.__name__ in done.stderr) == (need == "memory")


def run(make_workspace, folder, greed):
    """The scene with a solver that asks for too much, and small bounds."""
    workspace = make_workspace(folder, hungry=SCENE)
    workspace.append("src/bondcell/fem/reference.py", GREEDY.format(greed=GREED[greed]))
    if greed != "memory":  # 10, 20 and 40 s
        script = workspace / "workflow/scripts/reference.py"
        script.write_text(script.read_text().replace("60 * bound.runtime", "0.5 * bound.runtime"))
    return workspace, workspace.snakemake(STUDY)


def check(workspace, done):
    assert done.returncode == 0, done.stdout
    assert re.search(r"fe_roller_\w+: 2/3 points, limit_exceeded: 1", done.stdout)
    study = read_dataset(workspace / STUDY)
    fe = study.sel(model="fe")
    assert fe.status.values.tolist() == [Status.ok, Status.ok, Status.limit_exceeded]
    assert np.isfinite(fe.stiffness[:2]).all()
    assert np.isnan(fe.stiffness[2])


@pytest.mark.slow
def test_job_over_its_memory_is_repeated_and_then_flagged(make_workspace, tmp_path):
    workspace, done = run(make_workspace, tmp_path, "memory")
    check(workspace, done)
    for attempt in (1, 2):
        assert f"in attempt {attempt} of 3, the next has more" in done.stdout
    assert "limit_exceeded: 1 points at " in done.stdout


@pytest.mark.slow
@pytest.mark.parametrize("greed", ["time", "crash"])
def test_job_over_its_time_or_killed_is_repeated_and_then_flagged(make_workspace, tmp_path, greed):
    workspace, done = run(make_workspace, tmp_path, greed)
    check(workspace, done)
    assert done.stdout.count("Trying to restart job") == 2
