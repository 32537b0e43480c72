"""The reference's exact series against time stepping, Laplace inversion and the wrong shortcut."""

import numpy as np
import pytest

from bondcell.cell import Cell
from bondcell.fem import relaxing_reference as reference
from bondcell.fem.full_system import full_systems
from bondcell.fem.laplace_inversion import invert_reference, stiffness_at
from bondcell.fem.materials import Materials
from bondcell.fem.one_modulus import reduce_one
from bondcell.fem.structured import CellSolver, find_load, geometry_of
from bondcell.fem.time_stepping import graded_times, operators, step_through
from bondcell.models import MODELS
from bondcell.prony.bond_series import bond_series
from bondcell.prony.conventions import Relaxing
from bondcell.prony.positive_fit import positive_fit
from bondcell.prony.prony import Prony
from bondcell.status import Status

ORDER = 4
PRONY = Prony([0.5, 0.3, 0.15], [1e-3, 1.0, 1e3])


def cell_of(**changes):
    values = {
        "radius_i": 7.5e-3,
        "gap": 5e-4,
        "young_i": 3e10,
        "young_m": 1.4e6,
        "poisson_i": 0.25,
        "poisson_m": 0.46,
    }
    return Cell.from_values(**(values | changes)).ravel()


def exact(matrix, load="normal", bc="roller", order=ORDER):
    """The exact series of one discretisation, and its reduced model."""
    half = reference._is_half(matrix.cell)
    solver = CellSolver(geometry_of(matrix.cell), find_load(load, bc), half, order)

    def stiffness(share):
        return solver.stiffness(Materials.of(matrix.at(share)).constants(0))

    bears = reference._carries_pressure(matrix, load, bc)
    model = reduce_one(stiffness, 1e-3, bears, reference.REDUCTION)
    return model.series(matrix.prony.shear), model


CASES = [
    ("constant_bulk", "normal", "roller", {}),
    ("constant_poisson", "normal", "roller", {"young_i": 1.4e7}),
    ("constant_bulk", "normal", "confined", {"gap": 1e-4, "poisson_m": 0.3}),
    ("constant_bulk", "normal", "clamped", {"radius_j": 4e-3, "young_j": 1e9}),
    ("constant_bulk", "torsion", "roller", {}),
    ("constant_bulk", "shear", "roller", {}),
    pytest.param("constant_bulk", "bending", "roller", {}, marks=pytest.mark.slow),
    ("constant_bulk", "normal", "roller", {"young_i": np.inf}),
]


@pytest.mark.parametrize(("convention", "load", "bc", "changes"), CASES)
def test_series_holds_for_complex_moduli(convention, load, bc, changes):
    """The reduced model is the full one at moduli off the axis that it was fitted on."""
    matrix = Relaxing.of(cell_of(**changes), PRONY, convention)
    series, model = exact(matrix, load, bc)
    assert model.missed <= 1e-9
    systems = full_systems(matrix.cell, ORDER, load, bc)
    parts = [(system, *operators(matrix, system)) for system in systems]
    for share, bound in ((1.0, 1e-9), (0.3, 1e-9), (0.05 + 0.01j, 1e-9), (0.3 + 0.4j, 1e-7)):
        true = sum(stiffness_at(s, own, [(share, r) for _, r in soft]) for s, own, soft in parts)
        assert abs(model.stiffness(np.array([share]))[0] / true - 1) < bound
    times = np.array([1e-4, 30.0])[: 1 if changes.get("radius_j") else 2]
    inverted = invert_reference(matrix, systems, times)
    np.testing.assert_allclose(series.relaxation(times), inverted, rtol=1e-9)


