"""A small atlas through the whole workflow."""

import pandas as pd
import pytest

from bondcell.storage import read_dataset

ATLAS = """\
title: Small atlas
cell: {radius_i: 7.5 mm, young_i: 30 GPa, young_m: 1.4 MPa, poisson_i: 0.25}
sweep: {gap_ratio: [0.1, 1], modulus_ratio: [10, rigid], poisson_m: [0, 0.5]}
models: [fsi, generatrix, surrogate]
reference: {bc: roller, tolerance: 1e-3}
load: [normal, torsion]
atlas: true
"""


@pytest.fixture(scope="module")
def atlas(tmp_path_factory, make_workspace):
    workspace = make_workspace(tmp_path_factory.mktemp("atlas"), small=ATLAS)
    done = workspace.snakemake()
    assert done.returncode == 0, done.stdout
    return workspace / "results/small"


def test_tables(atlas):
    table = pd.read_csv(atlas / "accuracy_by_region.csv")
    assert set(zip(table["load"], table["model"], strict=True)) == {
        *(("normal", model) for model in ("fsi", "generatrix", "surrogate", "fe")),
        *(("torsion", model) for model in ("generatrix", "surrogate", "fe")),
    }
    best = pd.read_csv(atlas / "best_models.csv", keep_default_na=False)
    everywhere = best[(best[["gaps", "particles", "poisson"]] == "any").all(axis=1)]
    fine = everywhere[everywhere["wanted"] == 0.01]
    assert fine["model"].tolist() == ["surrogate", "surrogate"]
    assert fine["formula"].tolist() == ["", ""]
    time = pd.read_csv(atlas / "error_against_time.csv")
    assert (time["seconds"] > 0).all()
    assert (time["points"] == 8).all()


def test_tables_agree_with_the_values(atlas):
    study = read_dataset(atlas / "study.nc", "torsion")
    error = (study.stiffness.sel(model="generatrix") / study.stiffness.sel(model="fe") - 1).values
    table = pd.read_csv(atlas / "accuracy_by_region.csv")
    rows = table[(table["load"] == "torsion") & (table["model"] == "generatrix")]
    assert rows.iloc[0]["abs_error_max"] == pytest.approx(abs(error).max())
    assert rows.iloc[0]["error_min"] == pytest.approx(error.min())


def test_report_and_figures(atlas):
    page = (atlas / "../report.html").resolve().read_text(encoding="utf-8")
    assert "Small atlas" in page
    assert "accuracy_by_region.csv" in page
    assert "paper&#39;s model, is off by" in page
    names = {path.stem for path in (atlas / "figures").glob("*.svg")}
    assert names == {
        *("error_against_time", "atlas_errors_normal", "atlas_errors_torsion"),
        *("best_formula_010", "best_formula_100"),
    }
