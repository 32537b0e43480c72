"""The reduced basis against direct solves: its error, its bound, and when it is taken."""

import numpy as np
import pytest

from bondcell.cell import Cell
from bondcell.fem.cell_mesh import Geometry, build_cell_mesh
from bondcell.fem.cell_operators import CellOperators
from bondcell.fem.interpolated_matrix import InterpolatedMatrix
from bondcell.fem.materials import Materials
from bondcell.fem.reduced_basis import Points, ReducedBasis
from bondcell.fem.reference import solve
from bondcell.fem.structured import LOADS, OFFSET, CellSolver
from bondcell.fem.sweep import Way
from bondcell.status import Status

ORDER = 6


def materials(count, seed, largest_poisson=0.4999):
    rng = np.random.default_rng(seed)
    young = 10 ** rng.uniform(0.3, 8, count)
    young[: count // 20] = np.inf
    poisson_m = rng.choice(np.linspace(0, largest_poisson, 12), count)
    return Materials(
        young, young, np.ones(count), np.full(count, 0.25), np.full(count, 0.25), poisson_m
    )


def operators(load, bc=None, gap=1 / 15, radius_j=1.0):
    geometry = Geometry(1.0, radius_j, gap, 1.0)
    entry = LOADS[load, bc]
    half = geometry.is_mirrored
    supports = entry.halves[0] if half else entry.whole
    return CellOperators(build_cell_mesh(geometry, entry.grading, half), ORDER, supports)


CASES = {
    "roller": {"load": "normal", "bc": "roller"},
    "thin": {"load": "normal", "bc": "roller", "gap": 1e-3},
    "unequal": {"load": "normal", "bc": "roller", "radius_j": 0.4},
    "shear": {"load": "shear"},
    "torsion": {"load": "torsion"},
    "beam": {"load": "bending", "radius_j": 0.6},
}


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=[pytest.mark.slow] * (name == "beam")) for name in CASES]
)
def test_error_is_small_and_below_its_bound(name):
    case = CASES[name]
    cell = operators(**case)
    points = materials(40, seed=5)
    own = Points.of(points, len(cell.of_particle))
    tolerance = 1e-6
    basis = ReducedBasis(
        cell, [0.25] * len(cell.of_particle), own, tolerance, OFFSET * case.get("gap", 1 / 15)
    )
    response, bound = basis.respond(own)
    halves = 2 if cell.is_half else 1
    for k in range(points.count):
        constants = points.constants(k)
        true = np.diagonal(cell.response(constants)) * halves / constants.shear_m
        error = np.diagonal(response[k]) - true
        slack = np.abs(true) * (basis.interpolation_error + 1e-10)
        assert (error >= -slack).all()
        assert (error <= bound[k] + slack).all()
        assert (bound[k] <= tolerance * np.abs(true)).all()
    assert basis.size < 60 < cell.size or name == "torsion"


def test_bound_falls_with_the_size_of_the_basis():
    cell = operators("normal", "roller")
    own = Points.of(materials(150, seed=6), 1)
    worst = []
    for tolerance in (1e-2, 1e-4, 1e-6, 1e-8):
        basis = ReducedBasis(cell, [0.25], own, tolerance, OFFSET / 15)
        response, bound = basis.respond(own)
        worst.append((basis.size, (bound[:, 0] / response[:, 0, 0]).max()))
    sizes, bounds = zip(*worst, strict=True)
    assert list(sizes) == sorted(set(sizes))
    assert (np.diff(np.log(bounds)) < 0).all()
    assert bounds[-1] < 1e-8


