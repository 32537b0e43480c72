"""Good scenes: what is read, what is derived from it, and what its digests depend on."""

import json
import math
import pickle
import subprocess
import sys
from pathlib import Path

import jsonschema
import numpy as np
import pytest

from bondcell.cell import UNITS, Cell
from bondcell.errors import InputError
from bondcell.jobs.point_hash import point_hashes
from bondcell.jobs.rows import wanted_rows
from bondcell.scenes.parsing import load_scene, parse_scene
from bondcell.scenes.points import scene_cell
from bondcell.scenes.quantities import UnitsWarning
from bondcell.scenes.ranges import Range
from bondcell.scenes.scene import Scene
from bondcell.scenes.schema import scene_json_schema, schema_texts, write_schemas
from bondcell.scenes.study_list import load_study_list, study_list_json_schema
from bondcell.scenes.validate import validate_file
from bondcell.scenes.yaml_loading import load_mapping

PARAMS = Path(__file__).parents[2] / "params"
SCENES = load_study_list(PARAMS / "study.yaml")

CELL = {
    "radius_i": "7.5 mm",
    "gap": "0.5 mm",
    "young_i": "30 GPa",
    "poisson_i": 0.25,
    "young_m": "1.4 MPa",
    "poisson_m": 0.46,
}
SI = {
    "radius_i": 7.5e-3,
    "gap": 5e-4,
    "young_i": 3e10,
    "poisson_i": 0.25,
    "young_m": 1.4e6,
    "poisson_m": 0.46,
}
SCENE = {
    "title": "A scene",
    "question": "Why?",
    "cell": CELL,
    "sweep": {"modulus_ratio": [1, 10, 100], "poisson_m": [0, 0.46]},
    "models": ["fsi", "generatrix"],
    "reference": {"bc": ["roller", "confined"]},
    "contributions": True,
    "convergence": {"orders": [2, 4], "sizes": [1, 0.5]},
}


def changed(**changes):
    """The scene with some keys replaced; None removes one."""
    return parse_scene({k: v for k, v in {**SCENE, **changes}.items() if v is not None})


def test_units_and_bare_numbers_are_the_same_scene():
    assert parse_scene({**SCENE, "cell": SI}).cell == parse_scene(SCENE).cell
    assert parse_scene({**SCENE, "cell": SI}).digest == parse_scene(SCENE).digest


def test_scene_is_immutable():
    scene = parse_scene(SCENE)
    with pytest.raises(ValueError, match="frozen"):
        scene.title = "another"
    with pytest.raises(ValueError, match="frozen"):
        scene.cell.gap = 1.0


def test_defaults():
    scene = parse_scene({"title": "t", "cell": CELL, "models": ["fsi"], "reference": {}})
    assert scene.load == "normal"
    assert scene.reference.bc == ("roller",)
    assert scene.reference.tolerance == 1e-6
    assert (scene.question, scene.sweep, scene.convergence) == (None, None, None)
    assert not scene.contributions
    assert (scene.points, scene.axes, scene.axis_names) == (1, {}, ())


def test_what_a_scene_needs():
    points = parse_scene({"title": "t", "cell": CELL, "models": ["fsi"]})
    assert points.has_points
    assert not points.uses_finite_elements
    assert not points.uses_triangles
    assert points.fe_names == {}
    assert points.cases() == {}
    ladder = parse_scene({"title": "t", "cell": CELL, "convergence": {"orders": [2, 4]}})
    assert not ladder.has_points
    assert ladder.uses_finite_elements
    assert not ladder.uses_triangles
    full = parse_scene(SCENE)
    assert full.uses_triangles
    assert full.fe_names == {"fe": "roller", "fe_confined": "confined"}


def test_one_boundary_condition_needs_no_list():
    assert changed(reference={"bc": "clamped"}).reference.bc == ("clamped",)


def test_axes_keep_the_order_of_the_file():
    sweep = {"poisson_m": [0.4, 0.1], "gap": ["1 mm", 5e-4], "modulus_ratio": [1]}
    scene = changed(sweep=sweep)
    assert scene.axis_names == tuple(sweep)
    assert scene.points == 4
    np.testing.assert_array_equal(scene.axes["gap"], [1e-3, 5e-4])


