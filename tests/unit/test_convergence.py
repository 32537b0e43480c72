"""Convergence studies: orders, failures, the dataset and its table; most solves are formulas."""

import numpy as np
import pytest

from bondcell.errors import BondcellError, MissingLibrary
from bondcell.fem.level import Level
from bondcell.jobs import convergence_run
from bondcell.jobs.convergence_run import run_case, run_convergence
from bondcell.results.convergence import (
    COLUMNS,
    combine_cases,
    convergence_table,
    observed_order,
    relative_error,
)
from bondcell.scenes.parsing import parse_scene
from bondcell.status import Status
from bondcell.storage import read_dataset, write_dataset

EXACT = 1.6e5
SCENE = {
    "title": "Ladders",
    "cell": {
        "radius_i": 7.5e-3,
        "gap": 5e-4,
        "young_i": 3e10,
        "poisson_i": 0.25,
        "young_m": 1.4e6,
        "poisson_m": 0.46,
    },
    "models": ["fsi", "cementation"],
    "convergence": {
        "cases": {"base": {}, "narrow": {"gap": 1e-5, "poisson_m": 0.5, "bc": "confined"}},
        "orders": [2, 3, 4, 6, 14],
        "sizes": [1, 0.5, 0.25],
        "repeats": 3,
    },
}


def install_laws(patch):
    """Replace both solvers by known laws, error exp(-2 p) and 0.1 h^4; give the list of calls."""
    recorded = []

    def structured(cell, order, bc):
        recorded.append((order, bc, float(cell.gap)))
        error = 0 if order == 14 else np.exp(-2.0 * order)
        return Level(EXACT * (1 + error), 100 * order**2, 14, *(np.r_[1, 2, 3] * len(recorded)))

    def triangles(cell, size, bc):
        recorded.append((size, bc, float(cell.gap)))
        return Level(EXACT * (1 + 0.1 * size**4), round(1600 / size**2), 9, 0.1, 0.2, 0.3)

    patch.setattr(convergence_run.structured, "solve_level", structured)
    patch.setattr(convergence_run.triangles, "solve_level", triangles)
    return recorded


@pytest.fixture
def laws(monkeypatch):
    install_laws(monkeypatch)


@pytest.fixture(scope="module")
def scene():
    return parse_scene(SCENE, name="ladders")


@pytest.fixture(scope="module")
def run(scene):
    """The study of the scene, the calls of the solvers and of the progress."""
    progress = []
    with pytest.MonkeyPatch.context() as patch:
        calls = install_laws(patch)
        study = run_convergence(scene, lambda done, total: progress.append((done, total)))
    return study, calls, progress


@pytest.fixture(scope="module")
def study(run):
    return run[0]


def ladder(study, method, case="base"):
    return study.sel({"case": case, "method": method})


def test_observed_orders(study):
    rate = ladder(study, "structured")["order"].values
    np.testing.assert_allclose(rate, [np.nan, 2, 2, 2, np.nan], rtol=1e-3)
    order = ladder(study, "triangles")["order"].values
    np.testing.assert_allclose(order, [np.nan, 4, 4, np.nan, np.nan], rtol=1e-9)


def test_errors_are_relative_to_the_finest_structured_level_which_has_none(study):
    np.testing.assert_allclose(
        ladder(study, "structured")["error"],
        [*np.exp(-2.0 * np.array([2, 3, 4, 6])), np.nan],
        rtol=1e-9,
    )
    np.testing.assert_allclose(study["reference_error"], np.exp(-12), rtol=1e-5)


def test_round_off_and_equal_work_show_no_order():
    error = np.array([1e-4, 1e-14, 1e-8, 1e-9, np.nan])
    work = np.array([1.0, 2.0, 3.0, 3.0, 4.0])
    np.testing.assert_allclose(
        observed_order(error, work), [np.nan, np.nan, np.log(1e4) / 2, np.nan, np.nan]
    )
    assert np.isnan(relative_error(np.array([2.0]), 2.0))


def test_times_are_medians_of_repeats_without_the_first_run(run):
    study, calls, _ = run
    base = [call for call in calls if call[2] == SCENE["cell"]["gap"]]
    assert [call[0] for call in base] == [2] * 4 + [3] * 3 + [4] * 3 + [6] * 3 + [14] * 3 + (
        [1] * 4 + [0.5] * 3 + [0.25] * 3
    )
    coarsest = ladder(study, "structured").isel(level=0)
    assert coarsest["seconds_mesh"] == 3
    assert coarsest["seconds"] == 3 + 6 + 9


