"""A scene whose matrix relaxes, end to end: files, curves, tables, report, what an edit reruns."""

import numpy as np
import pandas as pd
import pytest
import xarray as xr

from bondcell.storage import read_dataset

RUBBER = """\
title: A rubber
kind: polymer
source: made up
young: 2 MPa
weights: [0.5, 0.4]
times: [1 ms, 1 s]
"""

RELAXING = """\
title: Relaxing
cell: {radius_i: 7.5 mm, gap: 1 mm, young_i: 30 GPa, young_m: 1 MPa, poisson_i: 0.25,
  poisson_m: 0.3}
sweep: {gap: [0.5 mm, 2 mm]}
models: [fsi, generatrix]
reference: {tolerance: 1e-3}
load: [normal, torsion]
prony:
  materials: [rubber]
  times: {start: 1 us, stop: 100 s, points: 5}
  bond: {terms: 1}
  checks: 2
  methods: {series: [rubber], order: 2, steps: [1], nodes: [4], times: 2}
"""

TABLES = (
    "accuracy_over_time.csv",
    "bond_series.csv",
    "convergence.csv",
    "relaxation_stability.csv",
)


@pytest.fixture(scope="module")
def run(make_workspace, tmp_path_factory):
    workspace = make_workspace(tmp_path_factory.mktemp("relaxing"), relaxing=RELAXING)
    (workspace / "params/materials").mkdir()
    workspace.write("params/materials/rubber.yaml", RUBBER)
    done = workspace.snakemake()
    assert done.returncode == 0, done.stdout
    return workspace, workspace.modules()


def test_everything_is_there(run):
    workspace, _ = run
    results = workspace / "results/relaxing"
    for name in (*TABLES, "bond_series.nc", "study.nc"):
        assert (results / name).stat().st_size > 0, name
    assert {path.stem for path in (results / "figures").glob("*.svg")} >= {
        "complex_stiffness",
        "error_over_time",
        "relaxation",
        "relaxation_checks",
        "relaxation_methods",
    }
    page = (workspace / "results/report.html").read_text()
    assert "shortcut K(0) g(t)" in page
    assert "bond_series.csv" in page


def test_file(run):
    workspace, _ = run
    path = workspace / "results/relaxing/study.nc"
    study = read_dataset(path)
    assert study["relaxation"].dims == ("model", "convention", "series", "gap", "time")
    assert study["time"].attrs["units"] == "s"
    start = study["relaxation"].isel(time=0, convention=0, series=0, drop=True)
    np.testing.assert_allclose(start, study["stiffness"], rtol=2e-3)
    assert (study["relaxation"].diff("time") <= 0).all()
    with xr.open_datatree(path) as tree:
        assert set(tree.children) == {"torsion", "relaxation_methods"}
    methods = read_dataset(path, "relaxation_methods")
    assert methods.attrs["threads"] == "1"
    assert float(methods.attrs["load_average_before"]) >= 0
    assert (methods["seconds_cpu"].where(methods["status"] == 0, 1) > 0).all()
    torsion = read_dataset(path, "torsion")
    assert torsion["relaxation"].attrs["units"] == "N m rad-1"
    assert np.isfinite(torsion["relaxation"].sel(model="fe")).all()


def test_tables(run):
    workspace, _ = run
    tables = {name: pd.read_csv(workspace / "results/relaxing" / name) for name in TABLES}
    assert tables["relaxation_stability.csv"]["sound"].all()
    assert set(tables["accuracy_over_time.csv"]["load"]) == {"normal", "torsion"}
    assert set(tables["convergence.csv"]["method"]) == {
        "exact_series",
        "time_stepping",
        "laplace_inversion",
        "shortcut",
    }
    bonds = tables["bond_series.csv"]
    assert set(bonds["model"]) == {"fe"}
    assert bonds["element"].max() == 1


def test_jobs_load_what_they_declare(run):
    """The models' job meshes nothing, tables and figures need no code of relaxation."""
    workspace, modules = run
    scripts = {path.stem: path for path in workspace.scripts()}
    own = {name for name in scripts if name.startswith("relaxation_")} | {"bond_series"}
    assert own <= set(modules)
    for name in own | {"collect", "figures", "report"}:
        assert workspace.undeclared(scripts[name], modules) == set(), name
    assert "skfem" not in modules["relaxation_models"]
    assert "skfem" in modules["relaxation_fe"]
    for name in ("collect", "figures", "report", "relaxation_tables"):
        assert not [module for module in modules[name] if module.startswith("bondcell.prony")]


def test_edit_of_a_material_runs_again(run):
    workspace, _ = run
    edits = {
        "weights": ("params/materials/rubber.yaml", "0.4]", "0.3]"),
        "source": ("params/materials/rubber.yaml", "made up", "made up again"),
        "terms": ("params/relaxing.yaml", "{terms: 1}", "{terms: 2}"),
    }
    plans = workspace.plans(edits)
    assert {"relaxation_models", "relaxation_fe", "relaxation_methods"} <= set(plans["weights"])
    assert "reference" not in plans["weights"]
    assert plans["source"] == {}
    assert "bond_series" in plans["terms"]
    assert "relaxation_fe" not in plans["terms"]
