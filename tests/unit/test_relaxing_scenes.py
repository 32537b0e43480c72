"""Scenes whose matrix relaxes: what may be written, what is computed, what the tables say."""

import copy
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from bondcell import Prony, relaxation
from bondcell.errors import DataError, SceneError
from bondcell.jobs.batch import Batch
from bondcell.jobs.batch_files import write_batch
from bondcell.jobs.batch_plan import plan
from bondcell.jobs.cell_points import cell_at
from bondcell.jobs.collect_relaxation import collect_relaxation
from bondcell.jobs.relaxation_batch import compute_relaxation
from bondcell.jobs.rows import relaxation_rows, wanted_rows
from bondcell.results.relaxation_bonds import bond_series, bond_table
from bondcell.results.relaxation_tables import (
    accuracy_over_time,
    methods_table,
    relaxation_stability,
    shortcut_error,
)
from bondcell.results.relaxation_view import series_words
from bondcell.scenes.materials import MaterialError, known_materials, load_material, parse_material
from bondcell.scenes.parsing import load_scene, parse_scene
from bondcell.scenes.points import scene_cell
from bondcell.scenes.study import build_study
from bondcell.status import cf_flag_attributes

PARAMS = Path(__file__).parents[2] / "params"
CELL = {
    "radius_i": "7.5 mm",
    "gap": "0.5 mm",
    "young_i": "30 GPa",
    "poisson_i": 0.25,
    "young_m": "1.4 MPa",
    "poisson_m": 0.3,
}
SCENE = {
    "title": "Relaxing",
    "cell": CELL,
    "sweep": {"gap": ["0.5 mm", "2 mm", "1 mm"]},
    "models": ["fsi", "surrogate"],
    "reference": {"tolerance": 1e-4},
    "prony": {
        "series": {"two": {"weights": [0.5, 0.45], "times": ["1 ms", "2 s"]}},
        "spectrum": {"terms": [1, 4], "decades": [3], "relaxing": [0.5, 1]},
        "conventions": ["constant_bulk", "constant_poisson"],
        "times": {"start": "1 us", "stop": "100 s", "points": 9},
        "bond": {"terms": 2},
        "checks": 3,
    },
}
SHIFTED = """\
title: A rubber
kind: polymer
source: made up
temperature: 20 degC
young: 2 MPa
weights: [0.5, 0.4]
times: [1 ms, 1 s]
wlf: {c_1: 10, c_2: 50}
"""


def spoiled(**changes):
    scene = copy.deepcopy(SCENE)
    scene["prony"] |= changes
    return scene


def violations(data, **options):
    with pytest.raises(SceneError) as caught:
        parse_scene(data, **options)
    return {violation.field: violation for violation in caught.value.violations}


@pytest.fixture(scope="module")
def scene():
    return parse_scene(SCENE, name="relaxing")


@pytest.fixture(scope="module")
def result(scene, tmp_path_factory):
    """The relaxation of the whole scene by way of its batches' files."""
    folder = tmp_path_factory.mktemp("batches")
    study, files = build_study(scene), []
    rows = relaxation_rows(scene, "normal")
    cell = scene_cell(scene)
    everywhere = np.arange(cell.gap.size)
    for chosen, at in (
        (rows[:-1], everywhere),
        (rows[-1:], everywhere[::2]),
        (rows[-1:], everywhere[1::2]),
    ):
        batch = Batch(tuple(chosen), cell_at(cell, at))
        files.append(folder / f"{batch.name}.nc")
        write_batch(compute_relaxation(batch, scene.prony), files[-1], batch.name)
    relaxing = collect_relaxation(scene, study, files, "normal")
    with pytest.raises(DataError, match="points missing"):
        collect_relaxation(scene, study, files[1:2], "normal")
    whole = study.assign_coords(model=["fsi", "surrogate", "fe"]).merge(relaxing)
    start = relaxing["relaxation"].isel(convention=0, series=0, time=0, drop=True)
    dims, shape = ("model", "gap"), start.shape
    return whole.assign(
        stiffness=(dims, start.values, {"units": "N m-1", "long_name": "normal stiffness"}),
        status=(dims, np.zeros(shape, dtype=np.int8), cf_flag_attributes()),
        error_estimate=(dims, np.full(shape, 1e-9)),
    )


