"""Remainders of the logarithm, free of cancellation: what every integral of the models ends in."""

from __future__ import annotations

import numpy as np

from bondcell.cell import FloatArray

SERIES_LIMIT = 0.25
"""Below this magnitude of the argument the logarithm's own digits cancel; a series takes over."""

SERIES_TERMS = 9
"""Terms kept: the first one left out is below 1e-16 of the sum for |y| <= `SERIES_LIMIT`."""


def second_remainder(y: FloatArray, complement: FloatArray) -> FloatArray:
    """Logarithm less its first term, ``phi(y) = (-log(1 - y) - y) / y^2``.

    Parameters
    ----------
    y
        Argument, y < 1, any shape.
    complement
        ``1 - y``, given separately since near y = 1 only the caller knows it to full precision.

    Returns
    -------
    ndarray
        phi(y), relative error of a few units in the last place.

    Notes
    -----
    ``phi(y) = sum of y^n / (n + 2)``; theory's ``Phi`` is twice this. Every branch is computed for
    every point that is mixed with others: gathering and scattering would cost more.

    Examples
    --------
    >>> second_remainder(np.array([0.0, 0.5, 1.0 - 1e-9]), np.array([1.0, 0.5, 1e-9])).round(6)
    array([ 0.5      ,  0.772589, 19.723266])
    """
    if y.size and y.min() >= 0.5:
        return np.asarray((-np.log(complement) - y) / (y * y))
    small = np.abs(y) < SERIES_LIMIT
    if small.all():
        return _second_series(y)
    safe = np.where(small, 1.0, y)
    return np.where(small, _second_series(y), (_minus_log(y, complement) - y) / (safe * safe))


def third_remainder(y: FloatArray, complement: FloatArray) -> FloatArray:
    """Logarithm less its first two terms, ``chi(y) = (-log(1 - y) - y - y^2/2) / y^3``.

    Parameters and precision as for `second_remainder`.

    Examples
    --------
    >>> third_remainder(np.array([0.0, 0.5]), np.array([1.0, 0.5])).round(6)
    array([0.333333, 0.545177])
    """
    small = np.abs(y) < SERIES_LIMIT
    if small.all():
        return _third_series(y)
    safe = np.where(small, 1.0, y)
    direct = ((_minus_log(y, complement) - y) / (safe * safe) - 0.5) / safe
    return np.where(small, _third_series(y), direct)


def _minus_log(y: FloatArray, complement: FloatArray) -> FloatArray:
    """-log(1 - y) from whichever of y and 1 - y has the digits."""
    return -np.where(y < 0.5, np.log1p(-np.minimum(y, 0.5)), np.log(complement))


def _second_series(y: FloatArray) -> FloatArray:
    """phi(y) = 1/(2 - y) + 2 z q(z^2) / (2 - y)^2."""
    below_two = 2.0 - y
    z = y / below_two
    return np.asarray((1.0 + 2.0 * z * _inverse_tangent_tail(z) / below_two) / below_two)


def _third_series(y: FloatArray) -> FloatArray:
    """chi(y) = 1/(2 (2 - y)) + 2 q(z^2) / (2 - y)^3."""
    below_two = 2.0 - y
    tail = _inverse_tangent_tail(y / below_two)
    return np.asarray((0.5 + 2.0 * tail / (below_two * below_two)) / below_two)


def _inverse_tangent_tail(z: FloatArray) -> FloatArray:
    """q(z^2) = (atanh(z) - z) / z^3; from -log(1 - y) = 2 atanh(z) with z = y/(2 - y)."""
    square = z * z
    total = np.asarray(1.0 / (2 * SERIES_TERMS + 1))
    for term in range(SERIES_TERMS - 2, -1, -1):
        total = total * square + 1.0 / (2 * term + 3)
    return total
