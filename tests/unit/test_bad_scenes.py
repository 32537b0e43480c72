"""Bad scenes and files: one clear error each, every violation at once, nothing else raised."""

import contextlib
import copy
import warnings
from pathlib import Path

import pytest

from bondcell.errors import SceneError
from bondcell.scenes.parsing import load_scene, parse_scene
from bondcell.scenes.study_list import load_study_list
from bondcell.scenes.validate import validate_file
from bondcell.scenes.yaml_loading import load_mapping
from bondcell.scenes.yaml_structure import MOST_NODES

CELL = {
    "radius_i": "7.5 mm",
    "gap": "0.5 mm",
    "young_i": "30 GPa",
    "poisson_i": 0.25,
    "young_m": "1.4 MPa",
    "poisson_m": 0.46,
}
SCENE = {
    "title": "A scene",
    "cell": CELL,
    "sweep": {"modulus_ratio": [1, 10], "poisson_m": {"start": 0, "stop": 0.4, "points": 3}},
    "models": ["fsi", "generatrix"],
    "reference": {"bc": ["roller"], "tolerance": 1e-6},
    "contributions": True,
    "convergence": {"cases": {"base": {}}, "orders": [2, 4], "sizes": [1, 0.5], "repeats": 1},
}


def violations(data, name="scene"):
    """Field -> violation of everything that is wrong with a scene."""
    with pytest.raises(SceneError) as caught:
        parse_scene(data, name=name)
    return {violation.field: violation for violation in caught.value.violations}


def spoiled(path, value):
    """The scene with one key replaced; the value ... removes it."""
    scene = copy.deepcopy(SCENE)
    *folders, last = path.split(".")
    block = scene
    for folder in folders:
        block = block[folder]
    if value is ...:
        del block[last]
    else:
        block[last] = value
    return scene


def test_the_scene_that_is_spoiled_is_good():
    assert parse_scene(SCENE).points == 6


