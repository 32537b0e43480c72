"""Designs from end to end: a Sobol' sequence, a Latin hypercube and a table, and their growth."""

import json

import numpy as np
import pandas as pd
import pytest

from bondcell.cell import UNITS
from bondcell.evaluate import evaluate
from bondcell.storage import read_dataset

pytestmark = pytest.mark.slow  # tests/unit/test_designs.py has what needs no workflow

CELL = "cell: {radius_i: 7.5 mm, young_i: 30 GPa, poisson_i: 0.25, poisson_m: 0.3}"
SOBOL = f"""\
title: A sequence
{CELL}
sweep: {{gap: [0.5 mm, 2 mm]}}
design:
  kind: sobol
  points: 4
  seed: 7
  ranges:
    modulus_ratio: {{start: 10, stop: 1e4, spacing: log}}
    poisson_m: {{start: 0, stop: 0.4}}
models: [fsi, generatrix]
reference: {{tolerance: 1e-2}}
stability: true
"""
HYPERCUBE = f"""\
title: A hypercube
{CELL}
design:
  kind: latin_hypercube
  points: [3, 4]
  ranges:
    gap_ratio: {{start: 1e-3, stop: 1, spacing: log}}
    young_m: {{start: 1 MPa, stop: 2 MPa}}
models: [fsi]
"""
TABLE = f"""\
title: A table
{CELL.replace("}", ", young_m: 1 MPa}")}
design: {{table: points.csv}}
models: [fsi, generatrix]
"""
POINTS = """\
gap, modulus_ratio
0.5 mm, 10
1e-3, 1000
0.001, 1e3
2 mm, rigid
"""


@pytest.fixture(scope="module")
def designs(make_workspace, tmp_path_factory):
    folder = tmp_path_factory.mktemp("designs")
    workspace = make_workspace(folder, sequence=SOBOL, hypercube=HYPERCUBE, table=TABLE)
    workspace.write("params/points.csv", POINTS)
    del workspace.environment["MODULES_FOLDER"]
    done = workspace.snakemake()
    assert done.returncode == 0, done.stdout
    return workspace


def check(study, models):
    """The file's values are those of its own inputs."""
    assert (study["status"].sel(model=models) == 0).all()
    inputs = study.drop_vars([name for name in study.data_vars if name not in UNITS] + ["model"])
    for model in models:
        expected = evaluate(inputs, model)["stiffness"]
        found = study["stiffness"].sel(model=model)
        np.testing.assert_allclose(found, expected.transpose(*found.dims), rtol=1e-12)


def test_sequence_beside_a_sweep(designs):
    study = read_dataset(designs / "results/sequence/study.nc")
    assert study["stiffness"].dims == ("model", "gap", "sample")
    assert study["modulus_ratio"].dims == study["young_m"].dims == ("sample",)
    check(study, ["fsi", "generatrix"])
    assert (study["status"] == 0).all()
    about = json.loads(study.attrs["design"])
    assert (about["kind"], about["seed"], about["points"]) == ("sobol", 7, [4])
    table = pd.read_csv(designs / "results/sequence/accuracy.csv")
    assert {"at_gap", "at_modulus_ratio", "at_poisson_m"} <= set(table.columns)
    assert set(table["group_axis"]) == {"all", "gap"}
    error = study["stiffness"].sel(model="fsi") / study["stiffness"].sel(model="fe") - 1
    worst = error.isel(abs(error).argmax(...))
    row = table[(table["model"] == "fsi") & (table["group_axis"] == "all")].iloc[0]
    assert row["at_modulus_ratio"] == pytest.approx(worst["modulus_ratio"].item())
    assert row["at_gap"] == worst["gap"].item()
    stability = pd.read_csv(designs / "results/sequence/stability.csv")
    assert len(stability) == 8
    assert stability["modulus_ratio"].between(10, 1e4).all()


def test_hypercube_fills_every_parameter_evenly(designs):
    study = read_dataset(designs / "results/hypercube/study.nc")
    assert study["stiffness"].dims == ("model", "sample")
    check(study, ["fsi"])
    share = np.log(study["gap_ratio"].values / 1e-3) / np.log(1e3)
    assert sorted(np.floor(3 * share[:3])) == [0, 1, 2]
    assert sorted(np.floor(4 * share[3:])) == [0, 1, 2, 3]


def test_table_as_it_stands(designs):
    study = read_dataset(designs / "results/table/study.nc")
    check(study, ["fsi", "generatrix"])
    assert study["gap"].values.tolist() == [5e-4, 1e-3, 1e-3, 2e-3]
    assert study["young_i"].values[-1] == np.inf
    assert study["young_m"].values[-1] == 1e6
    pair = study["stiffness"].isel(sample=[1, 2]).values
    assert (pair[:, 0] == pair[:, 1]).all()


def test_figures_and_report_tell_of_them(designs):
    for name in ("sequence", "hypercube", "table"):
        assert (designs / f"results/{name}/figures/stiffness.svg").is_file()
    page = (designs / "results/report.html").read_text()
    for words in ("Sobol&#39; sequence, seed 7", "of the table points.csv", "in 2 hypercubes"):
        assert words in page, words


def test_more_samples_keep_the_first_ones(designs):
    before = read_dataset(designs / "results/sequence/study.nc")
    folder = designs / "results/sequence/batches"
    batches = {path: path.read_bytes() for path in folder.glob("*.nc")}
    designs.write("params/sequence.yaml", SOBOL.replace("points: 4", "points: 6"))
    done = designs.snakemake("results/sequence/study.nc")
    assert done.returncode == 0, done.stdout
    study = read_dataset(designs / "results/sequence/study.nc")
    np.testing.assert_array_equal(study["stiffness"].isel(sample=slice(4)), before["stiffness"])
    assert all(path.read_bytes() == content for path, content in batches.items())
    new = set(folder.glob("*.nc")) - set(batches)
    assert [read_dataset(path).sizes["point"] for path in new] == [4]  # two samples at two gaps


def test_an_edited_table_is_noticed(designs):
    designs.write("params/points.csv", POINTS.replace("2 mm", "3 mm"))
    done = designs.snakemake("results/table/study.nc")
    assert done.returncode == 0, done.stdout
    study = read_dataset(designs / "results/table/study.nc")
    assert study["gap"].values[-1] == 3e-3
    designs.write("params/points.csv", POINTS.replace("rigid", "stiff").replace("0.5 mm", ""))
    done = designs.snakemake("results/table/study.nc")
    assert done.returncode == 2
    for words in ("design.table points.csv.modulus_ratio.3 = 'stiff'", "points.csv.gap.0 = ''"):
        assert words in done.stdout
