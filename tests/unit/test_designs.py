"""Designs of a scene: what points they make, how they grow, what may be written."""

import copy
import json
import subprocess
import sys

import jsonschema
import numpy as np
import pytest
import xarray as xr
from hypothesis import given, settings
from hypothesis import strategies as st

from bondcell.errors import SceneError
from bondcell.figures.scatter import draw_scatter
from bondcell.jobs.collect import collect
from bondcell.jobs.point_hash import point_hashes
from bondcell.results.accuracy import accuracy_table
from bondcell.results.view import parameters
from bondcell.scenes.design import unit_points
from bondcell.scenes.parsing import parse_scene
from bondcell.scenes.points import scene_cell
from bondcell.scenes.schema import scene_json_schema
from bondcell.scenes.study import build_study

CELL = {"radius_i": "7.5 mm", "young_i": "30 GPa", "poisson_i": 0.25, "poisson_m": 0.3}
RATIO = {"start": 10, "stop": 1e4, "spacing": "log"}
GAP = {"start": "0.1 mm", "stop": "2 mm"}
DESIGN = {"kind": "sobol", "points": 8, "seed": 3, "ranges": {"gap": GAP, "modulus_ratio": RATIO}}
SCENE = {"title": "A design", "cell": CELL, "design": DESIGN, "models": ["fsi", "generatrix"]}


def scene(tables=None, **changes):
    whole = {k: v for k, v in {**SCENE, **changes}.items() if v is not None}
    return parse_scene(whole, tables=tables)


def design(**changes):
    return {k: v for k, v in {**DESIGN, **changes}.items() if v is not None}


def violations(tables=None, **changes):
    with pytest.raises(SceneError) as caught:
        scene(tables, **changes)
    return {violation.field: str(violation.allowed) for violation in caught.value.violations}


def hashes(parsed):
    return point_hashes(scene_cell(parsed)).tolist()


def test_points_lie_in_their_ranges_evenly_in_the_asked_measure():
    samples = scene(design=design(points=256)).samples
    gap, ratio = samples["gap"], samples["modulus_ratio"]
    assert gap.min() >= 1e-4
    assert gap.max() <= 2e-3
    assert np.median(gap) == pytest.approx(1.05e-3, rel=0.02)
    assert np.median(np.log10(ratio)) == pytest.approx(2.5, abs=0.02)


@given(st.integers(1, 40), st.integers(1, 40), st.integers(1, 6), st.integers(0, 2**32 - 1))
@settings(max_examples=25, deadline=None)
def test_more_points_of_a_sequence_keep_the_first(few, more, dimensions, seed):
    one = unit_points("sobol", (few,), dimensions, seed)
    two = unit_points("sobol", (few + more,), dimensions, seed)
    np.testing.assert_array_equal(one, two[:few])


@given(st.lists(st.integers(1, 12), min_size=1, max_size=4), st.integers(0, 100))
@settings(max_examples=25, deadline=None)
def test_hypercubes_are_latin_and_another_one_keeps_the_first(counts, seed):
    cubes = unit_points("latin_hypercube", tuple(counts), 3, seed)
    more = unit_points("latin_hypercube", (*counts, 5), 3, seed)
    np.testing.assert_array_equal(cubes, more[: len(cubes)])
    for part in np.split(more, np.cumsum(counts)):
        strata = np.sort(np.floor(part * len(part)), axis=0)
        np.testing.assert_array_equal(strata, np.arange(len(part))[:, None].repeat(3, axis=1))


def test_a_hypercube_of_another_size_is_another_one():
    few, many = (scene(design=design(kind="latin_hypercube", points=n)) for n in (8, 9))
    assert not {tuple(row) for row in hashes(few)} & {tuple(row) for row in hashes(many)}


def test_same_seed_same_points_whatever_the_order_of_the_keys():
    turned = {"modulus_ratio": RATIO, "gap": GAP}
    assert hashes(scene()) == hashes(scene(design=design(ranges=turned)))
    assert hashes(scene()) != hashes(scene(design=design(seed=4)))


