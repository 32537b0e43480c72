"""Two studies in one: longer grids, samples, and what is refused."""

import json

import numpy as np
import pytest

from bondcell.cli import main
from bondcell.errors import InputError
from bondcell.evaluate import evaluate
from bondcell.jobs.collect import collect, collect_other_loads
from bondcell.jobs.merge_studies import merge_studies
from bondcell.results.load_groups import read_loads
from bondcell.results.view import parameters
from bondcell.scenes.parsing import parse_scene
from bondcell.scenes.study import build_study
from bondcell.storage import read_dataset, write_dataset

CELL = {"radius_i": "7.5 mm", "young_i": "30 GPa", "poisson_i": 0.25, "poisson_m": 0.3}
SCENE = {
    "title": "One",
    "cell": CELL,
    "sweep": {"gap": ["0.5 mm", "2 mm"], "modulus_ratio": [10, 1e4]},
    "models": ["generatrix", "slices"],
    "load": ["normal", "torsion"],
}
POISSON = {"start": 0, "stop": 0.4}


@pytest.fixture
def study(tmp_path):
    """Write the study of a scene with other parts; its path."""

    def written(name, **changes):
        kept = {key: value for key, value in {**SCENE, **changes}.items() if value is not None}
        scene = parse_scene(kept, name=name)
        points = scene, build_study(scene), [], []
        path = tmp_path / f"{name}.nc"
        return write_dataset(collect(*points), path, collect_other_loads(*points))

    return written


def merged(*paths):
    return merge_studies(*(read_loads(path) for path in paths))


def check(result):
    """Every value is that of its own inputs."""
    for load, data in result.items():
        outputs = [name for name in data.data_vars if "model" in data[name].dims]
        inputs = data.drop_vars([*outputs, "model"])
        for name in ("generatrix",):
            expected = evaluate(inputs, name, load)["stiffness"]
            found = data["stiffness"].sel(model=name)
            np.testing.assert_allclose(found, expected.transpose(*found.dims), rtol=1e-12)


def test_grids_that_differ_along_an_axis_make_a_longer_grid(study):
    more = study("more", sweep={"gap": ["1 mm", "2 mm"], "modulus_ratio": [10, 1e4]}, title="Two")
    result = merged(study("one"), more)
    normal = result["normal"]
    assert normal["stiffness"].dims == ("model", "gap", "modulus_ratio")
    assert normal["gap"].values.tolist() == [5e-4, 1e-3, 2e-3]
    assert normal.attrs["title"] == "One | Two"
    assert [data["stiffness"].attrs["units"] for data in result.values()] == ["N m-1", "N m rad-1"]
    check(result)


def test_other_studies_stand_on_samples(study):
    design = {"kind": "latin_hypercube", "points": 3, "ranges": {"poisson_m": POISSON}}
    cell = {**CELL, "gap": "1 mm", "young_m": "1 MPa"}
    result = merged(study("one"), study("other", cell=cell, sweep=None, design=design))
    normal = result["normal"]
    assert normal["stiffness"].dims == ("model", "sample")
    assert normal.sizes["sample"] == 7
    assert set(parameters(normal)) == {"gap", "young_m", "poisson_m"}
    assert normal["radius_i"].dims == ()
    check(result)


def test_constants_that_differ_become_parameters(study):
    result = merged(study("one"), study("other", cell={**CELL, "poisson_i": 0.1}))
    assert "poisson_i" in parameters(result["normal"])
    assert result["normal"].sizes["sample"] == 8
    check(result)


def test_points_of_both_come_once(study):
    one = study("one")
    again = study("again", sweep={"gap": ["2 mm", "3 mm"], "modulus_ratio": [10, 7]})
    assert merged(one, again)["normal"].sizes["sample"] == 4 + 3
    same = merged(one, one)["normal"]
    assert same.sizes["sample"] == 4


def test_values_that_differ_are_refused(study):
    loads = read_loads(study("one"))
    other = {load: data.assign(stiffness=data["stiffness"] * 1.001) for load, data in loads.items()}
    with pytest.raises(InputError, match="4 of 4 points of both studies"):
        merge_studies(loads, other)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"models": ["generatrix"]}, "model, normal"),
        ({"models": ["generatrix", "parallel_bond"]}, "rows, normal"),
        ({"load": "normal"}, "loads = 'normal'"),
    ],
)
def test_other_models_and_loads_are_refused(study, changes, words):
    with pytest.raises(InputError, match=words):
        merged(study("one"), study("other", **changes))


def test_other_schemes_and_files_are_refused(study):
    loads = read_loads(study("one"))
    newer = {load: data.assign_attrs(hash_scheme=2) for load, data in loads.items()}
    with pytest.raises(InputError, match="hash_scheme = 2: allowed is 1 in both"):
        merge_studies(loads, newer)
    plain = {load: data.drop_attrs() for load, data in loads.items()}
    with pytest.raises(InputError, match="second study, normal"):
        merge_studies(loads, plain)


def test_command_writes_a_study(study, tmp_path, capsys):
    more = study("more", sweep={"gap": ["1 mm"], "modulus_ratio": [10, 1e4]})
    out = tmp_path / "both.nc"
    assert main(["merge", str(study("one")), str(more), "-o", str(out)]) == 0
    assert "3 gap" in capsys.readouterr().out
    both = read_dataset(out)
    assert both["stiffness"].shape == (2, 3, 2)
    assert both.attrs["hash_scheme"] == 1
    assert len(json.loads(both.attrs["rows"])) == 2
    assert main(["show", str(out)]) == 0
    assert main(["merge", str(out), str(more), "-o", str(tmp_path / "no/c.nc")]) == 2
    assert main(["merge", str(out), str(tmp_path / "none.nc"), "-o", str(tmp_path / "c.nc")]) == 2
    assert "none.nc" in capsys.readouterr().err
    before = out.read_bytes()
    assert main(["merge", str(more), str(out), "-o", str(tmp_path / "." / out.name)]) == 2
    assert "another file than those that are read" in capsys.readouterr().err
    assert out.read_bytes() == before
