"""Linear systems with entries of very different size, and what eliminating unknowns leaves."""

from __future__ import annotations

import numpy as np
from scipy.linalg.blas import dtrsm
from scipy.linalg.lapack import dpotrf
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


def half_solve(matrix: FloatArray, rows: FloatArray) -> FloatArray:
    """``rows L^-T`` of a positive definite ``L L^T``, so that ``x x^T = rows matrix^-1 rows^T``.

    Parameters
    ----------
    matrix
        Shape (n, n), overwritten.
    rows
        Shape (k, n), overwritten by the result where it is contiguous.

    Raises
    ------
    numpy.linalg.LinAlgError
        If the matrix is not positive definite.
    """
    if not (matrix.size and rows.size):
        return rows
    # LAPACK reads a transposed view of a C array without a copy.
    factor, failed = dpotrf(matrix.T, lower=0, overwrite_a=1, clean=0)
    if failed:
        raise np.linalg.LinAlgError(f"not positive definite: leading minor of order {failed}")
    return np.asarray(dtrsm(1.0, factor, rows.T, trans_a=1, overwrite_b=1).T)


def eliminated(matrix: FloatArray, right: FloatArray, negative: int) -> FloatArray:
    """``right^T matrix^-1 right`` of a symmetric matrix.

    Parameters
    ----------
    matrix
        Shape (n, n): positive definite but for the last unknowns, whose Schur complement is
        negative definite.
    right
        Shape (n, k).
    negative
        How many unknowns are the last.

    Raises
    ------
    numpy.linalg.LinAlgError
        If the matrix is singular.
    """
    if len(matrix) > DENSE_LIMIT:
        return np.asarray(right.T @ solve_symmetric(matrix, right))
    at = len(matrix) - negative
    try:
        rows = np.concatenate((matrix[at:, :at], right[:at].T))
        root = half_solve(matrix[:at, :at].copy(), rows)
        first, others = root[:negative], root[negative:]
        last = half_solve(
            first @ first.T - matrix[at:, at:],
            np.ascontiguousarray(right[at:].T) - others @ first.T,
        )
        return np.asarray(others @ others.T - last @ last.T)
    except np.linalg.LinAlgError:
        # Round-off spoils definiteness before it spoils a pivoted factorisation.
        return np.asarray(right.T @ solve_symmetric(matrix, right))
