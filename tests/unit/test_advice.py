"""Advice: the accuracy map's code, its lookup, the model chosen and the reasons said."""

import json
import math
from importlib import import_module

import numpy as np
import pytest
import xarray as xr

import bondcell
from bondcell.advice import MOST_MEASURED
from bondcell.cell import Cell
from bondcell.cli import main
from bondcell.results.accuracy_map import (
    NO_VALUE,
    SMALLEST,
    STEP,
    AccuracyMap,
    decode,
    delta,
    encode,
    shipped_map,
    undelta,
)

BASE = {
    "radius_i": 7.5e-3,
    "gap": 5e-4,
    "young_i": 3e10,
    "young_m": 1.4e6,
    "poisson_i": 0.25,
    "poisson_m": 0.46,
}
UNEQUAL = BASE | {"radius_j": 5e-3}


def test_codes_round_sizes_up_and_keep_signs():
    error = np.concatenate([-np.geomspace(1e-6, 50, 300), [0.0], np.geomspace(1e-6, 50, 300)])
    found = decode(encode(error))
    assert (np.abs(found) >= np.abs(error) * (1 - 1e-6)).all()
    assert (np.abs(found) <= np.maximum(np.abs(error) * STEP, SMALLEST) * (1 + 1e-6)).all()
    large = np.abs(error) > SMALLEST * STEP
    assert (np.sign(found) == np.sign(error))[large].all()
    assert encode(np.array([np.nan]))[0] == NO_VALUE
    assert decode(encode(np.array([1e9, -1e9]))).tolist() == [np.inf, -np.inf]


def test_differences_give_all_codes_back():
    codes = np.random.default_rng(1).integers(-1000, 402, (3, 4, 50)).astype(np.int16)
    assert (undelta(delta(codes)) == codes).all()


@pytest.fixture
def small_map():
    """Errors 0.1 (k + 1) at gap k, ten times that for rigid particles, none at nu_m = 1/2."""
    error = np.empty((3, 2, 2))
    error[...] = 0.01 * np.array([1, 2, 3])[:, None, None]
    error[:, 1] *= 10
    error[:, :, 1] = np.nan
    axes = {"gap_ratio": [1e-2, 1e-1, 1.0], "modulus_ratio": [1, np.inf], "poisson_m": [0, 0.5]}
    about = {
        "poisson_particle": [0, 0.45],
        "margins": {"normal": {"fsi": 2.0}},
        "many": 100,
        "seconds": {"normal": {"fsi": {"one": 1.01, "many": 0.01}}},
    }
    arrays = {name: np.array(values, dtype=float) for name, values in axes.items()}
    return AccuracyMap(arrays, {"normal": {"fsi": encode(error)}}, about)


def cell(gap, ratio=1.0, poisson_m=0.0, **others):
    given = {"radius_i": 2.0, "young_m": 1.0, "poisson_i": 0.2} | others
    return Cell.from_values(
        gap=2.0 * np.asarray(gap), young_i=ratio, poisson_m=poisson_m, **given
    ).ravel()


def test_expected_error_is_the_largest_of_the_neighbours(small_map):
    found = small_map.expected("normal", "fsi", cell([0.1, 0.05, 0.5, 1.0])).error / 2
    assert found == pytest.approx([0.02, 0.02, 0.03, 0.03], rel=STEP - 1)
    found = small_map.expected("normal", "fsi", cell(0.1, 100.0))
    assert found.error[0] / 2 == pytest.approx(0.2, rel=STEP - 1)
    assert (found.low[0], found.high[0]) == pytest.approx((0.02, 0.2), rel=STEP - 1)
    assert np.isnan(small_map.expected("normal", "fsi", cell(0.1, poisson_m=0.4)).error[0])


def test_off_the_map_nothing_is_expected(small_map):
    off = [cell(2.0), cell(1e-3), cell(0.1, 0.5), cell(0.1, radius_j=1.0)]
    off += [cell(0.1, cylinder_radius=3.0), cell(0.1, poisson_m=-0.1), cell(0.1, young_j=3.0)]
    off += [cell(0.1, poisson_i=0.49)]
    for place in off:
        assert not small_map.contains(place).any()
        assert np.isnan(small_map.expected("normal", "fsi", place).error).all()
        assert small_map.why_outside(place)[0]
    assert small_map.contains(cell([0.01, 1.0], np.inf)).all()


def test_a_call_shares_its_fixed_cost(small_map):
    assert small_map.seconds("normal", "fsi", 1) == pytest.approx(1.01)
    assert small_map.seconds("normal", "fsi", 1000) == pytest.approx(0.011)


def test_base_case_needs_more_than_the_papers_model():
    advice = bondcell.advise(BASE, error=0.01)
    assert (advice.model, advice.formula, advice.source) == ("surrogate", "film", "map")
    assert advice.expected_error <= 0.01
    assert advice.inside_range
    fsi = next(found for found in advice.candidates if found.model == "fsi")
    assert fsi.error_low <= 84055.131 / 162460.767 - 1 <= fsi.error_high
    assert fsi.expected_error >= 0.48
    assert "Poisson's effect" in advice.paper
    assert "Why not FSI" in str(advice)


def test_the_papers_model_where_it_serves():
    advice = bondcell.advise(BASE | {"poisson_m": 0.0}, error=0.3)
    assert advice.model in {"fsi", "general", "generatrix"}
    assert "serves here" in advice.paper


def test_soft_particles_are_the_reason():
    paper = bondcell.advise(BASE | {"young_m": 3e10, "poisson_m": 0.0}, error=0.01).paper
    assert "soft particles" in paper
    assert "Poisson's effect, which" not in paper


