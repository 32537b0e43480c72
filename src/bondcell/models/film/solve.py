"""Least energy of trial fields on one geometry, for any number of materials."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bondcell.cell import FloatArray

POINTS = 32
"""Systems formed at once, to stay in the cache."""

RIDGE = 1e-13
"""Added to the scaled matrix: fields that nearly repeat each other do no harm."""

RIDGE_SHARE = 5.0
"""Each decade less of the ridge gives about as much again: this many are counted."""


@dataclass(frozen=True)
class Solved:
    """Where the energy is least.

    Parameters
    ----------
    energy
        ``x . A x``.
    loss
        What the ridge has to do with it, relative: it holds back fields that nearly repeat others.
    fields
        ``x``, with ``x_0 = 1``, shape (n,).
    factor
        Lower Cholesky factor of the scaled matrix less its first row and column.
    scale
        ``1/sqrt(A_kk)``, shape (n,).
    """

    energy: float
    loss: float
    fields: FloatArray
    factor: FloatArray
    scale: FloatArray


def solved(matrix: FloatArray, ridge: float = RIDGE) -> Solved:
    """Minimise ``x . A x`` over all x with ``x_0 = 1``; overwrites the matrix, shape (n, n).

    Notes
    -----
    With the scaled matrix, b its first column below the first row and S the rest, ``(S + ridge) y =
    -b`` and the energy at that y is ``A_00 + y . b - ridge y . y``: a bound, not an estimate.
    """
    from scipy.linalg import lapack  # slow to load, and who reads results solves none

    scale = 1 / np.sqrt(matrix.diagonal())
    matrix *= scale
    matrix *= scale[:, None]
    column = matrix[1:, 0]
    inner = matrix[1:, 1:].copy(order="F")
    np.einsum("kk->k", inner)[:] += ridge
    factor, found, info = lapack.dposv(inner, -column, lower=1, overwrite_a=1)
    if info:
        # Round-off at extreme ratios of moduli can spoil a tiny eigenvalue's sign.
        inner = matrix[1:, 1:] + ridge * np.eye(column.size)
        factor, found = np.full_like(inner, np.nan), np.linalg.solve(inner, -column)
    held = ridge * (found @ found)
    energy = matrix[0, 0] + column @ found - held
    fields = np.concatenate(([1.0], found * scale[1:] / scale[0]))
    return Solved(float(energy / scale[0] ** 2), float(held / energy), fields, factor, scale)


def combined(forms: FloatArray, factors: FloatArray) -> FloatArray:
    """``sum of factors_q forms_q``, (points, q) and (q, n, n) -> (points, n, n)."""
    shape = (factors.shape[0], *forms.shape[1:])
    return np.asarray((factors @ forms.reshape(forms.shape[0], -1)).reshape(shape))


def least_energies(forms: FloatArray, factors: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Least energies of points, one system each, and what the ridge adds, relative.

    Parameters
    ----------
    forms
        Quadratic forms of the fields, the lift first, shape (q, n, n).
    factors
        The points' moduli, what each form is multiplied by, shape (points, q).
    """
    value, loss = np.empty(factors.shape[0]), np.empty(factors.shape[0])
    for first in range(0, value.size, POINTS):
        for k, matrix in enumerate(combined(forms, factors[first : first + POINTS]), first):
            found = solved(matrix)
            value[k], loss[k] = found.energy, RIDGE_SHARE * found.loss
    return value, loss
