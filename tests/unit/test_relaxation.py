"""`relaxation`, `relaxation_series` and `dynamic_stiffness`: labels, ends, flags, errors."""

import numpy as np
import pytest
import xarray as xr

import bondcell
from bondcell import Prony, Status, UnsupportedLoad

MODELS = [name for name, model in bondcell.MODELS.items() if not model.is_reference]
PRONY = Prony([0.5, 0.3, 0.15], [1e-3, 1.0, 1e3])


def study(**changes):
    values = {
        "radius_i": 7.5e-3,
        "young_i": 3e10,
        "poisson_i": 0.25,
        "young_m": 1.4e6,
        "poisson_m": 0.46,
    }
    return xr.Dataset(values | changes, coords={"gap": [1e-4, 5e-4]})


@pytest.mark.parametrize("convention", ["constant_bulk", "constant_poisson"])
@pytest.mark.parametrize("model", MODELS)
def test_both_ends_are_elastic(model, convention):
    curve = bondcell.relaxation(study(), PRONY, [0.0, 1.0, np.inf], model, convention)
    assert curve.stiffness.dims == ("time", "gap")
    start = bondcell.evaluate(study(), model)
    share = float(PRONY.shear.equilibrium)
    young, nu = 1.4e6, 0.46
    shear, bulk = young / (2 * (1 + nu)) * share, young / (3 * (1 - 2 * nu))
    final = {"young_m": young * share}
    if convention == "constant_bulk":
        final = {
            "young_m": 9 * bulk * shear / (3 * bulk + shear),
            "poisson_m": (3 * bulk - 2 * shear) / (2 * (3 * bulk + shear)),
        }
    end = bondcell.evaluate(study(**final), model)
    for k, elastic in ((0, start), (2, end)):
        error = np.abs(curve.stiffness.isel(time=k) / elastic.stiffness - 1)
        assert (error <= curve.error_estimate + 1e-12).all()
        np.testing.assert_array_equal(curve.status.isel(time=k), elastic.status)
    assert (np.diff(curve.stiffness, axis=0) < 0).all()


def test_series_and_curve_agree():
    times = np.geomspace(1e-5, 1e5, 7)
    for model in ("fsi", "generatrix"):
        series = bondcell.relaxation_series(study(), PRONY, model)
        curve = bondcell.relaxation(study(), PRONY, times, model)
        t = xr.DataArray(times, dims="time")
        total = series.K_inf + (series.K_k * np.exp(-t / series.tau_k)).sum("term")
        np.testing.assert_allclose(total.transpose("time", "gap"), curve.stiffness, rtol=1e-13)
        assert series.K_inf.attrs["units"] == "N m-1"
        assert series.tau_k.attrs["units"] == "s"
        assert series.attrs["convention"] == "constant_bulk"
        assert series.attrs["relative_to"] == "instantaneous"


def test_dynamic_stiffness_is_the_transform():
    out = bondcell.dynamic_stiffness(study(), PRONY, [0.0, 0.7, 1e9])
    series = bondcell.relaxation_series(study(), PRONY)
    x = 0.7j * series.tau_k
    true = series.K_inf + (series.K_k * x / (1 + x)).sum("term")
    np.testing.assert_allclose(out.storage.isel(frequency=1), true.real, rtol=1e-13)
    np.testing.assert_allclose(out.loss.isel(frequency=1), true.imag, rtol=1e-13)
    np.testing.assert_allclose(out.storage.isel(frequency=0), series.K_inf, rtol=1e-14)
    assert (out.loss_factor.isel(frequency=1) > 0).all()
    assert out.frequency.attrs["units"] == "rad s-1"


def test_two_chains_relax_alike_or_not():
    alike = Prony([0.5], [1.0], bulk_weights=[0.5], bulk_times=[1.0])
    separate = bondcell.relaxation(study(), alike, [0.0, 1.0, 5.0], "fsi")
    constant = bondcell.relaxation(
        study(), Prony([0.5], [1.0]), [0, 1, 5], "fsi", "constant_poisson"
    )
    assert separate.attrs["convention"] == "separate"
    np.testing.assert_allclose(separate.stiffness, constant.stiffness, rtol=1e-13)


def test_absolute_moduli_stand_for_the_study():
    prony = Prony([0.8e6, 0.5e6], [1.0, 10.0], "absolute", long_term=0.1e6, modulus="young")
    bare = study().drop_vars("young_m")
    out = bondcell.relaxation(bare, prony, [0.0, 3.0], "fsi", "constant_poisson")
    relative = Prony([0.8 / 1.4, 0.5 / 1.4], [1.0, 10.0])
    same = bondcell.relaxation(study(), relative, [0.0, 3.0], "fsi", "constant_poisson")
    np.testing.assert_allclose(out.stiffness, same.stiffness, rtol=1e-12)
    with pytest.raises(bondcell.PronyError, match="young_m"):
        bondcell.relaxation(study(young_m=2e6), prony, 0.0, "fsi", "constant_poisson")
    with pytest.raises(bondcell.PronyError, match="convention"):
        bondcell.relaxation(bare, prony, 0.0, "fsi", "constant_bulk")


