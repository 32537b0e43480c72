"""evaluate: labels, flags, chunks, bad input, the reference by geometry."""

from importlib import import_module

import numpy as np
import pytest
import xarray as xr

import bondcell
from bondcell.by_geometry import geometry_groups, solve_points
from bondcell.cell import Cell
from bondcell.evaluate import blocks, evaluate
from bondcell.fem.reference import Reference
from bondcell.models.model import Model, Springs
from bondcell.outputs import DETAILS, WAYS
from bondcell.status import Status

MODULE = import_module("bondcell.evaluate")  # the attribute of the package is the function
BASE = {"radius_i": 7.5e-3, "gap": 5e-4, "young_i": 3e10, "young_m": 1.4e6}
POISSON = {"poisson_i": 0.25, "poisson_m": 0.46}


def study(**changes):
    return xr.Dataset({**BASE, **POISSON, **changes})


def fake_reference(cell, load="normal", bc="roller", tolerance=1e-6):
    """Answers E_m R_i; refuses a gap of 2e-4, has no mesh for one of 3e-4."""

    class MeshError(RuntimeError):
        pass

    assert all(np.ptp(getattr(cell, name)) == 0 for name in ("radius_i", "radius_j", "gap"))
    if cell.gap[0] == 2e-4:
        raise np.linalg.LinAlgError("singular")
    if cell.gap[0] == 3e-4:
        raise MeshError("inverted element")
    count = cell.gap.size
    return Reference(
        stiffness=cell.young_m * cell.radius_i,
        error_estimate=np.full(count, tolerance),
        status=np.zeros(count, dtype=np.int8),
        dof=np.full(count, 402),
        order=np.full(count, 4),
        seconds=np.full(count, 0.01),
        way=np.zeros(count, dtype=np.int8),
        coupling=np.full(count, -3.0 if load == "bending" else np.nan),
        reduction_error=np.full(count, tolerance / 20),
    )


@pytest.fixture
def fake_fem(monkeypatch):
    monkeypatch.setattr("bondcell.fem.reference.solve", fake_reference)


@pytest.fixture
def fake_model(monkeypatch):
    """A model that is infinite at nu_m = 1/2 and valid for gaps below 1e-3."""

    def stiffness(cell, factor=1.0):
        value = factor * cell.young_m * cell.gap / (1 - 2 * cell.poisson_m)
        value = np.broadcast_to(value, cell.shape)
        return Springs(value, {"k_i": np.broadcast_to(cell.gap, cell.shape)}, 1e-15)

    model = Model(
        name="fake",
        title="",
        summary="",
        source="",
        valid_range="",
        loads={"normal": stiffness},
        options={"factor": "a factor"},
        is_valid=lambda cell: np.broadcast_to(cell.gap < 1e-3, cell.shape),
    )
    monkeypatch.setattr(MODULE, "MODELS", {"fake": model})
    return model


def test_scalars_give_scalars_and_the_checked_value_of_the_paper():
    out = evaluate(study())
    assert out.stiffness.dims == ()
    assert float(out.k_int) == pytest.approx(84065.1275, rel=1e-9)
    assert float(out.stiffness) == pytest.approx(84055.1310, rel=1e-9)
    assert int(out.status) == Status.ok
    assert int(out.dof) == 0
    assert float(out.seconds) > 0


def test_dimensions_broadcast_by_name_and_coordinates_are_kept():
    swept = study(young_m=("modulus_ratio", [3e9, 3e6]), poisson_m=("nu", [0.0, 0.25, 0.46]))
    swept = swept.assign_coords(
        gap=("gap", [1e-4, 1e-3, 1e-2, 1e-1]), modulus_ratio=[10.0, 1e4], unused=("other", [1, 2])
    )
    out = evaluate(swept)
    assert out.stiffness.dims == tuple(dim for dim in swept.sizes if dim != "other")
    assert dict(out.sizes) == {"modulus_ratio": 2, "nu": 3, "gap": 4}
    assert set(out.coords) == {"gap", "modulus_ratio"}
    point = {"modulus_ratio": 1, "nu": 2, "gap": 3}
    single = evaluate(study(young_m=3e6, poisson_m=0.46, gap=0.1))
    assert float(out.stiffness[point]) == pytest.approx(float(single.stiffness), rel=1e-15)


def test_result_describes_itself():
    out = evaluate(study())
    assert out.stiffness.attrs["units"] == "N m-1"
    assert out.seconds.attrs["units"] == "s"
    assert out.status.attrs["flag_meanings"].split()[Status.diverges] == "diverges"
    assert all("long_name" in variable.attrs for variable in out.data_vars.values())
    assert out.attrs == {"model": "fsi", "load": "normal"}


def test_coordinate_by_the_name_of_a_result():
    taken = study(gap=("status", [1e-4, 1e-3])).assign_coords(status=[1, 2])
    with pytest.raises(bondcell.InputError, match="status = 'coordinate'"):
        evaluate(taken)


