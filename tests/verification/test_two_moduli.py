"""Shear and bulk modulus relax by a series each: networks, and the reference reduced to them."""

import mpmath as mp
import numpy as np
import pytest

from bondcell.cell import Cell
from bondcell.fem import relaxing_reference as reference
from bondcell.fem.condensed_system import without_insides
from bondcell.fem.full_system import full_systems
from bondcell.fem.laplace_inversion import invert_reference
from bondcell.fem.time_stepping import graded_times, step_through
from bondcell.fem.two_moduli import reduce_two, shares
from bondcell.prony.chain import Chain
from bondcell.prony.conventions import Relaxing
from bondcell.prony.network import Network
from bondcell.prony.prony import Prony
from bondcell.status import Status

ORDER = 4
SHEAR = ([0.5, 0.3, 0.15], [1e-3, 1.0, 1e3])
ABAQUS = Prony(*SHEAR, bulk_weights=[0.1, 0.2, 0.05], bulk_times=SHEAR[1])
ANSYS = Prony(*SHEAR, bulk_weights=[0.3, 0.1], bulk_times=[2e-2, 50.0])
BASE = {
    "radius_i": 7.5e-3,
    "gap": 5e-4,
    "young_i": 3e10,
    "young_m": 1.4e6,
    "poisson_i": 0.25,
    "poisson_m": 0.46,
}


def relaxing(prony, convention=None, **changes):
    return Relaxing.of(Cell.from_values(**(BASE | changes)).ravel(), prony, convention)


def random_network(rng, size, spread):
    """A network with stiff springs off the motion, and both kinds of matrix."""

    def gram(rank, scale):
        root = rng.standard_normal((rank, size + 1))
        return scale * root.T @ root

    # Exact numbers: as a sum, stiff springs would leave their round-off between the soft ones.
    lasting = np.diag([0.0, spread, *np.zeros(size - 1)])
    return Network(lasting, gram(size + 1, 1.0), gram(size, 10.0))


def random_chain(rng, terms, decades, end):
    weights = rng.random(terms)
    times = 10 ** np.linspace(-decades / 2, decades / 2, terms) * (1 + rng.random(terms))
    return Chain(np.array(end), weights / weights.sum() * (1 - end), times)


@pytest.mark.parametrize(
    ("terms", "decades", "end", "spread"),
    [(3, 4, 0.1, 1e2), (4, 14, 1e-3, 1e6), (5, 30, 1e-3, 1e2), (4, 30, 0.0, 1e8)],
)
def test_network_in_fifty_digits(terms, decades, end, spread):
    """The series against Laplace inversion of the network with 50 digits."""
    rng = np.random.default_rng(terms)
    network = random_network(rng, 4, spread)
    shear, bulk = random_chain(rng, terms, decades, end), random_chain(rng, terms - 1, decades, 0.3)
    series = network.relaxation(shear, bulk)
    assert (series.strengths > 0).all()
    assert (np.diff(series.times) > 0).all()
    size = len(network.lasting)
    with mp.workdps(50):
        parts = [
            mp.matrix(part.tolist()) for part in (network.lasting, network.shear, network.bulk)
        ]

        def share(chain, s):
            terms = zip(chain.strengths.tolist(), chain.times.tolist(), strict=True)
            return mp.mpf(float(chain.equilibrium)) + sum(
                g * s * mp.mpf(tau) / (1 + s * mp.mpf(tau)) for g, tau in terms
            )

        def transform(s):
            whole = parts[0] + share(shear, s) * parts[1] + share(bulk, s) * parts[2]
            inside = mp.lu_solve(whole[1:size, 1:size], whole[1:size, 0])
            return (whole[0, 0] - (whole[0, 1:size] * inside)[0]) / s

        for t in 10 ** np.linspace(-decades / 2, decades / 2, 4):
            true = mp.invertlaplace(transform, mp.mpf(float(t)), method="talbot", degree=36)
            assert abs(series.relaxation([t])[0] / float(true) - 1) < 1e-11


def test_network_with_many_terms():
    """Sixty terms over thirty decades: the transform everywhere, to many digits."""
    rng = np.random.default_rng(3)
    network = random_network(rng, 3, 1e4)
    shear, bulk = random_chain(rng, 60, 30, 1e-2), random_chain(rng, 30, 30, 0.1)
    series = network.relaxation(shear, bulk)
    s = np.geomspace(1e-17, 1e17, 60)
    true = network.stiffness(shear.transform(s), bulk.transform(s))
    np.testing.assert_allclose(series.transform(s), true, rtol=1e-11)


