"""Batches: planned by cost, cover every point once, merge to what evaluate gives."""

import warnings

import numpy as np
import pytest
import xarray as xr

from bondcell.errors import DataError, InputError
from bondcell.evaluate import evaluate
from bondcell.inputs import cell_from_study
from bondcell.jobs.analytic_batch import compute_analytic
from bondcell.jobs.batch import Batch, cell_at
from bondcell.jobs.batch_files import describe, read_batch, write_batch
from bondcell.jobs.batch_plan import JOB_SECONDS, analytic_batches, plan, reference_batches
from bondcell.jobs.collect import collect, labels, machines
from bondcell.jobs.job import job
from bondcell.jobs.merge import merge
from bondcell.jobs.reference_batch import compute_reference
from bondcell.scenes.planned_scene import planned_scene
from bondcell.scenes.scene import load_scene, parse_scene
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


@pytest.fixture(scope="module")
def computed(scene, study):
    """Batches of the scene, cut finer than the plan would."""
    found = []
    for part in (1, 2, 3):
        batch = Batch("analytic", part, 3)
        found.append(compute_analytic(study, batch, scene.models, contributions=True))
    for method in ("fe_roller", "fe_confined"):
        for part in (1, 2):
            found.append(compute_reference(study, Batch(method, part, 2), 1e-3))
    return found


def test_names_are_stable_and_read_back():
    batch = Batch("fe_roller", 3, 12)
    assert batch.name == "fe_roller_3of12"
    assert Batch.parse(batch.name) == batch


@pytest.mark.parametrize("name", ["fe_roller", "fe_roller_0of2", "fe_roller_3of2", "../x_1of1", ""])
def test_wrong_names_are_refused(name):
    with pytest.raises(InputError, match="batch"):
        Batch.parse(name)


def test_plan_of_the_small_scene(scene):
    names = [batch.name for batch in plan(scene)]
    assert names == ["fe_roller_1of1", "fe_confined_1of1"]


def test_plan_leaves_out_what_the_scene_does():
    without = {k: v for k, v in SCENE.items() if k != "reference"}
    assert plan(parse_scene(without)) == []
    without = {k: v for k, v in SCENE.items() if k not in ("models", "contributions")}
    assert [batch.method for batch in plan(parse_scene(without))] == ["fe_roller", "fe_confined"]


def test_jobs_grow_with_the_work_and_never_one_a_point():
    assert len(analytic_batches(10_000, 6)) == 0
    assert len(analytic_batches(100_000, 6)) == 1
    assert len(analytic_batches(10_000_000, 1)) == 10
    assert len(analytic_batches(10_000_000, 6)) == 30
    assert len(reference_batches({"gap": 200, "young_m": 100}, ("roller",))) == 10
    assert len(reference_batches({"gap": 2, "young_m": 10**6}, ("roller",))) == 2
    assert JOB_SECONDS >= 30


def test_parts_of_a_batch_share_no_geometry(study):
    cell, _ = cell_from_study(study)
    gaps = np.broadcast_to(cell.gap, cell.shape).ravel()
    parts = [Batch("fe_roller", part, 2).points(cell) for part in (1, 2)]
    assert sorted(np.concatenate(parts).tolist()) == list(range(12))
    assert not set(gaps[parts[0]]) & set(gaps[parts[1]])


def test_more_parts_than_geometries_leave_some_empty(study):
    cell, _ = cell_from_study(study)
    assert Batch("fe_roller", 5, 5).points(cell).size == 0
    empty = compute_reference(study, Batch("fe_roller", 5, 5), 1e-3)
    assert empty.sizes == {"model": 1, "point": 0}


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


def test_missing_doubled_and_foreign_points_are_refused(scene, study, computed):
    with pytest.raises(DataError, match="fe_confined = '4 of 12 points'"):
        merge(study, computed[:-1], labels(scene))
    with pytest.raises(DataError, match="fe_confined = '4 of 12 points'"):
        merge(study, [*computed, computed[-1]], labels(scene))
    shifted = computed[0].assign(point_index=computed[0].point_index + 10)
    with pytest.raises(DataError, match="point_index"):
        merge(study, [shifted, *computed[1:]], labels(scene))
    twice = computed[0].assign(point_index=computed[0].point_index * 0)
    with pytest.raises(DataError, match="point_index"):
        merge(study, [twice, *computed[1:]], labels(scene))
    with pytest.raises(DataError, match="model"):
        merge(study, computed, {"fsi": "fsi"})


def test_single_cell_without_sweep():
    scene = parse_scene(
        {
            "title": "One cell",
            "cell": {**SCENE["cell"], "gap": "1 mm", "young_m": "1 MPa", "poisson_m": 0.3},
            "models": ["fsi"],
        }
    )
    study = build_study(scene)
    merged = merge(study, [compute_analytic(study, Batch("analytic"), ("fsi",))], labels(scene))
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
        batch = compute_reference(study, Batch("fe_roller"), 1e-3)
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
        analytic = "fe_" not in str(batch.model.values[0])
        digest = scene.models_digest if analytic else scene.reference_digest
        write_batch(batch, file, digest)
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
    digest = load_scene(path).models_digest
    assert planned_scene(path, models_digest=digest).title == "One"
    path.write_text(text.replace("1 mm", "2 mm"))
    with pytest.raises(DataError, match="edited since"):
        planned_scene(path, models_digest=digest)


def test_job_prints_one_line(capsys):
    with job("small: analytic_1of1") as log:
        log.result = "12/12 points"
    assert capsys.readouterr().err.startswith("small: analytic_1of1: 12/12 points, 0.")


def test_job_turns_bad_input_into_a_message_and_status_2(capsys):
    with pytest.raises(SystemExit) as stop, job("small: collect"):
        evaluate(xr.Dataset({"gap": -1.0}))
    assert stop.value.code == 2
    assert "small: collect: error: " in capsys.readouterr().err


def test_job_passes_warnings_on_as_lines(capsys):
    with job("small"):
        warnings.warn("solver_failed: 4 points", RuntimeWarning, stacklevel=1)
    assert "small: warning: solver_failed: 4 points" in capsys.readouterr().err