def test_absolute_shear_and_bulk_moduli_fix_both_inputs():
    prony = Prony(
        [3e5], [1.0], "absolute", long_term=1e5, bulk_weights=[1e6], bulk_times=[2.0],
        bulk_long_term=4e6,
    )  # fmt: skip
    out = bondcell.relaxation(study().drop_vars(["young_m", "poisson_m"]), prony, [0.0], "fsi")
    shear, bulk = 4e5, 5e6
    young = 9 * bulk * shear / (3 * bulk + shear)
    true = bondcell.evaluate(study(young_m=young), "fsi").stiffness
    np.testing.assert_allclose(out.stiffness[0], true, rtol=1e-13)


def test_a_model_can_leave_its_range_as_it_relaxes():
    """Cementation is for poisson_m up to 0.3; shear relaxation takes 0.2 beyond it."""
    out = bondcell.relaxation(study(poisson_m=0.2), PRONY, [0.0, np.inf], "cementation")
    assert (out.status.isel(time=0) == Status.ok).all()
    assert (out.status.isel(time=1) == Status.outside_valid_range).all()
    series = bondcell.relaxation_series(study(poisson_m=0.2), PRONY, "cementation")
    assert (series.status == Status.outside_valid_range).all()


def test_points_without_a_value_are_flagged():
    out = bondcell.relaxation(study(poisson_m=0.5), PRONY, [0.0, 1.0], "cementation")
    assert np.isnan(out.stiffness).all()
    assert (out.status == Status.diverges).all()
    beyond = bondcell.relaxation(study(radius_j=1e-3), PRONY, [0.0], "surrogate")
    assert np.isnan(beyond.stiffness).all()
    assert (beyond.status == Status.not_computed).all()


def test_errors_name_field_and_value():
    with pytest.raises(bondcell.InputError, match="prony = 'list'"):
        bondcell.relaxation(study(), [0.5], [0.0])
    with pytest.raises(bondcell.InputError, match=r"time = -1\.0.*inf\]"):
        bondcell.relaxation(study(), PRONY, [0.0, -1.0])
    with pytest.raises(bondcell.InputError, match="frequency = inf"):
        bondcell.dynamic_stiffness(study(), PRONY, [np.inf])
    with pytest.raises(bondcell.InputError, match="time = 'now'"):
        bondcell.relaxation(study(), PRONY, "now")
    with pytest.raises(bondcell.InputError, match=r"convention = \['constant_bulk'\]"):
        bondcell.relaxation(study(), PRONY, [0.0], convention=["constant_bulk"])
    with pytest.raises(bondcell.InputError, match=r"study = 'time'.*\n.*study = 'term'"):
        bondcell.relaxation_series(study().expand_dims(time=[1], term=[2]), PRONY)
    with pytest.raises(bondcell.InputError, match="convention = 'plastic'"):
        bondcell.relaxation(study(), PRONY, [0.0], convention="plastic")
    bulk = Prony([0.5], [1.0], bulk_weights=[0.1], bulk_times=[1.0])
    with pytest.raises(bondcell.InputError, match="separate with a bulk series"):
        bondcell.relaxation(study(), bulk, [0.0], convention="constant_bulk")
    with pytest.raises(bondcell.InputError, match=r"poisson_m = 0\.5"):
        bondcell.relaxation(study(poisson_m=0.5), bulk, [0.0])
    with pytest.raises(UnsupportedLoad, match="surrogate"):
        bondcell.relaxation(study(), bulk, [0.0], "surrogate")


def test_reference_relaxes_between_its_elastic_ends():
    one = study().isel(gap=[1])
    curve = bondcell.relaxation(one, PRONY, [0.0, 1.0, np.inf], "fe")
    assert (curve.status == Status.ok).all()
    assert (curve.error_estimate <= 1e-6).all()
    start = bondcell.evaluate(one, "fe").stiffness
    assert abs(curve.stiffness[0] / start - 1).item() < 2e-6
    shortcut = start.item() * PRONY.relaxation_modulus([1.0])[0]
    assert curve.stiffness[1].item() > 1.05 * shortcut
    series = bondcell.relaxation_series(one, PRONY, "fe")
    assert (series.K_k > 0).all()
    np.testing.assert_allclose(series.K_inf, curve.stiffness[2], rtol=1e-14)


