"""The whole study end to end on small scenes; what is left out is neither run nor imported."""

import re
import zipfile

import netCDF4
import numpy as np
import pandas as pd
import pytest
import xarray as xr

from bondcell.storage import read_dataset

HEAVY = {"gmsh", "skfem", "matplotlib", "jinja2"}
LABELS = {"xarray", "netCDF4"}  # Snakemake loads pandas itself


def packages(modules):
    return {name.split(".")[0] for name in modules}


def test_scene_without_reference_runs_no_reference_and_imports_none(plain_run):
    workspace, done, modules = plain_run
    assert done.returncode == 0, done.stdout
    assert set(modules) == {"snakemake", "collect", "figures"}
    assert not packages(modules["collect"]) & HEAVY
    assert not [name for found in modules.values() for name in found if "prony." in name]
    assert "time" not in read_dataset(workspace / "results/plain/study.nc").dims
    assert packages(modules["figures"]) & HEAVY == {"matplotlib"}
    written = sorted(path.name for path in (workspace / "results/plain").iterdir())
    assert written == ["figures", "study.nc"]


def test_planning_is_lean(plain_run):
    _, _, modules = plain_run
    assert not packages(modules["snakemake"]) & (LABELS | {"gmsh", "skfem", "matplotlib"})


def test_whole_study(full_run):
    workspace, done, _ = full_run
    assert done.returncode == 0, done.stdout
    results = workspace / "results"
    for name in ("full/study.nc", "full/accuracy.csv", "full/stability.csv"):
        assert (results / name).stat().st_size > 0
    for name in ("full/convergence.csv", "report.html"):
        assert (results / name).stat().st_size > 0
    assert list((results / "full/figures").glob("*.svg"))
    assert not (results / "plain/accuracy.csv").exists()
    assert not list(results.rglob("*.tmp"))


def test_report_of_snakemake(workspace):
    done = workspace.snakemake("--report", "snakemake_report.zip")
    assert done.returncode == 0, done.stdout
    with zipfile.ZipFile(workspace / "snakemake_report.zip") as packed:
        page = packed.read("snakemake_report/report.html").decode()
    for word in ("All scenes", '"tables"', '"figures"', '"figure": "stiffness"', '"stability"'):
        assert word in page, word
    assert "Figures of the scene" in page
    assert "A category for each scene" in page


def test_progress_is_said_in_lines(full_run):
    _, done, _ = full_run
    assert re.search(r"full: fe_roller_\w+: 4/4 points, ", done.stdout)
    assert "full: convergence study: 1 cases, " in done.stdout
    assert re.search(r"^\d+/\d+ points, (\d+)/\1 jobs  in ", done.stdout, re.MULTILINE)


@pytest.mark.parametrize(
    ("script", "needed"),
    [
        ("reference", {"skfem"}),
        ("convergence", {"skfem"}),
        ("collect", set()),
        ("accuracy", set()),
        ("stability", set()),
        ("convergence_table", set()),
        ("figures", {"matplotlib"}),
    ],
)
def test_jobs_import_what_they_need(full_run, script, needed):
    """No gmsh either: the convergence study asks for no triangles."""
    _, _, modules = full_run
    assert packages(modules[script]) & HEAVY == needed


def test_sources_of_a_rule_are_what_its_jobs_loaded(full_run):
    """So an edit of any of them runs the job again.

    The models are the exception: who reads a scene looks up their names, but only who evaluates
    them depends on them.
    """
    workspace, _, modules = full_run
    ran = [path for path in workspace.scripts() if path.stem in modules]
    assert {path.stem for path in ran} >= {
        "accuracy",
        "collect",
        "convergence",
        "convergence_table",
        "figures",
        "reference",
        "report",
        "stability",
    }
    for script in ran:
        assert workspace.undeclared(script, modules) == set(), script


def test_file_of_a_scene(workspace):
    study = read_dataset(workspace / "results/full/study.nc")
    assert study.stiffness.dims == ("model", "gap", "modulus_ratio")
    assert study.model.values.tolist() == ["fsi", "generatrix", "fe", "fe_confined"]
    assert (study.status == 0).all()
    fe, confined = study.stiffness.sel(model="fe"), study.stiffness.sel(model="fe_confined")
    assert (study.error_estimate.sel(model="fe") <= 1e-2).all()
    assert (fe < confined).all()
    assert (study.stiffness.sel(model="generatrix") < fe * 1.01).all()
    np.testing.assert_allclose(study.young_m, 3e10 / study.modulus_ratio)
    for name in ("title", "parameters", "source", "source_revision", "versions", "machine"):
        assert study.attrs[name]
    assert '"gap": ["0.5 mm", "2 mm"]' in study.attrs["parameters"]
    assert "k_int" not in study
    assert "k_int" in read_dataset(workspace / "results/plain/study.nc")


def test_other_loads_have_a_group_each_and_the_file_is_a_tree(workspace):
    path = workspace / "results/full/study.nc"
    torsion = read_dataset(path, "torsion")
    assert torsion.stiffness.attrs["units"] == "N m rad-1"
    assert (torsion.status.sel(model="fe") == 0).all()
    with xr.open_datatree(path) as tree:
        assert set(tree.children) == {"convergence", "torsion"}
    table = pd.read_csv(workspace / "results/full/stability.csv")
    assert table["load"].value_counts().to_dict() == {"normal": 8, "torsion": 4}
    accuracy = pd.read_csv(workspace / "results/full/accuracy.csv")
    assert set(zip(accuracy["load"], accuracy["model"], strict=True)) == {
        ("normal", "fsi"),
        ("normal", "generatrix"),
        ("torsion", "generatrix"),
    }


def test_every_variable_is_described(workspace):
    with netCDF4.Dataset(workspace / "results/full/study.nc") as file:
        assert file.Conventions == "CF-1.11"
        assert set(file.groups) == {"convergence", "torsion"}
        groups = [file, *file.groups.values()]
        for variable in (found for group in groups for found in group.variables.values()):
            assert "long_name" in variable.ncattrs(), variable.name
            is_text = variable.dtype == "S1"
            if not is_text and "flag_values" not in variable.ncattrs():
                assert "units" in variable.ncattrs() or variable.name == "level", variable.name


def test_second_run_does_nothing(workspace):
    done = workspace.snakemake()
    assert done.returncode == 0
    assert "Nothing to be done" in done.stdout


def test_scene_that_the_study_does_not_list(workspace):
    workspace.write("params/other.yaml", (workspace / "params/plain.yaml").read_text())
    done = workspace.snakemake("results/other/study.nc")
    assert done.returncode == 0
    assert set(workspace.modules()) == {"snakemake", "collect"}
