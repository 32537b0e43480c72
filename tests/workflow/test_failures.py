"""Bad input and failed points: clear words, nothing half-written, nothing lost."""

import re

import numpy as np
import pytest

from bondcell.status import Status
from bondcell.storage import read_dataset

BAD = """\
title: Bad
cell: {radius_i: 7.5 mm, gap: -1 mm, young_i: 30 GPa, young_m: 1 MPa, poisson_i: 0.7}
models: [fsi, fis]
color: red
"""

FRAGILE = """\
title: The wide gap fails
cell: {radius_i: 7.5 mm, young_i: 30 GPa, young_m: 1 MPa, poisson_i: 0.25, poisson_m: 0.3}
sweep: {gap: [0.5 mm, 2 mm]}
models: [fsi]
reference: {tolerance: 1e-2}
"""

FAILING_SOLVER = """

_solve = solve


def solve(cell, **options):
    if cell.gap[0] > 1e-3:
        raise ArithmeticError("no factorisation")
    return _solve(cell, **options)
"""


@pytest.fixture(scope="module")
def bad_workspace(make_workspace, tmp_path_factory):
    folder = tmp_path_factory.mktemp("bad")
    return make_workspace(folder, bad=BAD, fragile=FRAGILE, worse="title: [\n")


@pytest.fixture(scope="module")
def failed_run(make_workspace, tmp_path_factory):
    """A run in which the solver fails at one gap, and its workspace."""
    workspace = make_workspace(tmp_path_factory.mktemp("fragile"), fragile=FRAGILE)
    workspace.append("src/bondcell/fem/reference.py", FAILING_SOLVER)
    return workspace, workspace.snakemake("results/fragile/study.nc")


def test_bad_scene_lists_every_violation_and_writes_nothing(bad_workspace):
    done = bad_workspace.snakemake("results/bad/study.nc")
    assert done.returncode == 2
    for field in ("cell.gap", "cell.poisson_i", "cell.poisson_m", "models.1", "color"):
        assert f"  {field} = " in done.stdout
    assert "params/bad.yaml: 5 violations" in done.stdout
    assert "Traceback" not in done.stdout
    assert not (bad_workspace / "results").exists()


def test_every_bad_scene_of_a_study_is_named_at_once(bad_workspace):
    done = bad_workspace.snakemake()
    assert done.returncode == 2
    assert "params/bad.yaml: 5 violations" in done.stdout
    assert "params/worse.yaml" in done.stdout
    assert not (bad_workspace / "results").exists()


def test_missing_scene(bad_workspace):
    done = bad_workspace.snakemake("results/nowhere/study.nc")
    assert done.returncode == 2
    assert "params/nowhere.yaml" in done.stdout
    assert "Traceback" not in done.stdout


def test_bad_list_of_scenes(bad_workspace):
    bad_workspace.write("params/study.yaml", "scenes: [fragile, nowhere]\n")
    done = bad_workspace.snakemake("results/report.html")
    assert done.returncode == 2
    assert "scenes.1 = 'nowhere'" in done.stdout


def test_failed_points_are_flagged_and_the_rest_is_there(failed_run):
    workspace, done = failed_run
    assert done.returncode == 0, done.stdout
    assert re.search(r"fragile: fe_roller_\w+: 1/2 points, solver_failed: 1", done.stdout)
    assert "no factorisation" in done.stdout
    study = read_dataset(workspace / "results/fragile/study.nc")
    assert study.status.sel(model="fe").values.tolist() == [Status.ok, Status.solver_failed]
    assert np.isnan(study.stiffness.sel(model="fe", gap=2e-3))
    assert np.isfinite(study.stiffness.sel(model="fe", gap=5e-4))
    assert np.isfinite(study.stiffness.sel(model="fsi")).all()