def test_spread_and_processor_time_stand_beside_the_median(run):
    coarsest = ladder(run[0], "structured").isel(level=0)
    assert coarsest["seconds_spread"] == 6 * (4 - 2)  # second to fourth call of the law above
    assert coarsest["seconds_cpu"] >= 0


def test_every_case_has_its_own_cell_and_condition(run):
    study, calls, _ = run
    assert {call[1:] for call in calls} == {("roller", 5e-4), ("confined", 1e-5)}
    assert study["bc"].values.tolist() == ["roller", "confined"]
    assert study["gap"].values.tolist() == [5e-4, 1e-5]


def test_models_stand_beside(study):
    base = study.sel(case="base")
    assert base["model_stiffness"].sel(analytic_model="fsi") == pytest.approx(84055.1310, rel=1e-9)
    assert base["model_error"].sel(analytic_model="fsi") == pytest.approx(
        1 - 84055.1310 / EXACT, rel=1e-6
    )
    assert 0 < base["model_seconds"].sel(analytic_model="fsi") < 1e-4
    diverging = study.sel(case="narrow", analytic_model="cementation")
    assert diverging["model_status"] == Status.diverges
    assert np.isnan(diverging["model_error"])


def test_table_is_tidy(study):
    table = convergence_table(study)
    assert tuple(table.columns) == COLUMNS
    assert len(table) == 2 * (5 + 3 + 2)
    assert not table.duplicated(["case", "method", "level"]).any()
    finest = table.query("case == 'base' and method == 'triangles'").iloc[-1]
    assert finest[["bc", "level", "refinement", "dof", "status"]].tolist() == [
        "roller",
        2,
        0.25,
        25600,
        "ok",
    ]
    models = table[table["method"] == "fsi"]
    assert models[["level", "dof", "refinement", "order"]].isna().all(axis=None)
    for name in ("seconds", "seconds_spread", "seconds_cpu"):
        assert (models[name] >= 0).all()


def test_file_and_back_give_the_same_table(study, tmp_path):
    path = tmp_path / "study.nc"
    write_dataset(study, path)
    again = read_dataset(path)
    assert convergence_table(again).equals(convergence_table(study))
    for name in study.data_vars:
        assert again[name].attrs["long_name"], name


def test_progress_counts_cases(run):
    assert run[2] == [(1, 2), (2, 2)]


@pytest.mark.usefixtures("laws")
@pytest.mark.parametrize("orders", [[2, 4], []])
def test_one_ladder_alone(orders):
    sizes = [] if orders else [1, 0.5]
    block = {"cases": {"base": {}}, "orders": orders, "sizes": sizes}
    result = run_case(parse_scene(SCENE | {"convergence": block, "models": ["fsi"]}), "base")
    assert result["method"].values.tolist() == (["structured"] if orders else ["triangles"])
    assert np.isnan(result["error"].isel({"method": 0, "level": -1 if orders else 1}))


@pytest.mark.usefixtures("laws")
def test_scene_without_models():
    bare = {key: value for key, value in SCENE.items() if key != "models"}
    table = convergence_table(run_convergence(parse_scene(bare)))
    assert set(table["method"]) == {"structured", "triangles"}


@pytest.mark.usefixtures("laws")
@pytest.mark.parametrize(
    ("error", "flag"),
    [
        (BondcellError("gmsh gave up"), Status.mesh_failed),
        (RuntimeError("factor is exactly singular"), Status.solver_failed),
        (np.linalg.LinAlgError("singular"), Status.solver_failed),
    ],
)
def test_failed_level_is_a_flagged_nan(scene, monkeypatch, error, flag):
    solve = convergence_run.triangles.solve_level

    def sometimes(cell, size, bc):
        if size == 0.5:
            raise error
        return solve(cell, size, bc)

    monkeypatch.setattr(convergence_run.triangles, "solve_level", sometimes)
    with pytest.warns(UserWarning, match=rf"case base, size = 0\.5: {error}"):
        case = run_case(scene, "base")
    result = case.sel({"method": "triangles"})
    status = [Status.ok, flag, Status.ok, Status.not_computed, Status.not_computed]
    assert result["status"].values.tolist() == status
    assert np.isnan(result["stiffness"].values).tolist() == [False, True, False, True, True]
    np.testing.assert_allclose(result["order"].values[2], 4, rtol=1e-9)
    table = convergence_table(combine_cases({"base": case}))
    assert table.loc[table["status"] == flag.name, "error"].isna().tolist() == [True]