@pytest.mark.parametrize(
    ("path", "value", "field", "allowed"),
    [
        ("title", ..., "title", "required"),
        ("title", " ", "title", "text"),
        ("title", 5, "title", "text"),
        ("title", "x" * 201, "title", "200 characters"),
        ("title", "\ud800", "title", "surrogates"),
        ("question", "", "question", "text"),
        ("cell", "7.5 mm", "cell", "a mapping of keys to values: radius_i"),
        ("cell", None, "cell", "leave the key out"),
        ("cell.gap", 0, "cell.gap", "(0, inf) m"),
        ("cell.gap", "-0.5 mm", "cell.gap", "(0, inf) m"),
        ("cell.gap", "a little", "cell.gap", "a length [m]"),
        ("cell.gap", "0.5 MPa", "cell.gap", "MPa is no length"),
        ("cell.gap", "0.5 parsnips", "cell.gap", "parsnips is no known unit"),
        ("cell.gap", float("nan"), "cell.gap", "finite"),
        ("cell.gap", float("inf"), "cell.gap", "finite"),
        ("cell.gap", True, "cell.gap", "a length [m]"),
        ("cell.gap", [1e-3], "cell.gap", "a length [m]"),
        ("cell.gap", None, "cell.gap", "leave the key out"),
        ("cell.radius_i", ..., "cell.radius_i", "required"),
        ("cell.young_i", -3e10, "cell.young_i", "(0, inf] Pa"),
        ("cell.young_i", "stiff", "cell.young_i", "or rigid"),
        ("cell.young_m", "rigid", "cell.young_m", "a pressure [Pa]"),
        ("cell.young_m", -1.4e6, "cell.young_m", "(0, inf) Pa"),
        ("cell.poisson_i", 0.51, "cell.poisson_i", "(-1, 0.5]"),
        ("cell.poisson_i", -1, "cell.poisson_i", "(-1, 0.5]"),
        ("cell.poisson_m", "0.46 m", "cell.poisson_m", "without unit"),
        ("cell.cylinder_radius", "7 mm", "cell.cylinder_radius", "at least 0.0075 m"),
        ("cell.raduis_i", "7 mm", "cell.raduis_i", "did you mean radius_i?"),
        ("sweep", {}, "sweep", "at least one axis"),
        ("sweep", None, "sweep", "leave the key out"),
        ("sweep", ["gap"], "sweep", "a mapping"),
        ("sweep.gap", [], "sweep.gap", "at least one value"),
        ("sweep.gap", "1 mm", "sweep.gap", "a list of values"),
        ("sweep.gap", None, "sweep.gap", "leave the key out"),
        ("sweep.gap", [1e-3, None], "sweep.gap.1", "a length [m]"),
        ("sweep.gap", ["1 mm", 1e-3], "sweep.gap", "0.001 is repeated"),
        ("sweep.gap", ["1 mm", "0 mm"], "sweep.gap", "(0, inf) m"),
        ("sweep.gap", {"start": 1e-3, "stop": 1}, "sweep.gap.points", "required"),
        ("sweep.poisson_m.points", 0, "sweep.poisson_m.points", "[2, 10000000]"),
        ("sweep.poisson_m.points", 2.5, "sweep.poisson_m.points", "whole number"),
        ("sweep.poisson_m.points", True, "sweep.poisson_m.points", "whole number"),
        ("sweep.poisson_m.points", 1e12, "sweep.poisson_m.points", "[2, 10000000]"),
        ("sweep.poisson_m.points", 10**7, "sweep", "at most 10000000 points"),
        ("sweep.poisson_m.spacing", "log", "sweep.poisson_m", "above 0"),
        ("sweep.poisson_m.spacing", "even", "sweep.poisson_m.spacing", "'lin' or 'log'"),
        ("sweep.poisson_m.stop", 0, "sweep.poisson_m", "differs from start"),
        ("sweep.poisson_m.stop", 1e-300, "sweep.poisson_m", None),
        ("sweep.poisson_m.stop", 0.6, "sweep.poisson_m", "(-1, 0.5]"),
        ("sweep.poisson_m.step", 0.1, "sweep.poisson_m.step", "did you mean stop?"),
        ("sweep.temperature", [1], "sweep.temperature", "one of the keys"),
        ("sweep.young_m", [1e6], "sweep.modulus_ratio", "both set young_m"),
        ("sweep.modulus_ratio", [1, 0], "sweep.modulus_ratio", "(0, inf) Pa"),
        ("sweep.modulus_ratio", [1, -2], "sweep.modulus_ratio", "gives young_m = -1.5e+10"),
        ("sweep.gap_ratio", [0.1, -1], "sweep.gap_ratio", "gives gap = -0.0075"),
        ("sweep.radius_ratio", [0], "sweep.radius_ratio", "puts radius_j in"),
        ("sweep.cylinder_radius", ["1 mm"], "sweep.cylinder_radius", "at least 0.0075 m"),
        ("models", "fsi", "models", "a list"),
        ("models", [], "models", "leave the key out"),
        ("models", ["fsi", "fsi"], "models", "'fsi' is repeated"),
        ("models", ["fsi", "fem"], "models.1", "one of fsi, general, generatrix, slices"),
        ("models", ["fsi", "fe"], "models.1", "key `reference`"),
        ("models", ["fsi", ["slices"]], "models.1", "one of fsi"),
        ("models", ["generatrix"], "contributions", "fsi among the models"),
        ("reference", None, "reference", "leave the key out"),
        ("reference", True, "reference", "a mapping"),
        ("reference.bc", "free", "reference.bc.0", "one of roller, clamped, confined"),
        ("reference.bc", [], "reference.bc", "at least one"),
        ("reference.bc", ["roller", "roller"], "reference.bc", "repeated"),
        ("reference.tolerance", 0, "reference.tolerance", "[1e-12, 0.1]"),
        ("reference.tolerance", "1e-6 m", "reference.tolerance", "[1e-12, 0.1]"),
        ("load", "shaer", "load", "normal"),
        ("contributions", "yes", "contributions", "true or false"),
        ("contributions", 1, "contributions", "true or false"),
        ("convergence", {}, "convergence", "orders or sizes"),
        ("convergence.cases", {}, "convergence.cases", "at least one case"),
        ("convergence.cases", {"Base": {}}, "convergence.cases.Base", "small letters"),
        ("convergence.cases.base", None, "convergence.cases.base", "leave the key out"),
        ("convergence.cases.base", {"gap": -1}, "convergence.cases.base.gap", "(0, inf) m"),
        ("convergence.cases.base", {"bc": "x"}, "convergence.cases.base.bc", "roller"),
        ("convergence.cases.base", {"gup": 1}, "convergence.cases.base.gup", "mean gap?"),
        ("convergence.orders", [2, 2], "convergence.orders", "increasing"),
        ("convergence.orders", [4, 2], "convergence.orders", "increasing"),
        ("convergence.orders", [0], "convergence.orders.0", "[1, 20]"),
        ("convergence.orders", 4, "convergence.orders", "a list"),
        ("convergence.sizes", [0.5, 1], "convergence.sizes", "decreasing"),
        ("convergence.sizes", [1e-5], "convergence.sizes.0", "[0.02, 4]"),
        ("convergence.repeats", 0, "convergence.repeats", "[1, 1000]"),
        ("convergence.bc", ["roller"], "convergence.bc", "one of roller"),
        ("name", "other", "name", "one of the keys"),
        ("refrence", {}, "refrence", "did you mean reference?"),
    ],
)
def test_one_slip_is_one_violation(path, value, field, allowed):
    if allowed is None:
        assert parse_scene(spoiled(path, value)).points == 6
        return
    found = violations(spoiled(path, value))
    assert list(found) == [field]
    assert allowed in found[field].allowed


