"""Conjugate gradients for several right-hand sides at once."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from bondcell.cell import FloatArray
from bondcell.errors import BondcellError

Operator = Callable[[FloatArray], FloatArray]

MOST_ITERATIONS = 300
"""Twenty to thirty are usual."""

TOLERANCE = 1e-5
"""Error in the energy norm relative to the start's; the energy's own error is its square."""


def conjugate_gradients(
    apply: Operator,
    precondition: Operator,
    residual: FloatArray,
    tolerance: float = TOLERANCE,
) -> tuple[FloatArray, int]:
    """Solve ``A x = r`` from zero, each column on its own, all in the same products.

    Parameters
    ----------
    apply, precondition
        Products with the matrix and its approximate inverse, shape (unknowns, cases) to the same.
    residual
        Right-hand sides, shape (unknowns, cases).
    tolerance
        Reduction of ``sqrt(r.B r)``, which measures the error in the energy norm.

    Returns
    -------
    tuple
        Solutions, shape (unknowns, cases), and iterations.

    Raises
    ------
    BondcellError
        The tolerance is not met within `MOST_ITERATIONS`, or the matrix is not positive definite.
    """
    answer, residual = np.zeros_like(residual), residual.copy()
    direction = precondition(residual)
    square = _products(residual, direction)
    goal = tolerance**2 * square
    for iteration in range(MOST_ITERATIONS):
        if (square <= goal).all():
            return answer, iteration
        pushed = apply(direction)
        curvature = _products(direction, pushed)
        if (curvature[square > goal] <= 0).any():
            raise BondcellError("the matrix is not positive definite: the state is unstable")
        length = np.where(square > goal, square / np.where(curvature > 0, curvature, 1.0), 0.0)
        answer += length * direction
        residual -= length * pushed
        smoothed = precondition(residual)
        following = _products(residual, smoothed)
        ratio = np.where(square > 0, following / np.where(square > 0, square, 1.0), 0.0)
        direction *= ratio
        direction += smoothed
        square = following
    raise BondcellError(f"no reduction of the error to {tolerance} in {MOST_ITERATIONS} iterations")


def _products(one: FloatArray, other: FloatArray) -> FloatArray:
    """Inner products of columns, shape (cases,)."""
    return np.asarray(np.einsum("uc,uc->c", one, other))