@pytest.mark.parametrize(
    ("axis", "values"),
    [
        ({"start": 0, "stop": 0.5, "points": 6}, [0, 0.1, 0.2, 0.3, 0.4, 0.5]),
        ({"start": 0.5, "stop": 0, "points": 3, "spacing": "lin"}, [0.5, 0.25, 0]),
        (
            {"start": 1e-3, "stop": 1e-1, "points": 5.0, "spacing": "log"},
            [1e-3, 10**-2.5, 1e-2, 10**-1.5, 1e-1],
        ),
    ],
)
def test_ranges(axis, values):
    found = changed(sweep={"poisson_m": axis}).axes["poisson_m"]
    np.testing.assert_allclose(found, values, rtol=1e-14)
    assert found[0] == values[0]
    assert found[-1] == values[-1]


def test_decades_of_a_range_are_exact():
    axis = {"start": 1, "stop": 1e6, "points": 25, "spacing": "log"}
    values = changed(sweep={"modulus_ratio": axis}).axes["modulus_ratio"]
    assert set(10.0 ** np.arange(7)) <= set(values)


def test_range_with_units():
    axis = {"start": "1 um", "stop": "1 mm", "points": 4, "spacing": "log"}
    assert changed(sweep={"gap": axis}).axes["gap"].tolist() == [1e-6, 1e-5, 1e-4, 1e-3]


def test_range_keeps_its_ends_to_the_last_bit():
    start, stop = 0.12345678901234568, 0.43210987654321099
    values = Range(start=start, stop=stop, points=5).values()
    assert (values[0], values[-1]) == (start, stop)


def test_rigid_particles():
    scene = changed(cell={**CELL, "young_i": "rigid"}, sweep={"young_j": ["30 GPa", "rigid"]})
    assert scene.cell.young_i == math.inf
    assert scene.axes["young_j"].tolist() == [3e10, math.inf]


def test_swept_input_need_not_be_in_the_cell():
    cell = {k: v for k, v in CELL.items() if k not in ("gap", "young_m", "poisson_m")}
    sweep = {"gap_ratio": [0.1], "modulus_ratio": [10], "poisson_m": [0.3]}
    assert parse_scene({"title": "t", "cell": cell, "sweep": sweep, "models": ["fsi"]}).points == 1


def test_cases_override_the_cell():
    cases = {"base": {}, "other": {"gap": "1 mm", "radius_j": "2 mm", "bc": "confined"}}
    block = {"orders": [2], "cases": cases, "bc": "clamped"}
    found = changed(convergence=block).cases()
    assert list(found) == ["base", "other"]
    assert found["base"].bc == "clamped"
    assert found["base"].cell == Cell.from_values(**SI)
    assert found["other"].bc == "confined"
    assert found["other"].cell == Cell.from_values(**{**SI, "gap": 1e-3, "radius_j": 2e-3})


def test_case_may_complete_the_cell():
    cell = {k: v for k, v in CELL.items() if k != "gap"}
    block = {"orders": [2], "cases": {"a": {"gap": 1e-3}, "b": {"gap": 2e-3}}}
    scene = parse_scene({"title": "t", "cell": cell, "convergence": block})
    assert [case.cell.gap for case in scene.cases().values()] == [1e-3, 2e-3]


def test_parameters_as_given():
    assert json.loads(parse_scene(SCENE).given_json) == SCENE


def test_scene_survives_pickling():
    scene = parse_scene(SCENE, name="a_name")
    copy = pickle.loads(pickle.dumps(scene))
    assert copy == scene
    assert (copy.name, copy.digest, copy.axis_names) == ("a_name", scene.digest, scene.axis_names)


def identities(scene):
    """What each part of the work is known by."""
    rows = wanted_rows(scene)
    return {
        "points": point_hashes(scene_cell(scene)).tolist(),
        "models": [row for row in rows if row.kind == "analytic"],
        "reference": [row for row in rows if row.kind == "fe"],
        "convergence": scene.convergence_digest,
    }


