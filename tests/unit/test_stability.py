"""The stability table: every point, the worst first; nothing without a value and without a flag."""

import warnings
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import xarray as xr

from bondcell.cell import UNITS
from bondcell.figures import draw_scene
from bondcell.figures.stability import draw_stability
from bondcell.jobs.batch_files import write_batch
from bondcell.jobs.batch_plan import plan
from bondcell.jobs.collect import collect, collect_other_loads
from bondcell.jobs.reference_batch import compute_reference
from bondcell.report import write_report
from bondcell.report.stability_part import stability_findings, stability_lines
from bondcell.results.load_groups import read_loads
from bondcell.results.stability import FLAGS, condition, stability_summary, stability_table
from bondcell.scenes.parsing import load_scene, parse_scene
from bondcell.scenes.study import build_study
from bondcell.status import Status
from bondcell.storage import write_dataset

PARAMS = Path(__file__).parents[2] / "params"
SCENE = {
    "title": "Some corners",
    "cell": {
        "radius_i": "7.5 mm",
        "young_i": "30 GPa",
        "poisson_i": 0.3,
        "young_m": "1.4 MPa",
        "gap": "7.5 mm",
    },
    "sweep": {"modulus_ratio": [1e-6, 1e12, "rigid"], "poisson_m": [-0.9, 0.5]},
    "reference": {"tolerance": 1e-6},
    "load": ["normal", "torsion"],
    "stability": True,
}


@pytest.fixture(scope="module")
def scene():
    return parse_scene(SCENE, name="corners")


@pytest.fixture(scope="module")
def folder(scene, tmp_path_factory):
    """Results of the scene, solved without a warning of the numerical libraries."""
    results = tmp_path_factory.mktemp("results")
    study = build_study(scene)
    files = []
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        for batch in plan(scene).new:
            files.append(results / f"{batch.name}.nc")
            write_batch(compute_reference(batch), files[-1], batch.name)
    groups = collect_other_loads(scene, study, [], files)
    target = results / scene.name / "study.nc"
    write_dataset(collect(scene, study, [], files), target, groups)
    return results


@pytest.fixture(scope="module")
def loads(scene, folder):
    return read_loads(folder / scene.name / "study.nc")


@pytest.fixture(scope="module")
def table(loads):
    return stability_table(loads)


def test_every_corner_is_there_the_worst_first(table):
    assert len(table) == 2 * 6
    assert table["load"].value_counts().to_dict() == {"normal": 6, "torsion": 6}
    estimate = table["error_estimate"].fillna(np.inf).to_numpy()
    assert (estimate[1:] <= estimate[:-1]).all()
    columns = ["modulus_ratio", "poisson_m", "stiffness", "order", "dof", "seconds", "way"]
    assert set(columns) < set(table.columns)
    assert (table["way"] == "direct").all()


def test_every_value_is_within_its_estimate_or_has_a_named_flag(table):
    good = table["status"] == "ok"
    assert good.any()
    assert (table.loc[good, "error_estimate"] <= 1e-6).all()
    assert (table.loc[~good & table["stiffness"].notna(), "error_estimate"] > 1e-6).all()
    no_value = table["status"].map(lambda name: not Status[name].has_value)
    assert (table["stiffness"].isna() == no_value).all()
    assert {Status[name] for name in table["status"]} <= set(FLAGS)


def test_torsion_does_not_ask_for_compressibility(loads):
    stiffness = loads["torsion"]["stiffness"].sel(model="fe", modulus_ratio=np.inf)
    shear = 1.4e6 / (2 * (1 + loads["torsion"]["poisson_m"]))
    np.testing.assert_allclose(stiffness / shear, (stiffness / shear)[0], rtol=1e-6)


def test_condition_leaves_out_what_is_infinite(loads):
    study = loads["normal"]
    found = condition(study)
    assert np.isfinite(found).all()
    assert found.sel(modulus_ratio=np.inf, poisson_m=0.5).item() == pytest.approx(1)
    assert found.sel(modulus_ratio=1e12, poisson_m=0.5).item() > 1e11


def test_summary_counts_every_point(table):
    summary = stability_summary(table)
    assert summary["points"].sum() == len(table)
    assert set(summary["load"]) == {"normal", "torsion"}


def test_report_explains_the_flags(scene, folder, loads, table):
    study = loads["normal"]
    words = " ".join(finding.text for finding in stability_findings(table, study))
    assert f"of {len(table)} points are within the tolerance" in words
    summary, worst = stability_lines(table, study)
    assert summary.header[1:4] == ["reference", "flag", "which means"]
    assert {line[1] for line in summary.lines} == {"finite elements"}
    assert FLAGS[Status.ok] in {line[3] for line in summary.lines}
    assert len(worst.lines) == len(table)
    study, *others = loads.values()
    drawn = draw_scene(scene, study, None, folder / scene.name / "figures", others)
    assert {path.stem for path in drawn} == {"stability"}
    table.to_csv(folder / scene.name / "stability.csv", index=False)
    write_report(folder, folder / "report.html", [scene])
    page = (folder / "report.html").read_text(encoding="utf-8")
    assert "corners/stability.csv" in page
    assert "which means" in page


def test_points_without_value_lead_and_are_told(synthetic):
    study = synthetic.maps.copy(deep=True)
    for name, value in {"order": 8, "way": 0, "young_j": 3e10, "poisson_j": 0.25}.items():
        study[name] = xr.full_like(study["dof"], value) if name in ("order", "way") else value
    here = {"model": "fe", "gap_ratio": 1e-3, "poisson_m": 0.46}
    study["status"].loc[here] = Status.solver_failed
    study["stiffness"].loc[here] = np.nan
    study["error_estimate"].loc[here] = np.nan
    table = stability_table({"normal": study})
    lost = int((table["status"] == "solver_failed").sum())
    assert table["status"].iloc[:lost].eq("solver_failed").all()
    words = " ".join(finding.text for finding in stability_findings(table, study))
    assert f"Without a value are {lost} points: {lost} solver failed." in words
    assert "Every point beyond the tolerance has" in words
    assert "neither a value nor a flag" not in words
    assert f"{lost} solver failed" in draw_stability({"normal": study}).description


@pytest.mark.parametrize("name", ["extreme", "extreme_loads"])
def test_shipped_scene_holds_the_corners(name):
    scene = load_scene(PARAMS / f"{name}.yaml")
    assert scene.stability
    axes = scene.axes
    assert {1e-6, 1e3} <= set(axes["gap_ratio"])
    assert {1e-6, np.inf} <= set(axes["modulus_ratio"])
    assert {-0.9, 0.5} <= set(axes["poisson_m"])


def test_one_cell_alone_has_a_table():
    scene = parse_scene(
        {k: v for k, v in SCENE.items() if k != "sweep"}
        | {"load": "torsion"}
        | {"cell": SCENE["cell"] | {"poisson_m": 0.3}}
    )
    study = build_study(scene)
    (batch,) = plan(scene).new
    solved = compute_reference(batch).drop_vars(UNITS)
    assert isinstance(solved, xr.Dataset)
    merged = solved.isel(point=0, drop=True).assign_coords(model=["fe"]).assign(study)
    table = stability_table({"torsion": merged})
    assert isinstance(table, pd.DataFrame)
    assert table["status"].tolist() == ["ok"]