def test_series_of_the_scene(scene):
    names = [case.name for case in scene.prony.cases()]
    assert names == ["two", "n1_d3_r0.5", "n1_d3_r1", "n4_d3_r0.5", "n4_d3_r1"]
    four = scene.prony.cases()[3]
    np.testing.assert_allclose(four.times, 10.0 ** np.array([-1.5, -0.5, 0.5, 1.5]))
    assert sum(four.weights) == pytest.approx(0.5)
    methods = {name.rpartition("_")[0] for name in plan(scene).names("relaxation")}
    assert methods == {"relaxation_models_normal", "relaxation_fe_normal"}


def test_result_is_what_the_functions_give(scene, result):
    assert result["relaxation"].dims == ("model", "convention", "series", "gap", "time")
    assert result["K_k"].dims[-1] == "term"
    assert result["storage"].dims[-1] == "frequency"
    point = build_study(scene).isel(gap=2)
    times = result["time"].values
    curve = relaxation(point, Prony([0.5, 0.45], [1e-3, 2.0]), times, "fe", tolerance=1e-4)
    here = result.sel(model="fe", convention="constant_bulk", series="two").isel(gap=2)
    np.testing.assert_allclose(here["relaxation"], curve["stiffness"], rtol=1e-12)
    start = here["K_inf"] + here["K_k"].sum("term")
    np.testing.assert_allclose(start, curve["stiffness"][0], rtol=1e-12)
    fluid = result.sel(series="n4_d3_r1", model=["fsi", "fe"])
    assert (fluid["K_inf"] == 0).all()
    for name in ("relaxation", "K_k", "tau_k", "storage", "poisson_t", "time", "frequency"):
        assert result[name].attrs["units"], name


def test_every_series_passes_its_check(result):
    table = relaxation_stability({"normal": result})
    assert len(table) == 3 * 2 * 5 * 3
    assert table["sound"].all()
    assert (table["check_error"] <= table["check_allowed"]).all()
    wrong = result.copy(deep=True)
    wrong["correspondence_error"][0, 0, 0, 0] = 0.1
    worst = relaxation_stability({"normal": wrong}).iloc[0]
    assert not worst["sound"]
    assert worst["check_error"] == 0.1


def test_accuracy_over_time(result):
    table = accuracy_over_time({"normal": result})
    assert set(table["model"]) == {"fsi", "surrogate", "shortcut"}
    bulk = table[(table["convention"] == "constant_bulk") & (table["series"] == "two")]
    fsi = bulk[bulk["model"] == "fsi"]
    assert (fsi["error_end"] < fsi["error_start"] - 0.1).all()  # softer and softer
    assert (fsi["poisson_end"] > 0.48).all()
    wrong = bulk[bulk["model"] == "shortcut"]["abs_error_max"]
    alike = shortcut_error(result).sel(convention="constant_poisson", series="two")
    assert (wrong > 0.2).all()
    assert (abs(alike) < 1e-2).all()


def test_bonds_for_element_codes(scene, result):
    series = bond_series(scene, result)
    assert series["model"].values.tolist() == ["fe"]
    assert series["series"].values.tolist() == ["two"]
    assert series.sizes["term"] <= 2
    table = bond_table(series)
    one = table[(table["gap"] == 5e-4) & (table["convention"] == "constant_bulk")]
    lasting, *elements = one.to_dict("records")
    assert lasting["element"] == 0
    times = result["time"].values[1:]
    curve = lasting["stiffness"] + sum(
        e["stiffness"] * np.exp(-times / e["relaxation_time"]) for e in elements
    )
    true = result["relaxation"].sel(model="fe", convention="constant_bulk", series="two", gap=5e-4)
    error = np.abs(curve / true.values[1:] - 1).max()
    assert error <= lasting["error_estimate"] * (1 + 1e-6)
    assert lasting["reduction_error"] < 0.2


def test_named_materials():
    names = known_materials(PARAMS / "materials")
    assert set(names) >= {"sbs_ac13", "a70_ac25", "asphalt_twelve_terms"}
    for name in names:
        material = load_material(PARAMS / "materials", name)
        assert material.kind == "mixture"
        assert 0.95 < sum(material.shares) < 1
    twelve = load_material(PARAMS / "materials", "asphalt_twelve_terms")
    assert twelve.instantaneous == pytest.approx(28911.8e6)
    assert load_material(PARAMS / "materials", "sbs_ac13").temperature == 293.15


