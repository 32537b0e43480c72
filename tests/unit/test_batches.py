"""Batches: planned by cost, cover every point once, merge to what evaluate gives."""

import warnings

import numpy as np
import pytest
import xarray as xr

from bondcell.errors import DataError
from bondcell.evaluate import evaluate
from bondcell.inputs import cell_from_study
from bondcell.jobs.analytic_batch import compute_analytic
from bondcell.jobs.batch import Batch
from bondcell.jobs.batch_files import describe, read_batch, write_batch
from bondcell.jobs.batch_plan import JOB_SECONDS, analytic_parts, plan, reference_parts
from bondcell.jobs.cell_points import cell_at
from bondcell.jobs.collect import collect, labels, machines
from bondcell.jobs.job import job
from bondcell.jobs.merge import merge
from bondcell.jobs.reference_batch import compute_reference
from bondcell.jobs.rows import analytic_rows, reference_rows, wanted_rows
from bondcell.scenes.parsing import load_scene, parse_scene
from bondcell.scenes.planned_scene import planned_scene
from bondcell.scenes.study import build_study

SCENE = {
    "title": "A small scene",
    "cell": {"radius_i": "7.5 mm", "young_i": "30 GPa", "poisson_i": 0.25},
    "sweep": {
        "gap": ["0.5 mm", "1 mm", "2 mm"],
        "modulus_ratio": [10, 1e4],
        "poisson_m": [0, 0.3],
    },
    "models": ["generatrix", "fsi"],
    "contributions": True,
    "reference": {"bc": ["roller", "confined"], "tolerance": 1e-3},
}


@pytest.fixture(scope="module")
def scene():
    return parse_scene(SCENE, name="small")


@pytest.fixture(scope="module")
def study(scene):
    return build_study(scene)


def part(study, rows, positions):
    cell, _ = cell_from_study(study)
    return Batch(tuple(rows), cell_at(cell, np.asarray(positions)))


@pytest.fixture(scope="module")
def computed(scene, study):
    """Batches of the scene, cut finer than the plan would."""
    shares = [np.arange(12)[start::3] for start in range(3)]
    found = [compute_analytic(part(study, analytic_rows(scene, "normal"), at)) for at in shares]
    for row in reference_rows(scene, "normal"):
        found += [compute_reference(part(study, [row], at)) for at in (range(4), range(4, 12))]
    return found


def test_plan_of_the_small_scene(scene):
    methods = [batch.name.rpartition("_")[0] for batch in plan(scene).new]
    assert methods == ["fe_roller", "fe_confined"]
    assert plan(scene).needed == plan(scene).names("fe") == sorted(b.name for b in plan(scene).new)


def test_plan_leaves_out_what_the_scene_does():
    without = {k: v for k, v in SCENE.items() if k != "reference"}
    assert plan(parse_scene(without)).new == []
    without = {k: v for k, v in SCENE.items() if k not in ("models", "contributions")}
    assert [batch.models for batch in plan(parse_scene(without)).new] == [
        ("fe_roller",),
        ("fe_confined",),
    ]


def cuts(geometries, states):
    points = np.arange(geometries * states).reshape(geometries, states)
    return reference_parts(list(points))


def test_jobs_grow_with_the_work_and_never_one_a_point():
    points = np.arange(1_000_000)[:, None]
    assert len(analytic_parts(points[:100_000], ["fsi"])) == 0
    assert len(analytic_parts(points, ["fsi"])) == 2
    assert len(analytic_parts(points[:200_000], ["fsi", "cementation"])) == 1
    assert len(analytic_parts(list(points[:20]), ["bounds"])) == 1
    assert len(analytic_parts(list(points[:10_000]), ["fsi", "film"])) == 2
    assert len(analytic_parts(list(points), ["fsi", "film"])) == 100
    shares = analytic_parts(list(points[:10_000].reshape(100, 100)), ["bounds"])
    assert sorted(np.concatenate(shares).tolist()) == list(range(10_000))
    assert len(cuts(200, 100)) == 10
    assert len(cuts(2, 120_000)) == 6
    assert len(cuts(100_000, 1)) == 100
    assert JOB_SECONDS >= 30


