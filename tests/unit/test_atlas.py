"""Accuracy atlas: its key in a scene, tables by region, best models."""

import numpy as np
import pytest
import xarray as xr

from bondcell.errors import SceneError
from bondcell.figures import atlas_drawings
from bondcell.figures.atlas_maps import best_formula
from bondcell.figures.style import drawing_style, save
from bondcell.report.atlas_part import atlas_part
from bondcell.results.atlas import Region, atlas_tables, regions
from bondcell.scenes.parsing import parse_scene
from bondcell.status import Status

CELL = {"radius_i": "7.5 mm", "young_i": "30 GPa", "young_m": "1.4 MPa", "poisson_i": 0.25}
SWEEP = {"gap_ratio": [0.01, 0.1], "modulus_ratio": [1, "rigid"], "poisson_m": [0, 0.5]}
ATLAS = {
    "title": "Atlas",
    "cell": CELL,
    "sweep": SWEEP,
    "models": ["fsi"],
    "reference": {"bc": "roller"},
    "atlas": True,
}


def test_an_atlas_is_off_by_default():
    assert parse_scene(ATLAS).atlas
    assert not parse_scene(ATLAS | {"atlas": False}).atlas
    assert not parse_scene({key: value for key, value in ATLAS.items() if key != "atlas"}).atlas


@pytest.mark.parametrize("without", ["models", "reference", "gap_ratio", "poisson_m"])
def test_an_atlas_needs_its_axes_models_and_a_reference(without):
    scene = {key: value for key, value in ATLAS.items() if key != without}
    scene["sweep"] = {axis: values for axis, values in SWEEP.items() if axis != without}
    scene["cell"] = CELL | {"gap": "1 mm", "poisson_m": 0.3}
    with pytest.raises(SceneError, match="atlas = True") as caught:
        parse_scene(scene)
    assert "gap_ratio, modulus_ratio, poisson_m" in str(caught.value)


def result(load="normal"):
    """An atlas of three models with made-up errors: fsi 10 %, film 1 %, surrogate 0.1 %."""
    axes = {"gap_ratio": [0.1, 1.0, 3.0], "modulus_ratio": [10.0, 100.0, np.inf]}
    axes |= {"poisson_m": [0.3, 0.49, 0.5]}
    names = ["fsi", "film", "surrogate", "fe"]
    true = np.full((3, 3, 3), 100.0)
    stiffness = np.stack([0.9 * true, 1.01 * true, 1.001 * true, true])
    stiffness[0, 2, 0, 2] = 300.0  # wide, soft, near 1/2
    status = np.zeros(stiffness.shape, dtype=np.int8)
    status[1, :, 0] = Status.outside_valid_range  # film, soft particles
    stiffness[2, 0], status[2, 0] = np.nan, Status.not_computed  # surrogate, film gaps
    seconds = np.empty(stiffness.shape)
    seconds[...] = np.array([1e-6, 1e-3, 1e-5, 0.1])[:, None, None, None]
    dims = ("model", *axes)
    return xr.Dataset(
        {
            "stiffness": (dims, stiffness, {"long_name": f"{load} stiffness"}),
            "status": (dims, status),
            "seconds": (dims, seconds),
            "error_estimate": (dims, np.full(stiffness.shape, 1e-6)),
        },
        coords={"model": names, **axes},
    )


@pytest.fixture(scope="module")
def tables():
    return dict(atlas_tables({"normal": result()}))


def row(table, **wanted):
    for name, value in wanted.items():
        table = table[table[name] == value]
    assert len(table) == 1
    return table.iloc[0]


def test_bands_share_the_points_without_overlap():
    study = result()
    whole = [region for region in regions() if "any" not in region.bands().values()]
    assert len(whole) == 18
    assert (sum(region.mask(study).astype(int) for region in whole) == 1).all()
    stiff = Region(particles="stiff").mask(study)
    assert stiff.any(axis=(0, 2)).tolist() == [False, True, True]
    assert Region(poisson="high").mask(study).any(axis=(0, 1)).tolist() == [False, True, False]
    assert Region(gaps="film").mask(study).any(axis=(1, 2)).tolist() == [True, False, False]


