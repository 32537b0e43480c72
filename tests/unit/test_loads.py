"""Scenes with several loads, and rigid particles on the axis of the modulus ratio."""

import numpy as np
import pytest
import xarray as xr

from bondcell.errors import SceneError
from bondcell.evaluate import evaluate
from bondcell.jobs.batch import Batch
from bondcell.jobs.batch_files import write_batch
from bondcell.jobs.batch_plan import plan
from bondcell.jobs.collect import collect, collect_other_loads
from bondcell.jobs.reference_batch import compute_reference
from bondcell.jobs.rows import Row
from bondcell.results.accuracy import accuracy_table
from bondcell.results.view import load_name, model_names, stiffness_unit
from bondcell.scenes.parsing import parse_scene
from bondcell.scenes.schema import scene_json_schema
from bondcell.scenes.study import build_study
from bondcell.status import Status
from bondcell.storage import read_dataset, write_dataset

SCENE = {
    "title": "Two loads",
    "cell": {
        "radius_i": "7.5 mm",
        "young_i": "30 GPa",
        "poisson_i": 0.25,
        "young_m": "1 MPa",
        "poisson_m": 0.3,
    },
    "sweep": {"gap": ["0.5 mm", "2 mm"], "modulus_ratio": [10, "rigid"]},
    "models": ["fsi", "slices"],
    "reference": {"bc": ["roller", "confined"], "tolerance": 1e-2},
    "load": ["normal", "torsion"],
}


@pytest.fixture(scope="module")
def scene():
    return parse_scene(SCENE, name="loads")


@pytest.fixture(scope="module")
def study(scene):
    return build_study(scene)


@pytest.fixture(scope="module")
def path(scene, study, tmp_path_factory):
    """The scene's file, made from its batches as the workflow does it."""
    folder = tmp_path_factory.mktemp("loads")
    files = []
    for batch in plan(scene).new:
        files.append(folder / f"{batch.name}.nc")
        write_batch(compute_reference(batch), files[-1], batch.name)
    groups = collect_other_loads(scene, study, [], files)
    return write_dataset(collect(scene, study, [], files), folder / "study.nc", groups)


def test_batches_of_every_load(scene):
    models = [batch.models for batch in plan(scene).new]
    assert models == [("fe_roller",), ("fe_confined",), ("fe_torsion",)]


def test_first_load_in_the_root_others_in_groups(path):
    root, torsion = read_dataset(path), read_dataset(path, "torsion")
    assert [stiffness_unit(found) for found in (root, torsion)] == ["N m-1", "N m rad-1"]
    assert [load_name(found) for found in (root, torsion)] == ["normal", "torsion"]
    assert (root.attrs["load"], torsion.attrs["load"]) == ("normal", "torsion")
    assert torsion.gap.values.tolist() == root.gap.values.tolist()
    assert model_names(root) == ["fsi", "slices", "fe", "fe_confined"]
    assert model_names(torsion) == ["fe"]
    absent = torsion.sel(model=["fsi", "slices", "fe_confined"])
    assert (absent.status == Status.not_computed).all()
    assert absent.stiffness.isnull().all()
    assert (torsion.status.sel(model="fe") == Status.ok).all()
    for name in ("order", "way", "reduction_error"):
        assert name in root
        assert "long_name" in torsion[name].attrs
    ways = root.way.attrs["flag_meanings"].split()
    assert ways[int(root.way.sel(model="fsi")[0, 0])] == "closed_form"


def test_file_opens_as_a_tree(path):
    with xr.open_datatree(path) as tree:
        assert set(tree.children) == {"torsion"}
        assert tree["torsion"]["stiffness"].sizes == {"model": 4, "gap": 2, "modulus_ratio": 2}


def test_values_are_those_of_evaluate(study, path):
    direct = evaluate(study, "fe", load="torsion", tolerance=1e-2)
    stored = read_dataset(path, "torsion").sel(model="fe")
    np.testing.assert_allclose(stored.stiffness, direct.stiffness, rtol=1e-12)


def test_accuracy_only_of_models_that_have_the_load(path):
    assert set(accuracy_table(read_dataset(path)).model) == {"fsi", "slices"}
    assert accuracy_table(read_dataset(path, "torsion")).empty


def test_rigid_particles_on_the_axis(study, path):
    assert np.isinf(study.modulus_ratio.values).tolist() == [False, True]
    assert study.young_i.values.tolist() == [3e10, np.inf]
    assert study.young_j.values.tolist() == [3e10, np.inf]
    assert study.young_m.values.tolist() == [3e9, 1e6]
    stored = read_dataset(path)
    assert np.isinf(stored.modulus_ratio.values[1])
    assert np.isfinite(stored.stiffness.sel(model="fe")).all()


def without(*keys):
    return {key: value for key, value in SCENE.items() if key not in keys}


def test_single_load_given_as_text_or_list():
    bare = without("models", "reference") | {"reference": {}}
    text, listed = (parse_scene(bare | {"load": load}) for load in ("shear", ["shear"]))
    assert text.loads == listed.loads == ("shear",)
    assert text.load == "shear"
    assert text.digest == listed.digest


@pytest.mark.parametrize(
    ("changes", "field", "allowed"),
    [
        ({"load": []}, "load", "one of normal"),
        ({"load": ["normal", "normal"]}, "load", "each once"),
        ({"load": ["normal", "twist"]}, "load", "one of normal"),
        ({"load": "torsion", "reference": {}}, "models.0", "covers the load torsion"),
        ({"load": "torsion", "models": None}, "reference.bc", "only the load normal"),
        ({"reference": None, "stability": True, "load": "normal"}, "stability", "reference"),
        ({"reference": None, "load": ["normal", "shear"]}, "load", "of shear they know nothing"),
        (
            {"cell": {k: v for k, v in SCENE["cell"].items() if k != "young_m"}},
            "cell.young_m",
            "beside the modulus ratio rigid",
        ),
        (
            {"sweep": {"young_i": ["1 GPa"], "modulus_ratio": [10, "rigid"], "gap": ["1 mm"]}},
            "sweep.modulus_ratio",
            "can say rigid itself",
        ),
        (
            {
                "convergence": {
                    "cases": {"a": {"load": "shear", "bc": "clamped", "gap": 1e-3}},
                    "orders": [3],
                }
            },
            "convergence.cases.a.bc",
            "only the load normal",
        ),
    ],
)
def test_bad_loads_are_named(changes, field, allowed):
    scene = {key: value for key, value in (SCENE | changes).items() if value is not None}
    with pytest.raises(SceneError) as error:
        parse_scene(scene)
    found = {violation.field: violation.allowed for violation in error.value.violations}
    assert field in found
    assert allowed in found[field]


def test_schema_takes_one_load_or_a_list():
    import jsonschema

    schema = scene_json_schema()
    for load in ("shear", ["normal", "shear"]):
        jsonschema.validate(without("load") | {"load": load}, schema)
    with pytest.raises(jsonschema.ValidationError):
        jsonschema.validate(without("load") | {"load": ["twist"]}, schema)


def test_a_batch_of_nothing_known_is_refused(scene):
    points = plan(scene).new[0].points
    with pytest.raises(ValueError, match="boundary condition or load"):
        compute_reference(Batch((Row("fe", "normal", "fe"),), points))
