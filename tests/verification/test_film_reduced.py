"""Many materials on one geometry: reduced fields against all fields, point by point."""

import numpy as np
import pytest

from bondcell.cell import Cell, FloatArray
from bondcell.models import MODELS
from bondcell.models.film import reduced
from bondcell.models.film.loads import RELATIVE_ERROR
from bondcell.models.film.reduced import MANY, TOLERANCE, least_energies_of_many
from bondcell.models.film.solve import least_energies, solved

LOADS = ("normal", "shear", "torsion", "bending")

ROUND_OFF = 3e-7
"""Fields that nearly repeat each other leave that much, well below the model's own 1e-4."""


def materials(count: int, seed: int, radius_j: float, largest: float = 7.0) -> Cell:
    """One geometry; particles from softer than the matrix up to rigid, nu_m up to 1/2."""
    draw = np.random.default_rng(seed).uniform
    young = 10 ** draw(-0.5, largest, count)
    shut = 0.5 - 10 ** draw(-9, -2, count)
    poisson = np.where(draw(size=count) < 0.2, shut, draw(0, 0.49, count))
    return Cell.from_values(
        radius_i=1.0,
        radius_j=radius_j,
        gap=0.02,
        young_i=np.where(draw(size=count) < 0.1, np.inf, young),
        young_j=young if radius_j == 1.0 else 3 * young,
        young_m=1.0,
        poisson_i=0.25,
        poisson_j=0.25 if radius_j == 1.0 else 0.3,
        poisson_m=np.where(draw(size=count) < 0.1, 0.5, poisson),
    )


@pytest.mark.parametrize("load", LOADS)
@pytest.mark.parametrize("radius_j", [1.0, 0.6])
def test_together_or_few_at_once(load: str, radius_j: float) -> None:
    """The loss is within its bound, and never a gain: the result stays an upper bound."""
    cell = materials(6 * MANY, seed=31, radius_j=radius_j).ravel()
    law = MODELS["film"].loads[load]
    together = law(cell)
    some = np.random.default_rng(1).choice(cell.gap.size, 60, replace=False)
    alone = law(cell.take(some)).stiffness
    bound = np.broadcast_to(together.relative_error, cell.shape)[some] - RELATIVE_ERROR
    loss = together.stiffness[some] / alone - 1
    assert bound.max() > 0  # the basis was used
    assert bound.max() <= TOLERANCE
    assert np.all(loss <= bound + ROUND_OFF)
    assert loss.min() > -ROUND_OFF


def forms(count: int, seed: int) -> FloatArray:
    """Semidefinite forms of random fields, the second one of half of them only."""
    draw = np.random.default_rng(seed).normal
    rows = draw(size=(3, count, 2 * count))
    rows[1, : count // 2] = 0
    rows[2, count // 4 :] = 0
    return np.asarray(rows @ rows.swapaxes(-1, -2))


def test_bound_of_the_loss() -> None:
    """A basis of few solutions: what it loses is below its bound, and not nothing."""
    own, draw = forms(24, seed=1), np.random.default_rng(2).uniform
    factors = 10 ** draw(-1, 3, (40, 3))
    basis = reduced.Basis(own)
    basis.add(factors[:4])
    value, bound = basis.energies(factors)
    loss = value - least_energies(own, factors)[0]
    assert np.all(loss <= bound * (1 + 1e-9) + 1e-10 * value)
    assert np.all(loss >= -1e-10 * value)
    assert loss[4:].min() > 1e-6 * value.min()
    assert np.abs(loss[:4]).max() < 1e-9 * value.max()


def test_one_material_many_times() -> None:
    """Solutions that repeat each other leave the basis with the one."""
    own = forms(12, seed=3)
    factors = np.broadcast_to([1.0, 20.0, 300.0], (2 * MANY, 3))
    value, bound = least_energies_of_many(own, factors)
    assert value == pytest.approx(least_energies(own, factors[:1])[0][0], rel=1e-10)
    assert np.all(bound <= TOLERANCE)


def test_what_no_basis_holds_is_solved(monkeypatch: pytest.MonkeyPatch) -> None:
    """With no room in the basis most points are solved by themselves."""
    monkeypatch.setattr(reduced, "LARGEST", reduced.START + reduced.STEP - 1)
    own, draw = forms(40, seed=4), np.random.default_rng(5).uniform
    factors = 10 ** draw(-2, 2, (MANY, 3))
    value, bound = least_energies_of_many(own, factors)
    exact, ridge = least_energies(own, factors)
    assert np.all(bound <= TOLERANCE)
    assert np.all(value <= exact * (1 + 1.01 * bound + 1e-10))
    alone = bound == ridge
    assert np.array_equal(value[alone], exact[alone])
    assert np.count_nonzero(alone) > MANY / 2


def test_the_ridge_is_counted() -> None:
    """Two fields that are all but the same: the ridge raises the energy, by about what is said."""
    rows = np.random.default_rng(5).normal(size=(4, 12))
    rows[3] = rows[2] + 1e-6 * rows[3]
    matrix = rows @ rows.T
    some, none = solved(matrix.copy(), ridge=1e-13), solved(matrix.copy(), ridge=0.0)
    assert none.loss == 0.0
    assert 0 < some.energy / none.energy - 1 < 3 * some.loss < 0.2