def test_errors_of_a_region(tables):
    table = tables["accuracy_by_region"]
    found = row(table, gaps="any", particles="any", poisson="any", model="fsi")
    assert found["abs_error_max"] == pytest.approx(2.0)
    assert found["abs_error_median"] == pytest.approx(0.1)
    assert (found["error_min"], found["error_max"]) == pytest.approx((-0.1, 2.0))
    assert (found["points"], found["points_outside"], found["left_out"]) == (27, 0, 0)
    found = row(table, gaps="film", particles="stiff", poisson="low", model="fsi")
    assert found["abs_error_max"] == pytest.approx(0.1)
    found = row(table, gaps="any", particles="any", poisson="any", model="film")
    assert (found["points"], found["points_outside"]) == (27, 9)
    found = row(table, gaps="any", particles="any", poisson="any", model="surrogate")
    assert (found["points"], found["left_out"]) == (18, 9)
    found = row(table, gaps="any", particles="any", poisson="any", model="fe")
    assert found["abs_error_max"] == 1e-6


@pytest.mark.parametrize(
    ("region", "wanted", "model", "formula"),
    [
        (("film", "stiff", "low"), 0.3, "fsi", "fsi"),
        (("film", "stiff", "low"), 0.03, "film", "film"),
        (("wide", "stiff", "low"), 0.03, "surrogate", "film"),
        (("wide", "stiff", "low"), 1e-4, "fe", ""),
        (("film", "soft", "low"), 0.03, "fe", ""),  # film is outside its range, surrogate silent
        (("wide", "soft", "near 1/2"), 0.3, "surrogate", ""),
        (("any", "any", "any"), 0.3, "fe", ""),
    ],
)
def test_best_models(tables, region, wanted, model, formula):
    gaps, particles, poisson = region
    found = row(
        tables["best_models"], gaps=gaps, particles=particles, poisson=poisson, wanted=wanted
    )
    assert (found["model"], found["formula"]) == (model, formula)
    if model == "fsi":
        assert found["seconds"] == 1e-6


def test_error_against_time_has_a_row_for_each_model(tables):
    table = tables["error_against_time"]
    assert table["model"].tolist() == ["fsi", "film", "surrogate", "fe"]
    assert row(table, model="film")["seconds"] == 1e-3


def test_figures_and_words_of_an_atlas(tmp_path):
    loads = {"normal": result(), "shear": result("shear")}
    with drawing_style():
        drawings = list(atlas_drawings(loads))
        names = [drawing.name for drawing in drawings]
        assert [path.suffix for path in save(drawings[0], tmp_path)] == [".svg", ".png"]
    assert names == [
        *("error_against_time", "atlas_errors_normal", "atlas_errors_shear"),
        *("best_formula_100", "best_formula_010"),
    ]
    assert "surrogate: of the points" in drawings[1].description
    findings, tables = atlas_part(loads)
    assert findings[0].key == "10 %"
    said = " ".join(finding.text for finding in findings)
    assert "FSI, the paper's model, is off by 10 % in the median and 200 % at most" in said
    assert "normal 1 % and 1 %" in said
    assert [len(table.lines) for table in tables[1:]] == [19, 19, 19, 9]
    whole = tables[1].lines[0]
    assert whole[:4] == ["all", "all", "all", "200 / 10"]
    assert whole[5] == "0.1 / 0.1–"


def test_best_formula_is_the_cheapest_that_serves():
    names, best = best_formula(result(), 0.3)
    assert names == ["fsi", "film"]
    assert best[0, 0, 0] == 0  # fsi, within 10 %
    assert best[2, 0, 2] == 2  # fsi is off, film outside its range
    names, best = best_formula(result(), 0.03)
    assert (best[:, 1:] == 1).all()