def test_study_has_the_parameters_along_samples_beside_a_sweep():
    parsed = scene(sweep={"poisson_m": [0.1, 0.2, 0.3]})
    study = build_study(parsed)
    assert parsed.points == 24
    assert dict(study.sizes) == {"poisson_m": 3, "sample": 8}
    assert study["gap"].dims == study["young_m"].dims == ("sample",)
    np.testing.assert_array_equal(study["young_m"], 3e10 / study["modulus_ratio"])
    result = collect(parsed, study, [], [])
    assert parameters(result) == ["poisson_m", "gap", "modulus_ratio"]
    assert json.loads(result.attrs["design"])["seed"] == 3
    drawn = draw_scatter(result)
    assert "24 points" in drawn.caption
    assert len([axes for axes in drawn.figure.axes if axes.get_visible()]) == 3
    assert draw_scatter(result, x="gap").figure.axes[0].get_xlabel().startswith("gap")


def test_accuracy_says_at_which_parameters():
    values = [[1.0, 3.0, 1.1], [1.0, 2.0, 1.0]]
    study = xr.Dataset(
        {"stiffness": (("model", "sample"), values)},
        {"model": ["fsi", "fe"], "sample": range(3), "gap": ("sample", [1e-3, 2e-3, 3e-3])},
    )
    row = accuracy_table(study).iloc[0]
    assert (row["abs_error_max"], row["at_gap"]) == (0.5, 2e-3)
    assert "at_sample" not in row


def test_tables_are_read_to_the_last_bit(tmp_path):
    values = np.random.default_rng(0).random(50) / 2
    lines = "\n".join(f"{value!r}, {i + 1} mm" for i, value in enumerate(values.tolist()))
    (tmp_path / "a.csv").write_text(f"poisson_m,gap\n{lines}\n")
    parsed = scene(tmp_path, design={"table": "a.csv"}, cell={**CELL, "young_m": 1e6})
    np.testing.assert_array_equal(parsed.samples["poisson_m"], values)
    assert parsed.samples["gap"][1] == 2e-3
    columns = {name: ("row", column) for name, column in parsed.samples.items()}
    xr.Dataset(columns).to_netcdf(tmp_path / "a.nc")
    same = scene(tmp_path, design={"table": "a.nc"}, cell={**CELL, "young_m": 1e6})
    assert hashes(parsed) == hashes(same)
    assert parsed.digest != same.digest


@pytest.mark.parametrize(
    ("content", "field", "words"),
    [
        (None, "design.table points.csv", "an existing file"),
        ("", "design.table points.csv", "1 to 10000000 rows"),
        ("gap;young_m\n0,5 mm;1 MPa\n", "design.table points.csv: first line", "commas between"),
        ("gap\tyoung_m\n1\t2\n", "design.table points.csv: first line", "commas between"),
        ("gap,gap\n1,2\n", "design.table points.csv.gap", "each column once"),
        ("gap,young_m\n1,2\n3\n", "design.table points.csv.1", "2, one for each column"),
        ("gap\n1_0\n", "design.table points.csv.gap.0", "a length"),
        ("gap\n", "design.table points.csv", "1 to 10000000 rows"),
        ("gap\n1 mm\n\xff\n", "design.table points.csv", "a readable table"),
        ("gap,colour\n1,2\n", "design.table points.csv.colour", "one of radius_i"),
        ("gap\n1 mm\ntwo\n", "design.table points.csv.gap.1", "a length"),
        ("gap\n1 mm\n\n3 kg\n", "design.table points.csv.gap.1", "kg is no length"),
        ("gap\n1\nnan\n", "design.table points.csv.gap.1", "a length"),
        ("gap\n1\ninf\n", "design.table points.csv.gap.1", "a length"),
        ("gap\n1e-3\n-1e-3\n", "design.table.gap", "(0, inf) m"),
        ("modulus_ratio\n1\nrigid\n", "cell.young_m", "beside the modulus ratio rigid"),
        ("gap,gap_ratio\n1,1\n", "design.table.gap_ratio", "both set gap"),
        ("gap_ratio\n1\n0\n", "design.table.gap_ratio", "one that puts gap in"),
    ],
)
def test_bad_tables(tmp_path, content, field, words):
    if content is not None:
        (tmp_path / "points.csv").write_bytes(content.encode("latin-1"))
    cell = {**CELL, "gap": "1 mm"}
    found = violations(tmp_path, design={"table": "points.csv"}, cell=cell)
    assert words in found[field]


