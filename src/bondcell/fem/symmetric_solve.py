"""Linear systems with entries of very different size, and what eliminating unknowns leaves."""

from __future__ import annotations

import numpy as np
from scipy.linalg.blas import dtrsm
from scipy.linalg.lapack import dpotrf
from scipy.sparse import csc_array
from scipy.sparse.linalg import SuperLU, splu

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
        factors = factored(csc_array(scaled), pivoting=0.1)
    except RuntimeError as error:
        raise np.linalg.LinAlgError(str(error)) from error
    return np.asarray(scale[:, None] * factors.solve(scale[:, None] * right))


def factored(matrix: csc_array, pivoting: float = 0.0) -> SuperLU:
    """Factors of a sparse symmetric matrix, rows ordered for little fill.

    Parameters
    ----------
    matrix
        Real and positive definite, or complex and symmetric.
    pivoting
        Size of a diagonal entry over the largest of its column from which it is the pivot; a
        definite matrix needs none other.
    """
    return splu(
        csc_array(matrix),
        permc_spec="MMD_AT_PLUS_A",
        diag_pivot_thresh=pivoting,
        options={"SymmetricMode": True},
    )


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


def eliminated(matrix: FloatArray, rows: FloatArray, last: FloatArray) -> FloatArray:
    """What eliminating the unknowns of a symmetric ``A`` takes away: ``R^T A^-1 R``.

    Displacements come first and pressures last::

        A = [ matrix  C^T ]     R = [ rows[:-n]^T ]     C = rows[-n:],  last = [ ..., D ]
            [ C       D   ]         [ last[:-n]^T ]

    Parameters
    ----------
    matrix
        Of the displacements, positive definite, shape (m, m).
    rows
        Right-hand sides on the displacements, then the pressures' rows, shape (k + n, m).
    last
        The same on the pressures, whose Schur complement is negative definite, shape (k + n, n).

    Returns
    -------
    numpy.ndarray
        Shape (k, k).

    Raises
    ------
    numpy.linalg.LinAlgError
        If the matrix is singular.
    """
    pressures = last.shape[1]
    k = len(rows) - pressures
    if len(matrix) <= DENSE_LIMIT:
        try:
            root = half_solve(matrix.copy(), rows.copy())
            rest = root @ root.T
            schur = half_solve(rest[k:, k:] - last[k:], last[:k] - rest[:k, k:])
            return np.asarray(rest[:k, :k] - schur @ schur.T)
        except np.linalg.LinAlgError:
            # Round-off spoils definiteness before it spoils a pivoted factorisation.
            pass
    whole = np.block([[matrix, rows[k:].T], [rows[k:], last[k:]]])
    right = np.concatenate((rows[:k].T, last[:k].T))
    return np.asarray(right.T @ solve_symmetric(whole, right))