def test_boundary_conditions_are_those_of_the_reference():
    from bondcell.fem.supports import NORMAL
    from bondcell.reference_options import BOUNDARY_CONDITIONS

    assert tuple(NORMAL) == BOUNDARY_CONDITIONS


def test_study_is_not_changed():
    given = study(gap=("gap", [1e-4, 1e-3]))
    before = given.copy(deep=True)
    evaluate(given)
    xr.testing.assert_identical(given, before)


@pytest.mark.parametrize("model", [m for m, x in bondcell.MODELS.items() if not x.is_reference])
def test_every_model_gives_finite_values_at_the_base_case(model):
    out = evaluate(study(), model=model)
    assert np.isfinite(float(out.stiffness))
    assert Status(int(out.status)).has_value


def test_chunks_change_no_value(monkeypatch):
    swept = study(
        gap=("gap", np.geomspace(1e-6, 1e-1, 13)), young_m=("ratio", np.geomspace(1, 1e9, 11))
    )
    whole = evaluate(swept)
    for limit in (1, 7, 20):
        monkeypatch.setattr(MODULE, "CHUNK", limit)
        pieces = evaluate(swept)
        xr.testing.assert_identical(pieces.drop_vars("seconds"), whole.drop_vars("seconds"))


@pytest.mark.parametrize("shape", [(), (1,), (7,), (3, 4), (2, 3, 5), (5, 1, 2)])
@pytest.mark.parametrize("limit", [1, 2, 6, 100])
def test_blocks_cover_every_point_once(shape, limit):
    seen = np.zeros(shape, dtype=int)
    for block in blocks(shape, limit):
        seen[block] += 1
        assert seen[block].size <= limit
    assert np.all(seen == 1)


def test_divergence_and_range_are_flagged(fake_model):
    out = evaluate(study(poisson_m=("nu", [0.0, 0.5]), gap=("gap", [5e-4, 5e-3])), "fake")
    ok, outside, diverges = Status.ok, Status.outside_valid_range, Status.diverges
    assert out.status.transpose("nu", "gap").values.tolist() == [
        [ok, outside],
        [diverges, diverges],
    ]
    assert np.isfinite(out.stiffness.isel(nu=0)).all()
    assert np.isnan(out.stiffness.isel(nu=1)).all()


def test_options_reach_the_model(fake_model):
    single, double = evaluate(study(), "fake"), evaluate(study(), "fake", factor=2.0)
    assert float(double.stiffness) == 2 * float(single.stiffness)
    assert double.attrs["factor"] == 2.0


def test_reference_gets_points_of_one_geometry_at_a_time(fake_fem):
    swept = study(gap=("gap", [1e-4, 5e-4]), young_m=("young", [1e6, 2e6, 3e6]))
    out = evaluate(swept, "fe", bc="clamped", tolerance=1e-4)
    assert out.stiffness.sel(young=1).values == pytest.approx([2e6 * 7.5e-3] * 2)
    assert out.attrs["bc"] == "clamped"
    assert (out.error_estimate == 1e-4).all()
    assert (out.dof == 402).all()


@pytest.mark.parametrize(
    ("load", "unit"),
    [("normal", "N m-1"), ("shear", "N m-1"), ("torsion", "N m rad-1"), ("bending", "N m rad-1")],
)
def test_reference_covers_every_load(fake_fem, load, unit):
    out = evaluate(study(gap=("gap", [1e-4, 5e-4])), "fe", load=load)
    assert out.stiffness.attrs["units"] == unit
    assert load in out.stiffness.attrs["long_name"]
    assert out.order.values.tolist() == [4, 4]
    assert out.way.attrs["flag_meanings"].split()[int(out.way[0])] == "direct"
    assert (out.reduction_error < out.error_estimate).all()
    assert ("coupling" in out) == (load == "bending")
    if load == "bending":
        assert out.coupling.values.tolist() == [-3.0, -3.0]
        assert out.coupling.attrs["units"] == "N rad-1"


def test_ways_are_those_of_the_finite_elements():
    from bondcell.fem.sweep import Way

    assert list(WAYS[: len(Way)]) == [way.name for way in Way]


def test_models_know_nothing_of_orders_and_ways():
    assert not {*DETAILS} & {*evaluate(study()).data_vars}


def test_bending_for_real():
    """The coupling of a symmetric pair is its shear stiffness times half its length."""
    shear, bending = (evaluate(study(), "fe", load=load) for load in ("shear", "bending"))
    half_length = 7.5e-3 + 2.5e-4
    assert abs(float(bending.coupling)) == pytest.approx(float(shear.stiffness) * half_length, 1e-5)
    assert {int(out.status) for out in (shear, bending)} == {Status.ok}