@pytest.mark.parametrize(
    ("changes", "affected"),
    [
        ({"title": "Another"}, ""),
        ({"question": None}, ""),
        ({"cell": SI}, ""),
        ({"cell": {**CELL, "young_m": 2e6}}, "convergence"),  # the sweep sets its own
        ({"cell": {**CELL, "radius_j": "7.5 mm"}}, ""),  # its default
        ({"cell": {**CELL, "gap": "1 mm"}}, "points convergence"),
        (
            {"sweep": {"poisson_m": [0, 0.46], "modulus_ratio": [1, 10, 100]}},
            "points",
        ),
        (
            {
                "sweep": {
                    "modulus_ratio": {"start": 1, "stop": 100, "points": 3, "spacing": "log"},
                    "poisson_m": [0, 0.46],
                }
            },
            "",
        ),
        ({"models": ["fsi"]}, "models convergence"),
        ({"contributions": False}, "models"),
        ({"reference": {"bc": ["roller"]}}, "reference"),
        ({"reference": None}, "reference"),
        ({"convergence": {"orders": [2, 6], "sizes": [1, 0.5]}}, "convergence"),
        ({"convergence": None}, "convergence"),
    ],
)
def test_identities_change_with_what_the_numbers_depend_on(changes, affected):
    before, after = identities(parse_scene(SCENE)), identities(changed(**changes))
    assert [name for name in before if before[name] != after[name]] == affected.split()


def test_digest_changes_with_everything_said():
    scene = parse_scene(SCENE)
    for changes in ({"title": "Another"}, {"question": None}, {"models": ["fsi"]}):
        assert changed(**changes).digest != scene.digest
    turned = {"poisson_m": [0, 0.46], "modulus_ratio": [1, 10, 100]}
    assert changed(sweep=turned).digest != scene.digest


def test_values_far_beyond_the_usual_warn(tmp_path):
    path = tmp_path / "metres.yaml"
    cell = {**CELL, "radius_i": 7.5, "young_m": 1.4}
    path.write_text(json.dumps({"title": "t", "cell": cell, "models": ["fsi"]}))
    with pytest.warns(UnitsWarning) as caught:
        load_scene(path)
    assert ["radius_i = 7.5 m" in str(w.message) for w in caught] == [True, False]
    assert "young_m = 1.4 Pa" in str(caught[1].message)
    violations, warnings = validate_file(path)
    assert violations == ()
    assert len(warnings) == 2


def test_one_metre_does_not_warn(tmp_path):
    path = tmp_path / "metre.yaml"
    path.write_text(json.dumps({"title": "t", "cell": {**CELL, "radius_i": 1}, "models": ["fsi"]}))
    assert load_scene(path).name == "metre"
    assert validate_file(path) == ((), ())


def test_planning_a_scene_imports_neither_meshes_nor_datasets():
    code = (
        "import sys; from bondcell.scenes.parsing import load_scene;"
        "from bondcell.jobs.batch_plan import plan;"
        "[plan(load_scene(path)) for path in sys.argv[1:]];"
        "print(*sorted({m.split('.')[0] for m in sys.modules}))"
    )
    files = [str(PARAMS / f"{name}.yaml") for name in ("figure4", "gap_modulus")]
    done = subprocess.run(
        [sys.executable, "-c", code, *files], capture_output=True, text=True, check=True
    )
    heavy = {"skfem", "gmsh", "xarray", "pandas", "matplotlib", "snakemake"}
    assert not heavy & set(done.stdout.split())


@pytest.mark.parametrize("name", SCENES)
def test_shipped_scene_is_good(name):
    path = PARAMS / f"{name}.yaml"
    assert validate_file(path) == ((), ())
    assert load_scene(path).name == name
    assert path.read_text().startswith("# yaml-language-server: $schema=scene.schema.json\n")