def test_bad_materials(tmp_path):
    with pytest.raises(MaterialError, match=r"none: .* holds no material"):
        load_material(tmp_path, "rubber")
    good = {"title": "A", "kind": "other", "source": "b", "weights": [0.5], "young": 1e6}
    with pytest.raises(MaterialError) as caught:
        parse_material(good | {"times": ["1 mm"], "kind": "jelly", "wlf": {"c_3": 1}})
    fields = {violation.field for violation in caught.value.violations}
    assert fields == {"times.0", "kind", "wlf.c_3", "wlf.c_1", "wlf.c_2"}
    with pytest.raises(MaterialError, match=r"young = -1: .* above 0 Pa"):
        parse_material(good | {"young": -1})
    with pytest.raises(MaterialError, match=r"material = .*either weights and young, or moduli"):
        parse_material(good | {"times": [1], "moduli": ["1 MPa"]})


def test_temperature_shifts_the_times(tmp_path):
    (tmp_path / "rubber.yaml").write_text(SHIFTED)
    data = spoiled(materials=["rubber"], temperatures=["20 degC", "30 degC"], checks=0)
    del data["prony"]["spectrum"], data["prony"]["series"]
    scene = parse_scene(data, materials=tmp_path)
    cold, warm = scene.prony.cases()
    assert (cold.temperature, warm.temperature) == (293.15, 303.15)
    factor = scene.prony.known_material("rubber").shift(303.15)
    assert factor == pytest.approx(10 ** (-100 / 60))
    batch = Batch(tuple(relaxation_rows(scene, "normal")[:1]), scene_cell(scene).ravel())
    found = compute_relaxation(batch, scene.prony)
    ratio = found["tau_k"].isel(series=1) / found["tau_k"].isel(series=0)
    np.testing.assert_allclose(ratio, factor, rtol=1e-12)
    wrong = violations(spoiled(materials=["rubber"], temperatures=["-40 degC"]), materials=tmp_path)
    assert "pole" in wrong["prony.temperatures.0"].allowed
    wrong = violations(
        spoiled(materials=["rubber"], temperatures=["-29.9 degC"]), materials=tmp_path
    )
    assert "stay in [1e-30, 1e+30] s" in wrong["prony.temperatures.0"].allowed


@pytest.mark.parametrize(
    ("changes", "field", "words"),
    [
        ({"materials": ["rubber"]}, "prony.materials.0", "a file of the folder materials"),
        ({"temperatures": ["20 degC"]}, "prony.temperatures", "without named materials"),
        ({"temperatures": [20]}, "prony.temperatures.0", "with its unit"),
        ({"own_modulus": True}, "prony.own_modulus", "only with named materials"),
        ({"conventions": "separate"}, "prony.conventions.0", "one of constant_bulk"),
        ({"times": {"start": 1, "stop": 1}}, "prony.times", "a stop above start"),
        ({"times": {"start": "1 mm", "stop": 1}}, "prony.times.start", "a time"),
        ({"bond": {"models": ["film"]}}, "prony.bond.models.0", "one of this scene's"),
        ({"methods": {"series": ["three"]}}, "prony.methods.series.0", "a series of this scene"),
        ({"checks": -1}, "prony.checks", "a whole number in [0, 100]"),
        ({"bond": {"terms": 2, "error": 0.1}}, "prony.bond", "either terms or error"),
        (
            {"series": {"two": {"weights": [0.5, 0.5 + 1e-13], "times": [1, 2]}}},
            "prony.series.two",
            "add up to at most 1",
        ),
        (
            {"spectrum": {"terms": [3], "decades": [2, 50], "centre": 1e20}},
            "prony.spectrum.decades.1",
            "times around 1e+20 s in",
        ),
        (
            {"series": {"two": {"weights": [0.7, 0.5], "times": [1, 2]}}},
            "prony.series.two",
            "at most 1",
        ),
        (
            {"series": {"two": {"weights": [0.7], "times": [1, 2]}}},
            "prony.series.two",
            "as many times",
        ),
        (
            {"spectrum": {"terms": [0], "decades": [2]}},
            "prony.spectrum.terms.0",
            "a whole number in [1, 1000]",
        ),
        ({"spectra": {}}, "prony.spectra", "did you mean"),
    ],
)
def test_bad_scenes(changes, field, words):
    found = violations(spoiled(**changes))
    assert words in found[field].allowed