def test_batches_share_no_geometry_unless_it_is_very_large():
    parts = cuts(30, 100)
    assert sorted(np.concatenate(parts).tolist()) == list(range(3000))
    geometries = [set(share // 100) for share in parts]
    assert len(geometries) == 2
    assert not set.intersection(*geometries)


def test_points_are_picked_without_raveling(study):
    cell, _ = cell_from_study(study)
    positions = np.array([11, 0, 5])
    expected = cell.ravel().take(positions)
    found = cell_at(cell, positions)
    for name, value in expected.as_dict().items():
        np.testing.assert_array_equal(getattr(found, name), value)


def test_merged_batches_are_what_evaluate_gives(scene, study, computed):
    merged = merge(study, computed, labels(scene))
    assert merged.stiffness.dims == ("model", "gap", "modulus_ratio", "poisson_m")
    assert merged.model.values.tolist() == ["generatrix", "fsi", "fe", "fe_confined"]
    for name in ("generatrix", "fsi"):
        expected = evaluate(study, name).stiffness
        np.testing.assert_allclose(merged.stiffness.sel(model=name), expected, rtol=1e-14)
    expected = evaluate(study, "fe", tolerance=1e-3)
    np.testing.assert_allclose(merged.stiffness.sel(model="fe"), expected.stiffness, rtol=1e-12)
    assert (merged.dof.sel(model="fe") == expected.dof).all()
    confined = merged.stiffness.sel(model="fe_confined")
    assert (confined >= merged.stiffness.sel(model="fe") * (1 - 1e-3)).all()
    k_int = evaluate(study, "fsi").k_int
    np.testing.assert_allclose(merged.k_int, k_int, rtol=1e-14)
    xr.testing.assert_identical(merged.gap, study.gap)
    assert float(merged.poisson_i) == 0.25


def test_dimensions_keep_the_order_of_the_scene():
    axes = {"poisson_m": [0.1, 0.2], "modulus_ratio": [1, 2], "gap_ratio": [0.1], "radius_i": [1]}
    cell = {"young_i": 1, "poisson_i": 0.2}
    scene = parse_scene({"title": "Order", "cell": cell, "sweep": axes, "models": ["fsi"]})
    assert cell_from_study(build_study(scene))[1] == tuple(axes)


def test_order_of_the_batches_does_not_matter(scene, study, computed):
    one = merge(study, computed, labels(scene))
    xr.testing.assert_identical(one, merge(study, computed[::-1], labels(scene)))


def test_missing_points_are_refused_others_passed_over(scene, study, computed):
    with pytest.raises(DataError, match="fe_confined = '8 of 12 points missing'"):
        merge(study, computed[:-1], labels(scene))
    whole = merge(study, computed, labels(scene))
    xr.testing.assert_identical(merge(study, [*computed, computed[-1]], labels(scene)), whole)
    fewer = study.isel(gap=[0, 2])
    xr.testing.assert_identical(merge(fewer, computed, labels(scene)), whole.isel(gap=[0, 2]))
    only = merge(study, computed, {"fsi": "fsi"})
    xr.testing.assert_identical(only.stiffness, whole.stiffness.sel(model=["fsi"]))


def test_a_point_that_comes_twice_is_computed_once():
    cell = {**SCENE["cell"], "young_m": "1 MPa", "poisson_m": 0.3, "radius_i": "8 mm"}
    sweep = {"gap": ["1 mm", "2 mm"], "modulus_ratio": ["rigid"], "poisson_i": [0.2, 0.3]}
    scene = parse_scene({"title": "Rigid", "cell": cell, "sweep": sweep, "models": ["fsi"]})
    study = build_study(scene).isel(gap=[0, 1, 0])
    batch = compute_analytic(part(study, analytic_rows(scene, "normal"), range(4)))
    merged = merge(study, [batch], labels(scene))
    assert merged.stiffness.shape == (1, 3, 1, 2)
    xr.testing.assert_equal(merged.isel(gap=0), merged.isel(gap=2))


def test_single_cell_without_sweep():
    scene = parse_scene(
        {
            "title": "One cell",
            "cell": {**SCENE["cell"], "gap": "1 mm", "young_m": "1 MPa", "poisson_m": 0.3},
            "models": ["fsi"],
        }
    )
    study = build_study(scene)
    merged = merge(study, [compute_analytic(part(study, wanted_rows(scene), [0]))], labels(scene))
    assert merged.stiffness.dims == ("model",)
    assert "k_i" not in merged


def test_a_failed_geometry_stays_a_flagged_nan_in_the_file(tmp_path, scene, study, monkeypatch):
    from bondcell.fem import reference

    def solve(cell, **options):
        if cell.gap[0] > 1.5e-3:
            raise ArithmeticError("no factorisation")
        return reference.solve(cell, **options)

    monkeypatch.setattr("bondcell.jobs.reference_batch.solve", solve)
    with pytest.warns(RuntimeWarning, match="no factorisation"):
        batch = compute_reference(part(study, reference_rows(scene, "normal")[:1], range(12)))
    write_batch(batch, tmp_path / "fe.nc", "digest")
    back = read_batch(tmp_path / "fe.nc", "digest")
    merged = merge(study, [back], {"fe_roller": "fe"})
    assert np.isnan(merged.stiffness.sel(model="fe", gap=2e-3)).all()
    assert (merged.status.sel(model="fe", gap=2e-3) == 4).all()
    assert np.isfinite(merged.stiffness.sel(model="fe", gap=[5e-4, 1e-3])).all()
    assert describe(back) == "8/12 points, solver_failed: 4"


def test_file_of_other_parameters_is_refused(tmp_path, computed):
    write_batch(computed[0], tmp_path / "a.nc", "one")
    with pytest.raises(DataError, match="digest = 'one'"):
        read_batch(tmp_path / "a.nc", "other")


def test_collect_names_damaged_files(tmp_path, scene, study, computed):
    files = [tmp_path / f"{i}.nc" for i in range(len(computed))]
    for file, batch in zip(files, computed, strict=True):
        write_batch(batch, file, file.stem)
    result = collect(scene, study, files[:3], files[3:])
    inline = collect(scene, study, [], files[3:])
    xr.testing.assert_allclose(inline.drop_vars("seconds"), result.drop_vars("seconds"))
    assert result.attrs["title"] == "A small scene"
    assert result.attrs["machine"] == computed_machine(files[0])
    content = files[1].read_bytes()
    files[1].write_bytes(content[: len(content) // 2])
    with pytest.raises(DataError, match=r"1\.nc.*a batch that matches its checksum"):
        collect(scene, study, files[:3], files[3:])


def computed_machine(file):
    with xr.open_dataset(file) as dataset:
        return dataset.attrs["machine"]


def test_several_machines_are_all_named():
    here = xr.Dataset(attrs={"machine": "one", "cores": "2", "platform": "x"})
    there = here.assign_attrs(machine="two")
    assert machines([here, there, here])["machine"] == "one | two"
    assert machines([here, there])["cores"] == "2 | 2"  # in the order of the machines
    assert machines([]) == {}


def test_scene_edited_after_planning_is_refused(tmp_path):
    path = tmp_path / "scene.yaml"
    text = (
        "title: One\nmodels: [fsi]\ncell: {radius_i: 7.5 mm, gap: 1 mm, young_i: 1 GPa, "
        "young_m: 1 MPa, poisson_i: 0.2, poisson_m: 0.3}\n"
    )
    path.write_text(text)
    digest = load_scene(path).digest
    assert planned_scene(path, digest=digest).title == "One"
    path.write_text(text.replace("1 mm", "2 mm"))
    with pytest.raises(DataError, match="edited since"):
        planned_scene(path, digest=digest)


def test_job_prints_one_line(capsys):
    with job("small: analytic") as log:
        log.result = "12/12 points"
    assert capsys.readouterr().err.startswith("small: analytic: 12/12 points, 0.")


def test_job_turns_bad_input_into_a_message_and_status_2(capsys):
    with pytest.raises(SystemExit) as stop, job("small: collect"):
        evaluate(xr.Dataset({"gap": -1.0}))
    assert stop.value.code == 2
    assert "small: collect: error: " in capsys.readouterr().err


def test_job_passes_warnings_on_as_lines(capsys):
    with job("small"):
        warnings.warn("solver_failed: 4 points", RuntimeWarning, stacklevel=1)
    assert "small: warning: solver_failed: 4 points" in capsys.readouterr().err
