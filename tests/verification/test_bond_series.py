"""Series of the analytic models: both ends, the Laplace variable, and 50 digits by quadrature."""

from dataclasses import replace

import mpmath as mp
import numpy as np
import pytest

from bondcell.cell import Cell
from bondcell.models import MODELS
from bondcell.prony.bank import Bank
from bondcell.prony.bond_series import OWN_FACTOR, bond_series
from bondcell.prony.conventions import Relaxing
from bondcell.prony.graded_rule import graded_rule
from bondcell.prony.model_banks import BANKS
from bondcell.prony.prony import Prony

WEIGHTS = np.array([0.31288, 0.20212, 0.21377, 0.14498, 0.06803, 0.02679])
TIMES = 10.0 ** np.arange(-5, 1)
CASES = {
    "constant_bulk": Prony(WEIGHTS, TIMES),
    "constant_poisson": Prony(WEIGHTS, TIMES),
    "separate": Prony(WEIGHTS, TIMES, bulk_weights=WEIGHTS[:3] / 2, bulk_times=TIMES[1:4] * 2),
}


def cells(kind):
    values = {
        "radius_i": 7.5e-3,
        "gap": 7.5e-3 * np.array([1e-5, 1e-3, 1 / 15, 1.0]),
        "young_i": 3e10 * np.array([1.0, 1e-4, 1e-2, np.inf]),
        "young_m": 1.4e6,
        "poisson_i": 0.25,
        "poisson_m": np.array([0.46, 0.2, 0.0, 0.499]),
    }
    if kind == "unequal":
        values |= {"radius_j": 3e-3, "young_j": 7e8, "cylinder_radius": 9e-3}
    if kind == "soft":
        values["young_i"] = 1e3
    return Cell.from_values(**values).ravel()


@pytest.mark.parametrize("kind", ["equal", "unequal", "soft"])
@pytest.mark.parametrize("convention", CASES)
@pytest.mark.parametrize("name", BANKS)
def test_ends_and_real_laplace_variable(name, convention, kind):
    """Elastic formulas at the moduli of any real s give s times the transform of K(t)."""
    matrix = Relaxing.of(cells(kind), CASES[convention], convention)
    series, error = bond_series(MODELS[name], "normal", matrix)
    assert (error <= 1e-12).all()
    assert (series.strengths >= 0).all()
    prony = matrix.prony
    at = np.array([0.0, 1e-2, 1.0, 1e2, 1e4, 1e7, np.inf])
    shear = prony.shear.transform(at)
    bulk = prony.bulk.transform(at) if prony.bulk else np.ones_like(at)
    got = series.transform(at)
    # The tractions of the cementation theory come from a matrix that is ill-conditioned itself.
    tolerance = 1e-8 if name == "cementation" else 2e-13
    for k in range(at.size):
        cell = matrix.at(shear[k], bulk[k])
        true = MODELS[name].loads["normal"](cell).stiffness
        np.testing.assert_allclose(got[k], true, rtol=tolerance)


@pytest.mark.parametrize("name", ["fsi", "general", "generatrix", "slices", "parallel_bond"])
def test_fluid_ends_in_nothing(name):
    prony = Prony(WEIGHTS / WEIGHTS.sum(), TIMES)
    series, _ = bond_series(MODELS[name], "normal", Relaxing.of(cells("equal"), prony, None))
    assert (series.equilibrium == 0).all()


def test_confined_layer_of_a_fluid_keeps_its_bulk_modulus():
    prony = Prony(WEIGHTS / WEIGHTS.sum(), TIMES)
    matrix = Relaxing.of(cells("equal"), prony, "constant_bulk")
    series, _ = bond_series(MODELS["cementation"], "normal", matrix)
    stiff = replace(matrix.cell, young_m=1 / matrix.bulk_compliance, poisson_m=np.zeros(4))
    true = MODELS["cementation"].loads["normal"](stiff).stiffness
    np.testing.assert_allclose(series.equilibrium, true, rtol=1e-8)


def test_incompressible_matrix():
    cell = replace(cells("equal"), poisson_m=np.full(4, 0.5))
    one, _ = bond_series(MODELS["fsi"], "normal", Relaxing.of(cell, CASES["constant_bulk"], None))
    other, _ = bond_series(
        MODELS["fsi"], "normal", Relaxing.of(cell, CASES["constant_bulk"], "constant_poisson")
    )
    np.testing.assert_allclose(one.times, other.times, rtol=1e-13)
    thin, _ = bond_series(
        MODELS["cementation"], "normal", Relaxing.of(cell, CASES["constant_bulk"], None)
    )
    assert np.isnan(thin.instantaneous).all()