@pytest.mark.parametrize(
    "table",
    [
        "g,k,tau\n0.5,0.2,1e-3\n0.3,0.1,1\n0.15,0,1e3\n",
        "table,weight,tau\nshear,0.5,1e-3\nshear,0.45,10\nbulk,0.3,5\n",
    ],
)
def test_reference_takes_tables_with_bulk_terms(table, tmp_path):
    path = tmp_path / "table.csv"
    path.write_text(table)
    one, prony = study().isel(gap=[1]), bondcell.read_prony(path)
    curve = bondcell.relaxation(one, prony, [0.0, 1.0, np.inf], "fe")
    assert curve.attrs["convention"] == "separate"
    assert (curve.status == Status.ok).all()
    assert (curve.error_estimate <= 1e-6).all()
    share, bulk_share = float(prony.shear.equilibrium), float(prony.bulk.equilibrium)
    shear, bulk = 1.4e6 / (2 * 1.46) * share, 1.4e6 / (3 * 0.08) * bulk_share
    young, nu = (
        9 * bulk * shear / (3 * bulk + shear),
        (3 * bulk - 2 * shear) / (2 * (3 * bulk + shear)),
    )
    for k, elastic in ((0, study()), (2, study(young_m=young, poisson_m=nu))):
        value = bondcell.evaluate(elastic.isel(gap=[1]), "fe").stiffness
        np.testing.assert_allclose(curve.stiffness[k], value, rtol=2e-6)


def test_a_point_that_fails_costs_itself_only(monkeypatch):
    from bondcell.fem import relaxing_reference

    relax = relaxing_reference.relax

    def fails_at_narrow_gaps(matrix, *options):
        if matrix.cell.gap[0] < 2e-4:
            raise np.linalg.LinAlgError("singular")
        return relax(matrix, *options)

    monkeypatch.setattr(relaxing_reference, "relax", fails_at_narrow_gaps)
    with pytest.warns(RuntimeWarning, match="solver_failed: point 0: LinAlgError: singular"):
        out = bondcell.relaxation(study(), PRONY, [0.0, 1.0], "fe")
    assert (out.status.isel(gap=0) == Status.solver_failed).all()
    assert np.isnan(out.stiffness.isel(gap=0)).all()
    assert np.isfinite(out.stiffness.isel(gap=1)).all()


def test_options_of_the_reference_are_checked():
    with pytest.raises(bondcell.InputError, match="tolerance"):
        bondcell.relaxation(study(), PRONY, [0.0], "fe", tolerance=-1.0)
    with pytest.raises(UnsupportedLoad, match="bc"):
        bondcell.relaxation(study(), PRONY, [0.0], "fe", bc="glued")


def test_import_is_light():
    import subprocess
    import sys

    code = (
        "import bondcell, sys; bondcell.evaluate; "
        "assert not any(m.startswith('bondcell.prony') for m in sys.modules); "
        "bondcell.relaxation; assert 'skfem' not in sys.modules"
    )
    subprocess.run([sys.executable, "-c", code], check=True)


@pytest.mark.parametrize("share", [0.9, 0.99, 0.999])
def test_a_fit_knows_its_error_however_deep_the_matrix_relaxes(share):
    prony = Prony(weights=[share], times=[1.0], relative_to="instantaneous")
    time = np.linspace(0, 12, 40)
    fitted, reference = (
        bondcell.relaxation(study(poisson_m=0.3), prony, time, model=model)
        for model in ("surrogate", "fe")
    )
    error = np.abs(fitted.stiffness / reference.stiffness - 1)
    assert (error <= fitted.error_estimate + reference.error_estimate).all()


@pytest.mark.parametrize(
    ("cell", "prony"),
    [
        (
            {"gap": 1.15e-5, "young_i": 2.86e7, "poisson_m": 0.296},
            Prony([0.8635], [276.0]),
        ),
        (
            {"gap": 1.64e-5, "young_i": 1.8e10, "poisson_m": 0.177},
            Prony([0.435, 0.226, 0.3014], [24.4, 1.4, 0.0115]),
        ),
    ],
)
def test_a_fit_counts_what_the_model_misses_later(cell, prony):
    """The surrogate errs most at the Poisson's ratio that relaxation leads to, not at the first."""
    one = study().isel(gap=0, drop=True).assign(cell)
    time = np.geomspace(1e-4, 1e5, 60)
    fitted = bondcell.relaxation(one, prony, time, model="surrogate")
    reference = bondcell.relaxation(one, prony, time, model="fe")
    error = np.abs(fitted.stiffness / reference.stiffness - 1)
    assert (error <= fitted.error_estimate + reference.error_estimate).all()
    assert (fitted.error_estimate < 5e-4).all()