@pytest.mark.parametrize("convention", ["constant_bulk", "constant_poisson"])
def test_time_stepping_converges_at_second_order(convention):
    matrix = Relaxing.of(cell_of(young_i=3e8, poisson_m=0.4), PRONY, convention)
    series, _ = exact(matrix)
    systems = full_systems(matrix.cell, ORDER)
    wanted = np.geomspace(1e-3, 1e3, 4)
    errors = []
    for steps in (4, 8, 16):
        times = graded_times(wanted, steps, first=1e-4)
        values = step_through(matrix, systems, times)
        np.testing.assert_allclose(values[0], series.instantaneous, rtol=1e-8)
        at = np.searchsorted(times, wanted * (1 - 1e-12))
        errors.append(np.abs(values[1 + at] / series.relaxation(wanted) - 1).max())
    rates = np.log2(np.array(errors[:-1]) / errors[1:])
    assert (rates > 1.7).all()
    assert errors[-1] < 2e-4


def test_the_shortcut_is_wrong_with_a_constant_bulk_modulus():
    """K(0) g(t): a nearly incompressible film relaxes later than its shear modulus."""
    matrix = Relaxing.of(cell_of(), PRONY, "constant_bulk")
    series, _ = exact(matrix)
    times = np.geomspace(1e-5, 1e5, 40)
    curve = series.relaxation(times)
    shortcut = series.instantaneous * PRONY.relaxation_modulus(times)
    assert np.abs(shortcut / curve - 1).max() > 0.2
    alike = Relaxing.of(cell_of(young_i=3e13), PRONY, "constant_poisson")
    series, _ = exact(alike)
    curve = series.relaxation(times)
    shortcut = series.instantaneous * PRONY.relaxation_modulus(times)
    assert np.abs(shortcut / curve - 1).max() < 1e-5


def test_fluids_end_in_nothing_or_in_their_pressure():
    fluid = Prony([0.6, 0.4], [1.0, 100.0])
    free = reference.relax(Relaxing.of(cell_of(), fluid, "constant_bulk"))
    assert free.status == Status.ok
    assert free.series.equilibrium == 0.0
    held = reference.relax(Relaxing.of(cell_of(), fluid, "constant_bulk"), bc="confined")
    stiff = Relaxing.of(cell_of(), Prony([1 - 1e-5], [1.0]), "constant_bulk")
    nearly = reference.relax(stiff, bc="confined").series.equilibrium
    assert held.series.equilibrium == pytest.approx(float(nearly), rel=1e-3)


def test_rigid_incompressible_confined_cell_diverges():
    cell = cell_of(young_i=np.inf, poisson_m=0.5)
    answer = reference.relax(Relaxing.of(cell, PRONY, "constant_bulk"), bc="confined")
    assert answer.status == Status.diverges
    assert np.isnan(answer.series.instantaneous)


def test_positive_fit_finds_the_terms():
    x = np.geomspace(1e-4, 3, 15)
    strength, softness = np.array([1.0, 4.0, 0.3]), np.array([0.1, 5.0, 200.0])

    def stiffness(x):
        return 7.0 + (strength * x[:, None] / (1 + softness * x[:, None])).sum(axis=1)

    fit = positive_fit(x, stiffness(x), has_constant=True)
    assert fit.constant == pytest.approx(7.0, rel=1e-9)
    for a in softness:
        assert np.abs(fit.softness / a - 1).min() < 1e-5
    between = np.geomspace(1e-6, 3, 50)
    np.testing.assert_allclose(fit(between), stiffness(between), rtol=1e-10)
    linear = positive_fit(x, 2 * x, has_constant=False)
    assert linear.bare == pytest.approx(2.0, rel=1e-14)
    assert linear.strength.size == 0


@pytest.mark.parametrize("convention", ["constant_bulk", "constant_poisson"])
def test_fitted_surrogate_follows_the_reference(convention):
    """What the fit of an interpolant states as its error covers its K(t)."""
    matrix = Relaxing.of(cell_of(), PRONY, convention)
    fitted, error = bond_series(MODELS["surrogate"], "normal", matrix)
    exact_series = reference.relax(matrix).series
    times = np.geomspace(1e-5, 1e5, 60)
    difference = fitted.relaxation(times)[:, 0] / exact_series.relaxation(times) - 1
    model_error = MODELS["surrogate"].loads["normal"](matrix.cell).relative_error
    assert np.abs(difference).max() <= error[0] + np.max(model_error)