CASES = [
    (ABAQUS, "normal", "roller", {}),
    pytest.param(
        ANSYS,
        "normal",
        "clamped",
        {"radius_j": 4e-3, "young_j": 1e9},
        marks=pytest.mark.slow,
    ),
    (ANSYS, "normal", "confined", {"poisson_m": 0.3}),
    pytest.param(ANSYS, "bending", "roller", {}, marks=pytest.mark.slow),
    (ABAQUS, "normal", "roller", {"young_i": np.inf, "gap": 5e-5, "poisson_m": 0.499}),
]


@pytest.mark.parametrize(("prony", "load", "bc", "changes"), CASES)
def test_series_against_laplace_inversion(prony, load, bc, changes):
    matrix = relaxing(prony, **changes)
    systems = full_systems(matrix.cell, ORDER, load, bc)
    condensed = tuple(without_insides(system) for system in systems)
    model = reduce_two(matrix, condensed, 1e-4, bears_at_rest=False, tolerance=1e-10)
    assert model.missed <= 1e-10
    series = model.series(matrix)
    s = np.geomspace(1e-6, 1e6, 25)
    np.testing.assert_allclose(series.transform(s), model.stiffness(*shares(matrix, s)), rtol=1e-11)
    times = np.array([1e-4, 30.0])
    inverted = invert_reference(matrix, systems, times)
    np.testing.assert_allclose(series.relaxation(times), inverted, rtol=1e-9)


def test_time_stepping_converges_at_second_order():
    matrix = relaxing(ANSYS, young_i=3e8, poisson_m=0.4)
    systems = full_systems(matrix.cell, ORDER)
    series = reduce_two(matrix, systems, 1e-4, False, 1e-10).series(matrix)
    wanted = np.geomspace(1e-3, 1e3, 4)
    errors = []
    for steps in (4, 8, 16):
        times = graded_times(wanted, steps, first=1e-4)
        values = step_through(matrix, systems, times)
        np.testing.assert_allclose(values[0], series.instantaneous, rtol=1e-8)
        at = np.searchsorted(times, wanted * (1 - 1e-12))
        errors.append(np.abs(values[1 + at] / series.relaxation(wanted) - 1).max())
    assert (np.log2(np.array(errors[:-1]) / errors[1:]) > 1.7).all()
    assert errors[-1] < 2e-4


@pytest.mark.parametrize(
    ("bulk", "convention"), [(SHEAR, "constant_poisson"), (([1e-12], [1.0]), "constant_bulk")]
)
def test_both_conventions_are_limits(bulk, convention):
    """Bulk that relaxes like shear is a constant Poisson's ratio; one that stays, constant bulk."""
    separate = reference.relax(relaxing(Prony(*SHEAR, bulk_weights=bulk[0], bulk_times=bulk[1])))
    one = reference.relax(relaxing(Prony(*SHEAR), convention))
    times = np.geomspace(1e-6, 1e7, 60)
    both = separate.series.relaxation(times) / one.series.relaxation(times)
    assert np.abs(both - 1).max() < separate.reduction_error + one.reduction_error
    assert max(separate.reduction_error, one.reduction_error) <= 1e-9


def test_estimate_and_flags():
    answer = reference.relax(relaxing(ABAQUS))
    assert answer.status == Status.ok
    assert answer.reduction_error <= answer.error_estimate <= 1e-6
    fine = reference.relax(relaxing(ABAQUS), tolerance=1e-8)
    times = np.geomspace(1e-6, 1e6, 40)
    difference = answer.series.relaxation(times) / fine.series.relaxation(times) - 1
    assert np.abs(difference).max() <= answer.error_estimate + fine.error_estimate


def test_fluids_end_in_nothing_or_in_their_pressure():
    flows = {"weights": [0.6, 0.4], "times": [1e-3, 1e3]}
    lasting = Prony(**flows, bulk_weights=[0.3], bulk_times=[1.0])
    assert reference.relax(relaxing(lasting)).series.equilibrium == 0.0
    held = reference.relax(relaxing(lasting), bc="confined").series
    nearly = Prony([0.6, 0.4 - 1e-5], flows["times"], bulk_weights=[0.3], bulk_times=[1.0])
    almost = reference.relax(relaxing(nearly), bc="confined").series
    assert held.equilibrium == pytest.approx(float(almost.equilibrium), rel=1e-2)
    both = Prony(**flows, bulk_weights=[1.0], bulk_times=[1.0])
    assert reference.relax(relaxing(both), bc="confined").series.equilibrium == 0.0