def test_failed_geometries_are_flagged_and_the_rest_goes_on(fake_fem):
    swept = study(gap=("gap", [1e-4, 2e-4, 3e-4, 4e-4]), young_m=("young", [1e6, 2e6]))
    with pytest.warns(RuntimeWarning, match="gap=0.000") as warned:
        out = evaluate(swept, "fe")
    solver, mesh = Status.solver_failed, Status.mesh_failed
    assert out.status.isel(young=0).values.tolist() == [0, solver, mesh, 0]
    assert np.isnan(out.stiffness.isel(gap=[1, 2])).all()
    assert np.isfinite(out.stiffness.isel(gap=[0, 3])).all()
    assert len(warned) == 2


def test_progress_counts_points():
    cell = Cell.from_values(**BASE | POISSON | {"gap": [1e-4, 5e-4, 1e-4]})
    lines = []
    solve_points(cell.ravel(), fake_reference, progress=lambda *line: lines.append(line))
    assert lines == [(2, 3), (3, 3)]


def test_groups_cover_every_point_once():
    gap = np.array([3.0, 1.0, 2.0, 1.0, 3.0])
    cell = Cell.from_values(**BASE | POISSON | {"gap": gap}).ravel()
    groups = list(geometry_groups(cell))
    assert [gap[group[0]] for group in groups] == [3.0, 1.0, 2.0]
    assert sorted(np.concatenate(groups).tolist()) == list(range(5))


def violations(error):
    return [(v.field, v.value) for v in error.value.violations]


@pytest.mark.parametrize(
    ("arguments", "kind", "expected"),
    [
        ({"model": "fem"}, bondcell.UnknownModel, [("model", "fem")]),
        ({"model": None}, bondcell.UnknownModel, [("model", None)]),
        ({"load": "twist"}, bondcell.UnsupportedLoad, [("load", "twist")]),
        ({"bc": "roller"}, bondcell.InputError, [("bc", "roller")]),
        ({"a": 1, "b": 2}, bondcell.InputError, [("a", 1), ("b", 2)]),
        ({"model": "fe", "bc": "glued"}, bondcell.UnsupportedLoad, [("bc", "glued")]),
        ({"model": "fe", "load": "twist"}, bondcell.UnsupportedLoad, [("load", "twist")]),
        ({"load": "shear"}, bondcell.UnsupportedLoad, [("load", "shear")]),
        (
            {"model": "fe", "load": "shear", "bc": "clamped"},
            bondcell.UnsupportedLoad,
            [("bc", "clamped")],
        ),
        ({"model": "fe", "tolerance": -1.0}, bondcell.InputError, [("tolerance", -1.0)]),
        ({"model": "fe", "tolerance": "low"}, bondcell.InputError, [("tolerance", "low")]),
        ({"model": "fe", "tolerance": 0.5}, bondcell.InputError, [("tolerance", 0.5)]),
        ({"model": "fe", "bc": ["roller"]}, bondcell.UnsupportedLoad, [("bc", ["roller"])]),
    ],
)
def test_wrong_arguments_are_named(arguments, kind, expected):
    with pytest.raises(kind) as error:
        evaluate(study(), **arguments)
    assert violations(error) == expected


@pytest.mark.parametrize(
    ("changes", "expected"),
    [
        ({"gap": 0.0, "poisson_m": 0.6}, [("gap", 0.0), ("poisson_m", 0.6)]),
        ({"young_m": -1.0}, [("young_m", -1.0)]),
        ({"gap": "0.5 mm"}, None),
        ({"gap": ("gap", [1e-4, np.nan])}, None),
        ({"stiffness": 3.0}, [("stiffness", 3.0)]),
    ],
)
def test_wrong_values_are_named_all_at_once(changes, expected):
    with pytest.raises(bondcell.InputError) as error:
        evaluate(study(**changes))
    found = violations(error)
    assert [field for field, _ in found] == list(changes)
    if expected:
        assert [(field, float(value)) for field, value in found] == expected


def test_load_of_no_model_names_all_loads():
    with pytest.raises(bondcell.UnsupportedLoad, match=r"one of normal, shear, torsion, bending$"):
        evaluate(study(), model="fsi", load="twist")
    with pytest.raises(bondcell.UnsupportedLoad, match=r"one of normal for model 'fsi'$"):
        evaluate(study(), model="fsi", load="shear")


def test_missing_input_is_named():
    with pytest.raises(bondcell.InputError, match="gap"):
        evaluate(study().drop_vars("gap"))


def test_empty_axis_is_refused():
    with pytest.raises(bondcell.InputError, match="at least one"):
        evaluate(study(gap=("gap", np.empty(0))))


def test_other_units_are_refused():
    swept = study(gap=("gap", [0.5], {"units": "mm"}))
    with pytest.raises(bondcell.InputError, match=r"gap\.units = 'mm'"):
        evaluate(swept)


def test_not_a_dataset():
    with pytest.raises(bondcell.InputError, match=r"xarray\.Dataset"):
        evaluate({"gap": 1.0})