def test_all_slips_at_once():
    scene = {
        "cell": {**CELL, "gap": "0 mm", "young_m": -1, "poisson_i": "soft", "radius": 1},
        "sweep": {"poisson_m": [0.7], "gap_ratio": {"start": 1}, "radius_j": "1 mm"},
        "models": ["fsi", "nonsense"],
        "reference": {"bc": "loose", "tolerance": 5},
        "convergence": {"orders": [3, 2], "cases": {"a": {"gap": -2}, "b": {"bc": 1}}},
        "contributions": "maybe",
        "load": "twist",
        "typo": 1,
    }
    assert set(violations(scene, name="Bad Name")) == {
        "name",
        "title",
        "cell.gap",
        "cell.young_m",
        "cell.poisson_i",
        "cell.radius",
        "sweep.poisson_m",
        "sweep.gap_ratio.stop",
        "sweep.gap_ratio.points",
        "sweep.radius_j",
        "models.1",
        "reference.bc.0",
        "reference.tolerance",
        "convergence.orders",
        "convergence.cases.a.gap",
        "convergence.cases.b.bc",
        "contributions",
        "load",
        "typo",
    }


def test_value_is_shown_as_it_was_written():
    assert violations(spoiled("cell.gap", "0 mm"))["cell.gap"].value == "0 mm"
    assert "xxx...: allowed" in str(violations(spoiled("cell.gap", "x" * 500))["cell.gap"])


def test_wrong_base_is_not_blamed_on_the_ratio():
    scene = spoiled("sweep", {"gap_ratio": [0.1], "modulus_ratio": [10]})
    scene["cell"] = {**CELL, "radius_i": -1, "young_i": 0}
    assert set(violations(scene)) == {"cell.radius_i", "cell.young_i"}


def test_finite_modulus_is_needed_by_its_ratio():
    found = violations(spoiled("cell.young_i", "rigid"))
    assert "gives young_m = inf" in found["sweep.modulus_ratio"].allowed