@pytest.mark.parametrize("load", ["shear", "torsion", "bending"])
def test_other_loads(load):
    advice = bondcell.advise(BASE, error=0.01, load=load)
    assert (advice.model, advice.formula) == ("surrogate", "film")
    assert f"it has no {load}" in advice.paper


def test_nothing_but_finite_elements_for_a_tiny_error():
    advice = bondcell.advise(BASE, error=1e-6)
    assert (advice.model, advice.formula) == ("fe", "")


def test_unequal_pairs_are_off_the_map():
    advice = bondcell.advise(UNEQUAL)
    assert (advice.model, advice.source, advice.formula) == ("fe", "none", "")
    assert "not equal" in str(advice)
    assert all(np.isnan(c.expected_error) for c in advice.candidates if c.model != "fe")


def test_measured_errors_of_an_unequal_pair():
    advice = bondcell.advise(UNEQUAL, error=0.01, measure=True)
    assert (advice.model, advice.source) == ("film", "measured")
    assert 0 < advice.expected_error < 0.01


def test_many_cells_count_by_the_worst():
    study = xr.Dataset(BASE | {"poisson_m": ("nu", [0.0, 0.46])})
    several = bondcell.advise(study, error=0.3)
    worst = bondcell.advise(BASE, error=0.3)
    assert several.cells == 2
    fsi = [
        next(c for c in advice.candidates if c.model == "fsi").expected_error
        for advice in (several, worst)
    ]
    assert fsi[0] == fsi[1]


@pytest.mark.parametrize(
    ("wrong", "field"),
    [({"error": 0}, "error"), ({"error": "x"}, "error"), ({"error": 2}, "error")],
)
def test_bad_wishes(wrong, field):
    with pytest.raises(bondcell.InputError, match=field):
        bondcell.advise(BASE, **wrong)


def test_bad_input():
    with pytest.raises(bondcell.UnsupportedLoad):
        bondcell.advise(BASE, load="twist")
    with pytest.raises(bondcell.InputError, match="gap"):
        bondcell.advise(BASE | {"gap": -1})
    with pytest.raises(bondcell.InputError, match="study"):
        bondcell.advise(3.0)
    many = BASE | {"gap": np.linspace(1e-4, 1e-3, MOST_MEASURED + 1)}
    with pytest.raises(bondcell.InputError, match="measure"):
        bondcell.advise(many, measure=True)


OPTIONS = [
    *("--radius", "7.5mm", "--gap", "0.5mm", "--young-particle", "30GPa"),
    *("--poisson-particle", "0.25", "--young-matrix", "1.4MPa", "--poisson-matrix", "0.46"),
]


def test_command(capsys):
    assert main(["advise", *OPTIONS, "--error", "1 %"]) == 0
    text = capsys.readouterr().out
    assert "surrogate" in text.splitlines()[0]
    assert "Why not FSI" in text
    assert "film" in text


def test_command_for_programs(capsys):
    assert main(["advise", *OPTIONS, "--load", "bending", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["model"] == "surrogate"
    assert found["load"] == "bending"
    assert {c["model"] for c in found["candidates"]} == {"generatrix", "film", "surrogate", "fe"}


def test_bad_command(capsys):
    assert main(["advise", *OPTIONS[2:], "--error", "200", "--load", "twist"]) == 2
    text = capsys.readouterr().err
    assert all(option in text for option in ("--radius", "--error", "--load"))


def test_shipped_map_is_small_and_says_where_it_comes_from():
    found = shipped_map()
    assert found.axes["gap_ratio"][[0, -1]].tolist() == [1e-4, 3.0]
    assert math.isinf(found.axes["modulus_ratio"][-1])
    assert {"versions", "machine", "source", "margins", "seconds"} <= set(found.about)
    assert found.about["reference_error"] <= 2e-6
    assert set(found.codes) == {"normal", "shear", "torsion", "bending"}
    assert "fsi" in found.codes["normal"]


@pytest.mark.parametrize("study", [[1, 2], "gap", None, 3.0])
def test_a_study_is_a_mapping(study):
    with pytest.raises(bondcell.InputError, match=r"study = .*a mapping of inputs"):
        bondcell.advise(study)


def test_error_off_the_map_is_what_is_asked_of_the_reference():
    advice = bondcell.advise(BASE | {"young_i": 1.0})
    assert (advice.model, advice.source) == ("fe", "none")
    assert "error by its tolerance 1e-4 %, wanted 1 %" in str(advice)


def test_measured_reference_is_as_good_as_it_says(monkeypatch):
    module = import_module("bondcell.by_geometry")
    real = module.solve_points

    def coarse(*arguments, **more):
        found = real(*arguments, **more)
        found.error_estimate[:] = estimate
        found.stiffness[:] += 0 * estimate
        return found

    monkeypatch.setattr(module, "solve_points", coarse)
    soft = BASE | {"young_i": 1e6}
    for estimate, said in ((1e-9, "measured 1e-4 %"), (0.03, "measured 3 %")):
        advice = bondcell.advise(soft, error=1e-5, measure=True)
        assert advice.model == "fe"
        assert said in str(advice)
        assert advice.candidates[-1].serves(1e-5) == (estimate < 1e-5)
        assert ("No model is known to stay within" in str(advice)) == (estimate > 1e-5)
    estimate = np.nan
    advice = bondcell.advise(soft, error=0.5, measure=True)
    assert math.isnan(advice.expected_error)
    assert "not known" in str(advice)


def test_measure_is_yes_or_no():
    with pytest.raises(bondcell.InputError, match="measure = 'yes': allowed is True or False"):
        bondcell.advise(BASE, measure="yes")