def test_shipped_scenes_ask_what_they_are_for():
    figure4 = load_scene(PARAMS / "figure4.yaml")
    assert figure4.contributions
    assert figure4.axes["poisson_m"].tolist() == [0, 0.46]
    assert figure4.axes["modulus_ratio"][[0, -1]].tolist() == [1, 1e6]
    assert load_scene(PARAMS / "gap_modulus.yaml").points == 13 * 13 * 3
    convergence = load_scene(PARAMS / "convergence.yaml")
    assert convergence.cases()["base"].cell == Cell.from_values(**SI)
    assert {case.load for case in convergence.cases().values()} == {
        "normal",
        "shear",
        "torsion",
        "bending",
    }
    assert load_scene(PARAMS / "smoke.yaml").points == 4
    atlas = load_scene(PARAMS / "atlas.yaml")
    assert atlas.atlas
    assert atlas.axes["gap_ratio"][[0, -1]].tolist() == [1e-4, 3]
    assert atlas.axes["modulus_ratio"][[0, -1]].tolist() == [1, np.inf]
    assert atlas.loads == ("normal", "shear", "torsion", "bending")


def test_study_list():
    assert SCENES == (
        "figure4",
        "gap_modulus",
        "atlas_coarse",
        "convergence",
        "specimen",
        "extreme",
        "extreme_loads",
        "prony",
        "prony_extreme",
        "smoke",
    )


def test_schemas_are_current(tmp_path):
    for name, text in schema_texts().items():
        stored = (PARAMS / name).read_text(encoding="utf-8")
        assert stored == text, "run: python -m bondcell.scenes.schema"
    assert len(write_schemas(tmp_path)) == 3
    assert write_schemas(tmp_path) == []


@pytest.mark.parametrize("name", SCENES)
def test_schema_accepts_the_shipped_scenes(name):
    jsonschema.validate(load_mapping(PARAMS / f"{name}.yaml"), scene_json_schema())
    jsonschema.validate(load_mapping(PARAMS / "study.yaml"), study_list_json_schema())


@pytest.mark.parametrize(
    "changes",
    [
        {"titel": "x"},
        {"cell": {**CELL, "gap": 0}},
        {"cell": {**CELL, "gap": "1 mm + 1 mm"}},
        {"cell": {**CELL, "poisson_m": 0.6}},
        {"sweep": {"modulus_ratio": []}},
        {"sweep": {"modulus_ratio": [1, 1]}},
        {"sweep": {"gap": {"start": 1, "stop": 2}}},
        {"sweep": {"poisson_m": {"start": 0, "stop": 0.4, "points": 0}}},
        {"models": ["fe"]},
        {"models": None},
        {"reference": {"bc": "free"}},
        {"contributions": "yes"},
        {"convergence": {"cases": {"Base": {}}, "orders": [2]}},
    ],
)
def test_schema_refuses_what_the_loader_refuses(changes):
    with pytest.raises(jsonschema.ValidationError):
        jsonschema.validate({**SCENE, **changes}, scene_json_schema())
    with pytest.raises(InputError):
        parse_scene({**SCENE, **changes})


def test_schema_describes_every_key():
    schema = scene_json_schema()
    blocks = [schema, *schema["$defs"].values()]
    for block in blocks:
        for key, value in block["properties"].items():
            assert value.get("description"), key
    inputs = schema["$defs"]["CellInputs"]["properties"]
    for name, unit in UNITS.items():
        assert f"[{unit}]" in inputs[name]["description"]


@pytest.mark.parametrize("name", UNITS)
def test_schema_has_the_bounds_of_the_cell(name):
    bounds = scene_json_schema()["$defs"]["CellInputs"]["properties"][name]["anyOf"][0]
    low = bounds["exclusiveMinimum"]
    with pytest.raises(InputError):
        Cell.from_values(**{**SI, name: low})
    if "maximum" in bounds:
        Cell.from_values(**{**SI, name: bounds["maximum"]})
        with pytest.raises(InputError):
            Cell.from_values(**{**SI, name: bounds["maximum"] + 1e-9})


def test_scene_keys_are_the_documented_ones():
    assert tuple(Scene.model_fields) == (
        "title",
        "question",
        "cell",
        "sweep",
        "design",
        "models",
        "reference",
        "loads",
        "contributions",
        "stability",
        "atlas",
        "convergence",
        "prony",
        "specimen",
    )
