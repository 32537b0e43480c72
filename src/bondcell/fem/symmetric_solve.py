"""Linear systems with entries of very different size: scaled first, then dense or sparse."""

from __future__ import annotations

import numpy as np
from scipy.sparse import csc_array
from scipy.sparse.linalg import splu

from bondcell.cell import FloatArray

DENSE_LIMIT = 1800
"""Unknowns up to which a dense factorisation is the quicker one."""


def solve_symmetric(matrix: FloatArray, right: FloatArray) -> FloatArray:
    """Solve a symmetric, possibly indefinite system.

    Stiff particles, thin films and pressures put entries many decades apart into one system. Rows
    and columns are scaled alike until their largest entries are near one, which is what round-off
    of the factorisation is relative to.

    Parameters
    ----------
    matrix
        Shape (n, n).
    right
        Shape (n, k).

    Raises
    ------
    numpy.linalg.LinAlgError
        If the matrix is singular.
    """
    if not matrix.size:
        return np.zeros_like(right)
    scale = np.ones(len(matrix))
    for _ in range(3):
        largest = np.abs(matrix * scale).max(axis=1) * scale
        scale /= np.sqrt(np.where(largest > 0, largest, 1.0))
    scaled = matrix * scale * scale[:, None]
    if len(matrix) <= DENSE_LIMIT:
        return np.asarray(scale[:, None] * np.linalg.solve(scaled, scale[:, None] * right))
    try:
        factors = splu(
            csc_array(scaled),
            permc_spec="MMD_AT_PLUS_A",
            diag_pivot_thresh=0.1,
            options={"SymmetricMode": True},
        )
    except RuntimeError as error:
        raise np.linalg.LinAlgError(str(error)) from error
    return np.asarray(scale[:, None] * factors.solve(scale[:, None] * right))