def test_bad_netcdf_tables(tmp_path):
    data = xr.Dataset({"gap": ("row", [1.0, 2.0], {"units": "mm"}), "poisson_m": 0.3})
    data.to_netcdf(tmp_path / "points.nc")
    found = violations(tmp_path, design={"table": "points.nc"})
    assert found["design.table points.nc.gap.units"] == "'m'"
    assert "one dimension" in found["design.table points.nc.poisson_m"]
    (tmp_path / "points.nc").write_bytes(b"CDF")
    assert "design.table points.nc" in violations(tmp_path, design={"table": "points.nc"})


BAD = [
    ({}, {"design.kind", "design.points", "design.ranges"}),
    ({"kind": "lhs", "points": 4}, {"design.kind", "design.ranges"}),
    (design(points=0), {"design.points.0"}),
    (design(points=2.5), {"design.points.0"}),
    (design(points=1e8), {"design.points.0"}),
    (design(points=[4, 4]), {"design.points"}),
    (design(points=[]), {"design.points"}),
    (design(points=True), {"design.points.0"}),
    (design(seed=-1), {"design.seed"}),
    (design(seed="now"), {"design.seed"}),
    (design(ranges={}), {"design.ranges"}),
    (design(ranges={"gap": [1, 2]}), {"design.ranges.gap"}),
    (design(ranges={"gap": {**GAP, "points": 3}}), {"design.ranges.gap.points"}),
    (design(ranges={"gap": {**GAP, "stop": "0.1 mm"}}), {"design.ranges.gap"}),
    (design(ranges={"gap": {**GAP, "start": -1}}), {"design.ranges.gap"}),
    (design(ranges={"gap": {**GAP, "start": 0, "spacing": "log"}}), {"design.ranges.gap"}),
    (design(ranges={"poisson_m": {"start": 0, "stop": 0.7}}), {"design.ranges.poisson_m"}),
    (design(ranges={"color": GAP}), {"design.ranges.color"}),
    (design(ranges={**DESIGN["ranges"], "gap_ratio": RATIO}), {"design.ranges.gap_ratio"}),
    ({"table": "../points.csv"}, {"design.table"}),
    ({"table": "/etc/passwd"}, {"design.table"}),
    ({"table": "points.txt"}, {"design.table"}),
    ({**DESIGN, "table": "points.csv"}, {f"design.{name}" for name in DESIGN}),
    ("sobol", {"design"}),
    ([1, 2], {"design"}),
]  # fmt: skip


@pytest.mark.parametrize(("block", "fields"), BAD)
def test_bad_designs_name_every_key(tmp_path, block, fields):
    (tmp_path / "points.csv").write_text("gap\n1 mm\n")
    assert fields <= set(violations(tmp_path, design=copy.deepcopy(block)))


@pytest.mark.parametrize(
    ("changes", "field"),
    [
        ({"sweep": {"gap": [1e-3]}}, "design.ranges.gap"),
        ({"sweep": {"young_m": [1e6]}}, "design.ranges.modulus_ratio"),
        ({"sweep": {"poisson_m": {"start": 0, "stop": 0.5, "points": 9_000_000}}}, "sweep"),
        ({"models": None}, "models"),
        ({"cell": {"radius_i": 1}}, "cell.young_i"),
        ({"atlas": True}, "design"),
    ],
)
def test_designs_beside_other_keys(changes, field):
    assert field in violations(**changes)


def test_schema_takes_what_the_scene_takes():
    schema = scene_json_schema()
    good = [DESIGN, design(kind="latin_hypercube", points=[3, 4]), {"table": "points.csv"}]
    for block in good:
        jsonschema.validate({**SCENE, "design": block}, schema)
    for block in ({"table": "a/b.csv"}, design(points=0), design(kind="lhs")):
        with pytest.raises(jsonschema.ValidationError):
            jsonschema.validate({**SCENE, "design": block}, schema)


def test_only_making_the_points_loads_the_library_of_designs():
    code = (
        "import sys; from bondcell.scenes.parsing import parse_scene;"
        f"scene = parse_scene({SCENE!r}); scene.digest; scene.points;"
        "assert 'scipy.stats' not in sys.modules; scene.samples;"
        "assert 'scipy.stats' in sys.modules"
    )
    subprocess.run([sys.executable, "-c", code], check=True)