def test_generatrix_over_time_in_fifty_digits():
    """K(t) = integral over lines of each line's own single Maxwell element, by mpmath."""
    prony = Prony([0.999], [2.0])
    cell = cells("equal").take([1])
    matrix = Relaxing.of(cell, prony, "constant_poisson")
    series, _ = bond_series(MODELS["generatrix"], "normal", matrix)
    with mp.workdps(30):
        R, gap = mp.mpf(float(cell.radius_i[0])), mp.mpf(float(cell.gap[0]))
        E, E_p = mp.mpf(1.4e6), mp.mpf(float(cell.young_i[0]))
        end = 1 - mp.mpf(0.999)

        def line(v, t):
            """A spring S before a chain c (end, 1 - end): one term again."""
            S, c = E_p / (2 * v) if v else mp.inf, E / (2 * (R - v) + gap)
            if v == 0:
                return c * (end + (1 - end) * mp.exp(-t / 2))
            first, last = S * c / (S + c), S * c * end / (S + c * end)
            return last + (first - last) * mp.exp(-t * (S + c * end) / (2 * (S + c)))

        for t in (0.0, 1.0, 10.0, 100.0):
            nodes = [0, R * 0.9, R - 10 * gap, R - gap, R]
            true = mp.quad(lambda v, t=t: 2 * mp.pi * v * line(v, t), nodes)
            assert abs(series.relaxation([t])[0, 0] / float(true) - 1) < 1e-12


def test_gauss_quadrature_leaves_few_pairs():
    bank = BANKS["generatrix"].bank(cells("equal").take([2]))
    modulus = np.array([1.4e6])
    few = bank.squeezed(modulus)
    assert few.strength.shape[1] < 10 < bank.strength.shape[1]
    for share in (1.0, 1e-3, 1e-9):
        np.testing.assert_allclose(
            few.stiffness(modulus * share), bank.stiffness(modulus * share), rtol=1e-14
        )
    alone = Bank.of(np.ones((1, 30)), np.full((1, 30), 1e-7)).squeezed(modulus)
    np.testing.assert_allclose(alone.stiffness(modulus), 30 * 1.4e6 / 1.14, rtol=1e-14)


def test_graded_rule_follows_both_ends():
    length, near = np.array([1.0, 2.0]), np.array([1e-9, 1e-3])
    v, rest, w = graded_rule(length, near, near)
    np.testing.assert_allclose(v + rest, np.broadcast_to(length[:, None], v.shape), rtol=1e-14)
    integral = (w / (near[:, None] + v) / (near[:, None] + rest)).sum(axis=1)
    exact = 2 * np.log1p(length / near) / (length + 2 * near)
    np.testing.assert_allclose(integral, exact, rtol=1e-13)


@pytest.mark.parametrize("load", ["normal", "shear", "bending"])
def test_fitted_series_meets_the_ends(load):
    cell = cells("equal").take([1, 2])
    matrix = Relaxing.of(cell, CASES["constant_bulk"], "constant_bulk")
    series, error = bond_series(MODELS["surrogate"], load, matrix)
    formula = MODELS["surrogate"].loads[load]
    assert (error - OWN_FACTOR * formula(cell).relative_error < 1e-3).all()
    for share, value in ((1.0, series.instantaneous), (None, series.equilibrium)):
        state = matrix.at(float(matrix.prony.shear.equilibrium) if share is None else share)
        assert (np.abs(value / formula(state).stiffness - 1) <= error).all()


def test_fit_of_a_model_without_a_value_is_missing():
    cell = cells("equal")
    matrix = Relaxing.of(cell, CASES["constant_bulk"], "constant_bulk")
    series, error = bond_series(MODELS["surrogate"], "normal", matrix)
    assert np.isnan(series.instantaneous[0])
    assert np.isnan(error[0])


def test_long_term_moduli_give_the_same_cells():
    """The same material said by its moduli at either end."""
    cell = cells("equal")
    start = Relaxing.of(cell, CASES["constant_bulk"], "constant_bulk")
    end = start.at(float(start.prony.shear.equilibrium))
    relative = Prony(WEIGHTS / float(start.prony.shear.equilibrium), TIMES, "long_term")
    back = Relaxing.of(end, relative, "constant_bulk")
    np.testing.assert_allclose(back.cell.young_m, cell.young_m, rtol=1e-12)
    np.testing.assert_allclose(back.cell.poisson_m, cell.poisson_m, rtol=1e-11, atol=1e-12)
