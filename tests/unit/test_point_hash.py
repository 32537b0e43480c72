"""Identity of points: what is the same, what is not, and where a point is found again."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bondcell.cell import UNITS, Cell
from bondcell.inputs import cell_from_study
from bondcell.jobs.batch import Batch
from bondcell.jobs.batch_plan import plan
from bondcell.jobs.manifest import Entry, read_entry, read_manifest, record
from bondcell.jobs.point_hash import HashIndex, point_hashes
from bondcell.jobs.rows import Row
from bondcell.scenes.parsing import load_scene, parse_scene
from bondcell.scenes.points import scene_cell
from bondcell.scenes.study import build_study

PARAMS = Path(__file__).parents[2] / "params"
SCENES = ("figure4", "gap_modulus", "extreme", "prony", "smoke")
CELL = {"radius_i": "7.5 mm", "young_i": "30 GPa", "poisson_i": 0, "poisson_m": 0.3}
SCENE = {
    "title": "Some points",
    "cell": CELL,
    "sweep": {"gap": ["0.5 mm", "1 mm"], "modulus_ratio": [10, 1e3]},
    "models": ["fsi"],
    "reference": {"tolerance": 1e-3},
}
PLAIN = {
    "radius_i": 7.5e-3,
    "gap": 5e-4,
    "young_i": 3e10,
    "young_m": 1.4e6,
    "poisson_i": 0.25,
    "poisson_m": 0.46,
}


def scene(**changes):
    return parse_scene({k: v for k, v in {**SCENE, **changes}.items() if v is not None})


def hashes(**changes):
    return {tuple(row) for row in point_hashes(scene_cell(scene(**changes))).tolist()}


@pytest.mark.parametrize(
    "changes",
    [
        {"sweep": {"modulus_ratio": [1000.0, 1e1], "gap": [0.001, 5e-4]}},
        {"sweep": {"gap": ["0.05 cm", "1e-3"], "modulus_ratio": ["1000", "10"]}},
        {"sweep": {"gap": ["500 um", "1 mm"], "young_m": ["3 GPa", "30 MPa"]}},
        {"cell": {**CELL, "poisson_i": -0.0, "radius_j": 7.5e-3, "cylinder_radius": "7.5 mm"}},
        {"cell": {**CELL, "gap": "3 mm", "young_m": 1e6}},
        {"title": "Other words", "models": ["generatrix"], "reference": None},
    ],
)
def test_how_a_point_is_written_does_not_matter(changes):
    assert hashes(**changes) == hashes()


@pytest.mark.parametrize("name", ["radius_j", "young_j", "poisson_j", "cylinder_radius"])
def test_every_input_counts_to_its_last_bit(name):
    values = Cell.from_values(**PLAIN).as_dict()
    value = float(values[name])
    towards = 1.0 if name == "cylinder_radius" else 0.0
    other = Cell.from_values(**{**values, name: np.nextafter(value, towards)})
    assert (point_hashes(other) != point_hashes(Cell(**values))).all()


def test_the_scheme_is_fixed():
    """Another hash needs another version of the scheme: files of old ones would not be found."""
    found = point_hashes(Cell.from_values(**PLAIN)).tolist()
    assert found == [[1821568635845913217, 7697914421281406221]]


@pytest.mark.parametrize("name", SCENES)
def test_study_and_plan_know_the_same_points(name):
    shipped = load_scene(PARAMS / f"{name}.yaml")
    cell, _ = cell_from_study(build_study(shipped))
    np.testing.assert_array_equal(point_hashes(cell), point_hashes(scene_cell(shipped)))


inputs = st.fixed_dictionaries(
    {name: st.lists(st.floats(0.01, 0.5), min_size=1, max_size=3) for name in ("gap", "poisson_m")}
)


@settings(max_examples=40, deadline=None)
@given(inputs, st.randoms(use_true_random=False))
def test_hashes_follow_the_points_wherever_they_stand(values, random):
    grid = {"gap": np.array(values["gap"])[:, None], "poisson_m": np.array(values["poisson_m"])}
    cell = Cell.from_values(**{**PLAIN, **grid})
    raveled = cell.ravel()
    found = point_hashes(cell)
    np.testing.assert_array_equal(found, point_hashes(raveled))
    order = list(range(len(found)))
    random.shuffle(order)
    np.testing.assert_array_equal(point_hashes(raveled.take(np.array(order))), found[order])
    points = list(zip(raveled.gap.tolist(), raveled.poisson_m.tolist(), strict=True))
    same = [points.index(point) for point in points]
    assert HashIndex(found).find(found).tolist() == same


@given(st.lists(st.tuples(st.integers(0, 2), st.integers(0, 3)), min_size=1))
def test_hashes_that_begin_alike_are_told_apart(pairs):
    known, wanted = np.array(pairs, dtype=np.uint64), [(i, j) for i in range(4) for j in range(5)]
    found = HashIndex(known).find(np.array(wanted, dtype=np.uint64))
    assert found.tolist() == [pairs.index(p) if p in pairs else -1 for p in wanted]


def entries(*batches):
    return [Entry(batch.name, batch.rows, batch.hashes) for batch in batches]


def test_plan_takes_what_is_there_and_computes_the_rest():
    before = plan(scene())
    (batch,) = before.new
    known = entries(batch)
    assert batch.points.gap.size == 4
    again = plan(scene(), known, lambda _: True)
    assert (again.new, again.needed) == ([], [batch.name])
    wider = scene(sweep={"gap": ["1 mm", "2 mm", "0.5 mm"], "modulus_ratio": [10, 1e3, 1e5]})
    more = plan(wider, known, lambda _: True)
    (new,) = more.new
    assert new.points.gap.size == 5
    assert set(more.needed) == {batch.name, new.name}
    fewer = scene(sweep={"gap": ["1 mm"], "modulus_ratio": [10]})
    assert plan(fewer, known, lambda _: True) == again


def test_a_planned_batch_counts_only_if_all_of_it_is_wanted():
    (batch,) = plan(scene()).new
    known = entries(batch)
    assert plan(scene(), known).needed == [batch.name]
    assert plan(scene(), known).new == []
    fewer = plan(scene(sweep={"gap": ["1 mm"], "modulus_ratio": [10]}), known)
    (only,) = fewer.new
    assert only.points.gap.tolist() == [1e-3]
    assert fewer.needed == [only.name]
    both = plan(scene(), entries(batch, only), lambda name: name == only.name)
    assert [found.points.gap.size for found in both.new] == [3]
    assert only.name in both.needed


@pytest.mark.parametrize(
    "changes",
    [
        {"reference": {"tolerance": 1e-4}},
        {"reference": {"tolerance": 1e-3, "bc": "clamped"}},
        {"load": "torsion", "models": None},
        {"cell": {**CELL, "poisson_m": 0.4}},
    ],
)
def test_what_values_depend_on_makes_other_batches(changes):
    (batch,) = plan(scene()).new
    other = plan(scene(**changes), entries(batch), lambda _: True)
    assert batch.name not in other.needed
    assert [found.points.gap.size for found in other.new] == [4]


def test_an_added_model_is_computed_alone():
    dense = {"gap": {"start": 1e-4, "stop": 1e-3, "points": 1000}}
    dense |= {"modulus_ratio": {"start": 1, "stop": 1e6, "points": 200, "spacing": "log"}}
    small = scene(sweep=dense, reference=None, models=["cementation"])
    (batch,) = plan(small).new
    wider = scene(sweep=dense, reference=None, models=["surrogate", "cementation"])
    more = plan(wider, entries(batch), lambda _: True)
    assert [new.models for new in more.new] == [("surrogate",)]
    assert batch.name in more.needed


def test_manifest_keeps_points_and_notices_damage(tmp_path):
    (batch,) = plan(scene()).new
    record(tmp_path, [batch])
    (path,) = (tmp_path / "manifest").iterdir()
    content = path.read_bytes()
    record(tmp_path, [batch])
    assert path.read_bytes() == content
    back = read_entry(path)
    assert (back.name, back.rows) == (batch.name, batch.rows)
    for name in UNITS:
        np.testing.assert_array_equal(getattr(back.points, name), getattr(batch.points, name))
    assert [entry.name for entry in read_manifest(tmp_path)] == [batch.name]
    for damaged in (content[:-40], content[:40], b"", content.replace(b"roller", b"clampd")):
        path.write_bytes(damaged)
        assert read_manifest(tmp_path) == []
    record(tmp_path, [batch])
    assert [entry.name for entry in read_manifest(tmp_path)] == [batch.name]
    path.rename(path.with_name("fe_roller_0123456789abcdef.npz"))
    assert read_manifest(tmp_path) == []


def test_names_follow_from_rows_and_points():
    row, points = Row("fe", "normal", "fe_roller"), Cell.from_values(**PLAIN).ravel()
    names = {
        Batch((row,), points).name,
        Batch((row,), Cell.from_values(**{**PLAIN, "gap": 1e-3}).ravel()).name,
        Batch((Row("fe", "normal", "fe_roller", (("tolerance", 1e-6),)),), points).name,
        Batch((Row("fe", "shear", "fe_shear"),), points).name,
    }
    assert len(names) == 4