def test_bad_input_of_a_level_is_flagged():
    block = {"cases": {"soft": {"poisson_m": 0.5}}, "sizes": [2, 1], "repeats": 1}
    with pytest.warns(UserWarning, match="poisson_m"):
        result = run_case(parse_scene(SCENE | {"convergence": block}), "soft")
    assert result["status"].values.tolist() == [[Status.limit_exceeded] * 2]
    assert result["error"].isnull().all()


@pytest.mark.usefixtures("laws")
def test_missing_library_costs_only_the_triangles(scene, monkeypatch):
    def fail(cell, size, bc):
        raise MissingLibrary("gmsh needs a system library")

    monkeypatch.setattr(convergence_run.triangles, "solve_level", fail)
    with pytest.warns(UserWarning, match="system library"):
        result = run_case(scene, "base")
    flags = result["status"]
    assert (flags.sel({"method": "triangles"}) == Status.mesh_failed).any()
    assert (flags.sel({"method": "structured"}) == Status.ok).any()


def test_unknown_case(scene):
    with pytest.raises(KeyError, match="no convergence case 'nothing'"):
        run_case(scene, "nothing")


def test_both_discretisations_for_real():
    block = {"cases": {"base": {}}, "orders": [2, 4, 6], "sizes": [1, 0.5], "repeats": 1}
    study = run_convergence(parse_scene(SCENE | {"convergence": block}))
    assert (study["status"].values[0, 0] == Status.ok).all()
    finest = study["stiffness"].sel({"method": "structured"}).values[0, -1]
    assert finest == pytest.approx(162460.7672, rel=2e-5)
    error = study["error"].sel({"method": "triangles"}).values[0]
    assert error[1] < error[0] / 5
    assert (study["seconds"].values[0, :, :2] > 0).all()


def test_all_loads_all_ladders_for_real(tmp_path):
    block = {
        "cases": {"base": {}, **{load: {"load": load} for load in ("shear", "bending")}},
        "orders": [3, 4, 6, 8],
        "gradings": [3, 1.7],
        "basis_order": 6,
        "repeats": 1,
    }
    study = run_convergence(parse_scene(SCENE | {"models": ["fsi"], "convergence": block}))
    assert set(np.unique(study["status"])) <= {Status.ok, Status.not_computed}
    assert study["status"].dtype == np.int8
    assert study["dof"].dtype == np.int64
    write_dataset(study, tmp_path / "study.nc")
    table = convergence_table(read_dataset(tmp_path / "study.nc"))
    assert table["load"].unique().tolist() == ["normal", "shear", "bending"]
    assert dict(zip(table["load"], table["unit"], strict=True))["bending"] == "N m rad-1"
    assert set(table["method"]) == {"structured", "structured_h", "reduced_basis", "fsi"}
    assert table.loc[table["method"] == "fsi", "load"].unique().tolist() == ["normal"]
    assert table["stiffness"].notna().all()
    ends = table.groupby(["case", "method"])["error"]
    coarse, fine = ends.first(), ends.min()
    assert (fine.xs("structured", level="method") < 1e-5).all()
    graded = [found.xs("structured_h", level="method") for found in (fine, coarse)]
    assert (graded[0] < graded[1]).all()
    assert (fine.xs("reduced_basis", level="method") < 1e-4).all()  # that of its order
    assert (table.loc[table["method"] == "structured", "error"].dropna() < 1e-2).all()
    basis = table[table["method"] == "reduced_basis"]
    assert (basis["sample_error"] <= basis["bound"] + 1e-9).all()
    assert (basis.groupby("case")["bound"].min() < 1e-8).all()
    assert (basis["seconds"] < 1e-2).all()


@pytest.mark.usefixtures("laws")
def test_rigid_particles_have_no_ladder_of_bases():
    block = {"cases": {"rigid": {"young_i": "rigid"}}, "sizes": [1], "basis_order": 4}
    with pytest.warns(UserWarning, match="reduced basis"):
        result = run_case(parse_scene(SCENE | {"convergence": block}), "rigid")
    assert result["status"].sel({"method": "reduced_basis"})[0] == Status.limit_exceeded