def test_missing_inputs_are_named_one_by_one():
    found = violations({"title": "t", "models": ["fsi"], "sweep": {"gap_ratio": [0.1]}})
    assert set(found) == {
        f"cell.{name}" for name in ("radius_i", "young_i", "young_m", "poisson_i", "poisson_m")
    }
    found = violations({"title": "t", "convergence": {"orders": [2]}})
    assert len(found) == 6
    assert "convergence.cases.base" in found["cell.gap"].allowed


def test_scene_must_ask_for_something():
    assert "something to compute" in violations({"title": "t", "cell": CELL})["models"].allowed
    found = violations({"title": "t", "cell": CELL, "sweep": {"gap": [1e-3]}})
    assert "for the sweep" in found["models"].allowed


def test_every_pair_of_contradictory_axes():
    axes = ("gap", "gap_ratio", "young_m", "modulus_ratio", "radius_j", "radius_ratio")
    found = violations(spoiled("sweep", {name: [0.5] for name in axes}))
    assert set(found) == {"sweep.gap_ratio", "sweep.modulus_ratio", "sweep.radius_ratio"}


@pytest.mark.parametrize("name", ["", "Figure4", "4gap", "a-b", "a b", "../x", "study", "a" * 41])
def test_names_of_scenes(name):
    assert "name" in violations(SCENE, name=name)


def aliases(levels):
    """A few lines that stand for nine to the power of `levels` values."""
    lines = ["a0: &a0 [1, 1]"]
    lines += [f"a{i}: &a{i} [{', '.join([f'*a{i - 1}'] * 9)}]" for i in range(1, levels)]
    return "\n".join(lines).encode()


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"", "empty"),
        (b"# nothing but a comment\n", "empty"),
        (b"~", "empty"),
        (b"just a text", "one value"),
        (b"- a\n- list", "one list"),
        (b"title: x\ncell: {gap: 0.5 mm, rad", "is the file complete?"),
        (b"title: 'unfinished\n", "is the file complete?"),
        (b"title: x\n  cell: y\n", "line 2"),
        (b"cell: {radius_i: 7,5 mm}", "decimals with a point.*line 1"),
        (b"cell: {gap: 0,5 mm, radius_i: 7,5 mm}", "decimals with a point"),
        (b"cell: {poisson_m: 0,46}", "decimals with a point"),
        (b"\ttitle: x", "line 1"),
        (b"title: x\n---\ntitle: y\n", "another document"),
        (b"title: *missing", "undefined alias"),
        (b"title: !!python/object/apply:os.system [ls]", "no tag"),
        (b"title: !!binary aGVsbG8=", "no tag"),
        (b"title: !!int abc", "does not fit"),
        (b"title: !!bool abc", "does not fit"),
        (b"\x89PNG\r\n\x1a\n\x00\x00", "not text"),
        ("title: \u00e9".encode("latin-1"), "not text"),
        (b"\xff\xfet\x00i", "not text"),
        (b"title: a\x00b", "not text"),
        (b"title: " + b"[" * 1000, "nested too deeply"),
        (b"title: " + b"{a: " * 300 + b"}" * 300, "nested too deeply"),
        (aliases(12), f"at most {MOST_NODES} values"),
        (b"title: &a [*a]", f"at most {MOST_NODES} values"),
        (b"x" * 256_001, "too large"),
        (b"title: a\ntitle: b\ncell: {gap: 1, gap: 2}\n1: c\n", "3 violations"),
        (b"? [1, 2]\n: x", "a key that is a word"),
        (b"<<: {title: x}", "<<"),
    ],
)
def test_unreadable_files(tmp_path, content, message):
    path = tmp_path / "scene.yaml"
    path.write_bytes(content)
    with pytest.raises(SceneError, match=message) as caught:
        load_scene(path)
    assert str(path) in str(caught.value)
    assert len(str(caught.value)) < 2000
    assert validate_file(path).violations == caught.value.violations