@pytest.mark.parametrize("gap", [1e-3, 1 / 15, 1.0])
def test_interpolation_in_compressibility(gap):
    cell = operators("normal", "roller", gap=gap)
    wanted = np.linspace(0.01, 1.4, 200)
    matrix = InterpolatedMatrix(cell, wanted, OFFSET * gap, 1e-8)
    assert matrix.nodes.size < wanted.size
    assert matrix.error <= 1e-8
    weights = matrix.weights(np.array([0.3, matrix.nodes[2]]))
    assert weights.sum(axis=1) == pytest.approx(1)
    poisson = (3 - 2 * 0.3) / (6 + 2 * 0.3)
    true = cell.matrix_system(poisson)
    assert np.allclose(np.tensordot(weights[0], matrix.own, 1), true.own[:1, :1], rtol=1e-7)


def plane(count, **changes):
    young, poisson = (
        a.ravel() for a in np.meshgrid(np.geomspace(1.5, 1e8, count), np.linspace(0, 0.49, count))
    )
    values = {
        "radius_i": 1.0,
        "gap": 1 / 15,
        "young_i": young,
        "young_m": 1.0,
        "poisson_i": 0.25,
        "poisson_m": poisson,
    }
    return Cell.from_values(**values | changes)


def scattered(count):
    rng = np.random.default_rng(11)
    return plane(1, young_i=10 ** rng.uniform(0.2, 8, count), poisson_m=rng.uniform(0, 0.49, count))


@pytest.mark.parametrize("load", ["normal", "torsion"])
@pytest.mark.parametrize(
    ("cells", "way"), [(plane(40), Way.spectrum), (scattered(1600), Way.reduced_basis)]
)
def test_sweep_takes_the_cheapest_way_and_keeps_the_tolerance(load, cells, way):
    answer = solve(cells, load, tolerance=1e-5)
    assert (answer.status == Status.ok).all()
    assert (answer.way == way).mean() > 0.5
    assert (answer.reduction_error <= answer.error_estimate).all()
    for k in (0, 7, 800, 1599):
        alone = solve(cells.ravel().take(slice(k, k + 1)), load, tolerance=1e-7)
        assert alone.way[0] == Way.direct
        error = abs(answer.stiffness[k] / alone.stiffness[0] - 1)
        assert error <= answer.error_estimate[k] + alone.error_estimate[0]


@pytest.mark.parametrize("load", ["normal", "torsion", "shear", "bending"])
@pytest.mark.parametrize("poisson_m", [0.0, 0.46, 0.49999, 0.5])
def test_spectrum_equals_direct_solves(load, poisson_m):
    """Unequal particles of one ratio of moduli, from equal to the matrix up to rigid."""
    young = np.append(np.geomspace(1.3, 1e12, 20), np.inf)
    changes = {"radius_j": 0.6, "young_j": 3 * young, "poisson_j": 0.1, "poisson_m": poisson_m}
    cells = plane(1, young_i=young, **changes).ravel()
    entry = LOADS[load, "roller" if load == "normal" else None]
    solver = CellSolver(Geometry(1.0, 0.6, 1 / 15, 1.0), entry, half=False, order=5)
    own = Materials.of(cells)
    swept = solver.sweep(own, 1e-9)
    assert (swept.way[:-1] == Way.spectrum).all()
    alone = [solver.stiffness(own.constants(k)) for k in range(0, 21, 5)]
    np.testing.assert_allclose(swept.stiffness[::5], alone, rtol=2e-9)


def test_few_points_are_solved_directly():
    answer = solve(plane(3), tolerance=1e-5)
    assert (answer.way == Way.direct).all()
    assert (answer.reduction_error == 0).all()


def test_points_softer_than_the_matrix_are_solved_directly():
    """They start from another lift."""
    young = np.concatenate((np.full(5, 0.2), np.geomspace(2, 1e6, 2000)))
    cells = plane(1, young_i=young, poisson_m=0.3, young_m=np.ones(2005))
    answer = solve(cells, tolerance=1e-4)
    assert (answer.way[:5] == Way.direct).all()
    assert (answer.way[5:] == Way.spectrum).mean() > 0.99
    assert (np.diff(answer.stiffness[4:]) > 0).all()
