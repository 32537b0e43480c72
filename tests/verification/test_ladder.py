"""The ladder of orders: what it estimates, where it lets particles lag, who climbs for whom."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from bondcell.cell import Cell
from bondcell.fem.ladder import estimate
from bondcell.fem.materials import Materials
from bondcell.fem.particle_lag import LARGEST_LAG, particle_lag
from bondcell.fem.reference import STIFF_CUT, STIFF_RATIO, WIDE_CUT, solve
from bondcell.fem.scouts import CAUTION, SCOUTS, Scouts
from bondcell.fem.structured import LOADS, find_load, geometry_of, solve_level
from bondcell.status import Status


def unit_cell(**changes):
    """Particles of radius one in a matrix of modulus one."""
    values = {"radius_i": 1.0, "gap": 0.05, "young_i": 1e3, "young_m": 1.0, "poisson_i": 0.25}
    return Cell.from_values(**values | {"poisson_m": 0.3} | changes).ravel()


def test_estimate_sums_the_steps_to_come():
    assert estimate(np.array([[1.0]]), [4], 4) == [np.inf]
    # One step: the slowest rate is taken, 3 * 0.1 / (1.5 - 1).
    np.testing.assert_allclose(estimate(np.array([[1.1, 1.0]]), [4, 5], 4), [0.6])
    # Two: a rate of two is seen, 3 * 0.1 / (2 - 1); one of ten is not trusted, 3 * 0.01 / (4 - 1).
    slow, fast = np.array([[1.3, 1.1, 1.0]]), np.array([[1.11, 1.01, 1.0]])
    np.testing.assert_allclose(estimate(slow, [4, 5, 6], 4), [0.3])
    np.testing.assert_allclose(estimate(fast, [4, 5, 6], 4), [0.01])
    # Over two orders the same step means a slower rate, and leaves less to come.
    np.testing.assert_allclose(estimate(slow, [4, 5, 7], 4), [0.1])


def test_estimate_distrusts_a_lucky_step():
    lucky = np.array([[1.1, 1.0, 1.0], [1.16, 1.0, 1.0001]])
    np.testing.assert_allclose(estimate(lucky, [6, 7, 8], 4), [0.1 / 16, 0.01], rtol=1e-3)


def test_estimate_takes_steps_that_do_not_shrink_for_round_off():
    np.testing.assert_allclose(estimate(np.array([[1.01, 1.02, 1.0]]), [6, 7, 8], 4), [0.12])


@pytest.mark.parametrize(
    "load",
    [
        "normal",
        "torsion",
        pytest.param("shear", marks=pytest.mark.slow),
        pytest.param("bending", marks=pytest.mark.slow),
    ],
)
def test_ladder_of_true_steps_is_estimated_from_above(load):
    """At every rung that ends a ladder the estimate covers what two more orders still change."""
    case, rate = unit_cell(radius_j=0.7), find_load(load, "roller").rate
    orders = [4, 5, 6, 7, 8]
    rungs = np.array([[solve_level(case, p, load=load).stiffness for p in (*orders, 10)]])
    for last in range(3, len(orders) + 1):
        true = abs(rungs[0, last - 1] / rungs[0, -1] - 1)
        assert true <= estimate(rungs[:, :last], orders[:last], rate)[0]


def test_particles_lag_the_more_the_stiffer_they_are():
    load = find_load("normal", "roller")
    lags = []
    for ratio in (1e-3, 1.0, 1e2, 1e3, 1e5, 1e8, np.inf):
        case = unit_cell(young_i=ratio)
        lags.append(particle_lag(geometry_of(case), Materials.of(case), load))
    assert lags == sorted(lags)
    assert lags[:2] == [0, 0]
    assert lags[-1] == LARGEST_LAG
    mixed = unit_cell(young_i=[1.0, 1e8])
    assert particle_lag(geometry_of(mixed), Materials.of(mixed), load) == 0


def test_particles_do_not_lag_where_a_confined_matrix_cannot_give_way():
    case = unit_cell(young_i=1e4, poisson_m=0.5)
    confined, free = (find_load("normal", bc) for bc in ("confined", "roller"))
    geometry, materials = geometry_of(case), Materials.of(case)
    assert particle_lag(geometry, materials, confined) == 0
    assert particle_lag(geometry, materials, free) >= 2


@pytest.mark.parametrize(("load", "bc"), list(LOADS))
@pytest.mark.parametrize(
    "changes",
    [
        {},
        pytest.param({"radius_j": 0.6, "gap": 1e-3, "young_i": 1e5}, marks=pytest.mark.slow),
    ],
)
def test_lagging_particles_cost_less_than_an_order_less(load, bc, changes):
    case = unit_cell(**changes)
    lag = particle_lag(geometry_of(case), Materials.of(case), find_load(load, bc))
    assert lag >= 2
    usual, lagging = (solve_level(case, 7, bc, load, lag=n) for n in (0, lag))
    lower, limit = (solve_level(case, p, bc, load).stiffness for p in (6, 10))
    assert abs(lagging.stiffness / limit - 1) < abs(lower / limit - 1)
    assert lagging.dof < 0.8 * usual.dof


def test_particles_that_lag_catch_up_with_the_order():
    """Exponential convergence stays: the limit is the same, a few orders later."""
    case = unit_cell()
    limit = solve_level(case, 13).stiffness
    errors = [abs(solve_level(case, p, lag=3).stiffness / limit - 1) for p in (5, 7, 9, 11)]
    assert all(later < earlier / 10 for earlier, later in pairwise(errors))


def sweep(count):
    """A plane of materials."""
    ratios, poissons = np.meshgrid(np.geomspace(1e2, 1e6, count), np.linspace(0, 0.4999, count))
    return unit_cell(young_i=ratios.ravel(), poisson_m=poissons.ravel())


def test_scouts_are_few_and_reach_the_corners():
    materials = Materials.of(sweep(7))
    scouts = Scouts(materials)
    assert scouts.points.size == SCOUTS
    assert np.union1d(scouts.points, scouts.others).size == materials.count
    corners = {0, 6, 42, 48}
    assert corners <= set(scouts.points.tolist())
    told = scouts.tell(np.full(SCOUTS, 1e-7))
    np.testing.assert_allclose(told, CAUTION * 1e-7)
    assert np.isinf(scouts.tell(np.full(SCOUTS, np.nan))).all()


def test_few_points_are_their_own_scouts():
    scouts = Scouts(Materials.of(sweep(4)))
    assert scouts.points.size == 16
    assert not scouts.others.size
    assert scouts.caution == 1


@pytest.mark.parametrize("load", ["normal", "torsion"])
def test_scouts_speak_for_all_points(load):
    """Estimates that points take over cover their true errors."""
    cases = sweep(6)
    answer = solve(cases, load, tolerance=1e-6)
    assert (answer.status == Status.ok).all()
    for k in range(0, 36, 5):
        true = solve_level(cases.take(slice(k, k + 1)), 12, load=load).stiffness
        assert abs(answer.stiffness[k] / true - 1) <= answer.error_estimate[k]


@pytest.mark.parametrize(("load", "bc"), [key for key in LOADS if key != ("normal", "confined")])
@pytest.mark.parametrize("gap", [1e-3, 0.5])
@pytest.mark.parametrize("foot", [STIFF_CUT, WIDE_CUT])
def test_cutting_the_cusp_early_costs_what_is_said(load, bc, gap, foot):
    entry = LOADS[load, bc]
    early = replace(entry.grading, foot=foot, corner=0.0)
    allowed = entry.early_cut * (foot / STIFF_CUT) ** 3
    for poisson_m in (0.0, 0.49):
        one = unit_cell(gap=gap, young_i=STIFF_RATIO, poisson_m=poisson_m)
        usual, cut = (solve_level(one, 8, bc, load, grading=g) for g in (None, early))
        assert allowed / 100 < abs(cut.stiffness / usual.stiffness - 1) <= allowed


@pytest.mark.parametrize(("load", "bc"), [key for key in LOADS if key != ("normal", "confined")])
@pytest.mark.parametrize("ratio", [1.0, 10.0])
def test_cutting_the_cusp_as_usual_costs_what_is_said(load, bc, ratio):
    entry = LOADS[load, bc]
    later = replace(entry.grading, foot=entry.grading.foot / 10)
    one = unit_cell(young_i=ratio, poisson_m=0.25)
    usual, limit = (solve_level(one, 9, bc, load, grading=g).stiffness for g in (None, later))
    allowed = entry.usual_cut * ratio**-1.5
    assert allowed / 100 < abs(usual / limit - 1) <= allowed