def test_files_that_cannot_be_opened(tmp_path):
    with pytest.raises(SceneError, match="absent"):
        load_scene(tmp_path / "none.yaml")
    with pytest.raises(SceneError, match="readable file"):
        load_scene(tmp_path)  # a folder


def test_plain_scalars_are_those_of_yaml_1_2(tmp_path):
    path = tmp_path / "a.yaml"
    path.write_text(
        "a: 1e-3\nb: 010\nc: 1:30\nd: yes\ne: 2024-01-01\nf: .inf\ng: 1_0\nh: true\ni:\n"
    )
    assert load_mapping(path) == {
        "a": 1e-3,
        "b": 10,
        "c": "1:30",
        "d": "yes",
        "e": "2024-01-01",
        "f": float("inf"),
        "g": "1_0",
        "h": True,
        "i": None,
    }


def test_truncated_file_is_an_error_or_a_scene_that_says_less(tmp_path):
    whole = (Path(__file__).parents[2] / "params" / "smoke.yaml").read_bytes()
    path = tmp_path / "smoke.yaml"
    for length in range(0, len(whole), 7):
        path.write_bytes(whole[:length])
        with contextlib.suppress(SceneError), warnings.catch_warnings():
            warnings.simplefilter("ignore")
            load_scene(path)


@pytest.mark.parametrize(
    ("text", "field"),
    [
        ("scenes: []", "scenes"),
        ("scenes: smoke", "scenes"),
        ("scenes:", "scenes"),
        ("scenes: [there, there]", "scenes"),
        ("scenes: [there, absent]", "scenes.1"),
        ("scenes: [../there]", "scenes.0"),
        ("scenes: [1]", "scenes.0"),
        ("scenes: [there]\nscene: x", "scene"),
        ("scene: [there]", "scene"),
        ("scenes: [there", "file"),
    ],
)
def test_bad_lists_of_scenes(tmp_path, text, field):
    (tmp_path / "there.yaml").write_text("title: x")
    path = tmp_path / "study.yaml"
    path.write_text(text)
    with pytest.raises(SceneError) as caught:
        load_study_list(path)
    assert field in {violation.field for violation in caught.value.violations}


SPECIMEN = {"title": "A specimen", "specimen": {"lattices": ["lattice_fsi"]}}
SERIES = {"weights": [0.6, 0.395], "times": [1, 100]}


def test_specimen_is_a_scene_of_its_own():
    wrong = violations(SPECIMEN | {"models": ["fsi"], "cell": {"gap": 1e-3, "poisson_m": 0.3}})
    assert set(wrong) == {"models", "cell.gap"}
    assert parse_scene(SPECIMEN | {"cell": {"poisson_m": 0.5}}).specimen.parts == ("lattices",)


def test_specimen_block_lists_all_that_is_wrong():
    block = {
        "walls": ["glass"],
        "elastic": {"free": [0.5, 1]},
        "rigid": {},
        "relaxation": {
            "series": SERIES,
            "times": {"start": 1, "stop": 2},
            "methods": ["lattice_full"],
        },
        "finite_strain": {"steps": 0},
    }
    wrong = violations(SPECIMEN | {"specimen": block})
    assert set(wrong) == {
        "specimen.walls.0",
        "specimen.elastic.free",
        "specimen.rigid",
        "specimen.relaxation.methods.0",
        "specimen.finite_strain.steps",
    }


def test_specimen_says_what_its_solid_cannot_bear():
    block = {
        "lattices": ["lattice_fsi"],
        "elastic": {"free": [1]},
        "relaxation": {"series": SERIES, "times": {"start": 1, "stop": 2}},
    }
    cell = {"young_i": "rigid", "poisson_m": 0.495}
    wrong = violations({"title": "A specimen", "specimen": block, "cell": cell})
    assert set(wrong) == {"cell.young_i", "cell.poisson_m", "specimen.relaxation.series"}
