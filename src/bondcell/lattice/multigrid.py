"""Large lattices: conjugate gradients with algebraic multigrid that knows the rigid motions."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import bsr_array

from bondcell.cell import FloatArray
from bondcell.errors import BondcellError
from bondcell.fem.blocks import hold

MOST_ITERATIONS = 500
"""Some tens are usual."""

COARSEST = 80
"""Nodes of the coarsest level, which is inverted densely, by singular values."""


def solve_iteratively(
    matrix: bsr_array,
    held: NDArray[np.bool_],
    modes: FloatArray,
    right: FloatArray,
    residual: float,
) -> tuple[FloatArray, int]:
    """Solve for what is free.

    Parameters
    ----------
    matrix
        Stiffness matrix of square blocks.
    held
        Unknowns that stay zero, shape (nodes, width).
    modes
        Rigid motions, shape (nodes, width, motions): nearly nothing resists them locally.
    right
        Right-hand side, zero where held.
    residual
        Relative residual to reach.

    Raises
    ------
    BondcellError
        It is not reached: the lattice has a mechanism, or nearly so.
    """
    from pyamg.aggregation import smoothed_aggregation_solver

    inner = hold(matrix, held)
    # Rotations enter with a length, so that all unknowns weigh alike.
    scale = 1 / np.sqrt(inner.diagonal())
    width = matrix.blocksize[0]
    rows = scale.reshape(-1, width)
    node = np.repeat(np.arange(len(rows)), np.diff(inner.indptr))
    inner.data *= rows[node][:, :, np.newaxis]
    inner.data *= rows[inner.indices][:, np.newaxis, :]
    near = np.where(held[:, :, np.newaxis], 0.0, modes).reshape(scale.size, -1)
    near /= scale[:, np.newaxis]
    near /= np.linalg.norm(near, axis=0)
    levels = smoothed_aggregation_solver(
        inner, B=near, improve_candidates=None, max_coarse=COARSEST
    )
    history: list[float] = []
    answer, failed = levels.solve(
        scale * right,
        tol=residual,
        maxiter=MOST_ITERATIONS,
        accel="cg",
        residuals=history,
        return_info=True,
    )
    if failed:
        raise BondcellError(
            f"no relative residual of {residual} within {MOST_ITERATIONS} iterations: the lattice "
            "has a mechanism that nearly nothing resists"
        )
    return np.asarray(scale * answer), len(history) - 1
