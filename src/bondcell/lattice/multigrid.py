"""Large lattices: conjugate gradients with algebraic multigrid that knows the rigid motions."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import bsr_array

from bondcell.cell import FloatArray
from bondcell.fem.aggregates import Aggregates
from bondcell.fem.blocks import hold
from bondcell.fem.krylov import conjugate_gradients


def solve_iteratively(
    matrix: bsr_array,
    held: NDArray[np.bool_],
    modes: FloatArray,
    right: FloatArray,
    tolerance: float,
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
    tolerance
        Error in the energy norm relative to that of no motion.

    Raises
    ------
    BondcellError
        The iterations do not converge: the lattice has a mechanism, or nearly so.
    """
    free = (~held).astype(np.float64).reshape(-1, 1)
    inner = hold(matrix, held)
    solver = Aggregates(inner, held, modes)
    answer, iterations = conjugate_gradients(
        lambda x: inner @ x,
        solver,
        right.reshape(-1, 1) * free,
        tolerance,
    )
    return answer[:, 0] * free[:, 0], iterations