def test_all_violations_at_once():
    found = violations(
        spoiled(checks=101, own_modulus=True, methods={"series": ["x"]}) | {"models": ["fzi"]}
    )
    assert {"prony.checks", "models.0"} <= set(found)
    nothing = copy.deepcopy(SCENE)
    del nothing["models"], nothing["reference"]
    assert "prony" in violations(nothing)


def test_digests_follow_the_materials(tmp_path):
    path = tmp_path / "scene.yaml"
    (tmp_path / "materials").mkdir()
    material = tmp_path / "materials" / "rubber.yaml"
    material.write_text(SHIFTED)
    path.write_text(
        "title: A\nmodels: [fsi]\n"
        "cell: {radius_i: 1, gap: 0.1, young_i: 1e9, young_m: 1e6, poisson_i: 0, poisson_m: 0}\n"
        "prony: {materials: [rubber], times: {start: 1, stop: 2}}\n"
    )
    before = load_scene(path)
    material.write_text(SHIFTED.replace("0.4]", "0.3]"))
    after = load_scene(path)
    assert before.prony_digest != after.prony_digest
    assert before.digest != after.digest
    models = [[row for row in wanted_rows(s) if row.kind == "analytic"] for s in (before, after)]
    assert models[0] == models[1]
    material.write_text(SHIFTED.replace("kind: polymer", "kind: jelly"))
    with pytest.raises(SceneError, match=r"materials/rubber\.kind"):
        load_scene(path)


def test_scene_without_prony_imports_nothing_of_it():
    code = (
        "import sys\n"
        "from bondcell.scenes.parsing import parse_scene\n"
        "from bondcell.scenes.study import build_study\n"
        "from bondcell.jobs.collect import collect\n"
        f"data = {dict(SCENE, prony=None)!r}\n"
        "del data['prony'], data['reference']\n"
        "scene = parse_scene(data)\n"
        "result = collect(scene, build_study(scene), [], [])\n"
        "assert 'time' not in result.dims\n"
        "found = [n for n in sys.modules if n.startswith('bondcell.prony')]\n"
        "assert not found, found\n"
        "assert not [n for n in sys.modules if n.startswith('bondcell.jobs.relaxation_batch')]\n"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


def test_methods_in_time():
    from bondcell.jobs.relaxation_methods import run_methods

    methods = {"series": ["two"], "order": 3, "steps": [1, 2], "nodes": [6], "times": 2}
    found = run_methods(parse_scene(spoiled(methods=methods, checks=0)))
    table = methods_table(found).set_index(["method", "level"])
    assert (table["status"] == "ok").all()
    error = table["error"]
    assert error["exact_series", 2] < 1e-6 < error["time_stepping", 1]
    assert error["time_stepping", 1] < error["time_stepping", 0]
    assert error["laplace_inversion", 0] < 1e-2
    assert error["shortcut", 0] > 0.1
    assert (table["seconds"] > 0).all()


def test_names_in_words():
    assert series_words("n1_d3_r0.5") == "1 term, 50 % relaxes"
    assert series_words("n4_d3_r1_falling") == "4 terms over 3 decades, 100 % relaxes, falling"
    assert series_words("one_dominant") == "one dominant"


def test_report_and_figures(scene, result, tmp_path):
    from bondcell.figures import draw_scene
    from bondcell.report.sections import build_section
    from bondcell.storage import write_dataset

    folder = tmp_path / scene.name
    write_dataset(result, folder / "study.nc")
    write_dataset(bond_series(scene, result), folder / "bond_series.nc")
    paths = draw_scene(scene, result, None, folder / "figures")
    names = {path.stem for path in paths}
    assert names == {"relaxation", "complex_stiffness", "error_over_time", "relaxation_checks"}
    section = build_section(scene, tmp_path)
    text = " ".join(finding.text for finding in section.findings)
    assert "good at t = 0 need not be good later" in text
    assert "90 of 90 series are sound" in text
    assert "shortcut K(0) g(t) is wrong" in text
    assert all(len(line) == len(t.header) for t in section.tables for line in t.lines)
