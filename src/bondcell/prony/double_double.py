"""Sums carried with twice the digits of a float, for the few places where digits cancel.

A value is a pair ``(high, low)`` whose sum it is, ``|low|`` at most half a unit in the last place
of ``high``. The elementary transformations are those of Dekker and Knuth.
"""

from __future__ import annotations

import numpy as np

from bondcell.cell import FloatArray

Pair = tuple[FloatArray, FloatArray]

_SPLITTER = 134217729.0
"""``2^27 + 1``: cuts a float into two halves of 26 bits."""


def two_sum(a: FloatArray, b: FloatArray) -> Pair:
    """``a + b`` without loss.

    Examples
    --------
    >>> high, low = two_sum(np.array(1.0), np.array(1e-20))
    >>> float(high), float(low)
    (1.0, 1e-20)
    """
    total = a + b
    part = total - a
    return total, (a - (total - part)) + (b - part)


def two_product(a: FloatArray, b: FloatArray) -> Pair:
    """``a * b`` without loss, for magnitudes below 1e290."""
    product = a * b
    a_high, b_high = _high_half(a), _high_half(b)
    a_low, b_low = a - a_high, b - b_high
    error = ((a_high * b_high - product) + a_high * b_low + a_low * b_high) + a_low * b_low
    return product, error


def _high_half(a: FloatArray) -> FloatArray:
    scaled = _SPLITTER * a
    return np.asarray(scaled - (scaled - a))


def add(a: Pair, b: Pair) -> Pair:
    """Sum of two pairs."""
    high, low = two_sum(a[0], b[0])
    return two_sum(high, low + a[1] + b[1])


def quotient(a: Pair, b: Pair) -> Pair:
    """``a / b`` of two pairs."""
    first = a[0] / b[0]
    product, error = two_product(first, b[0])
    rest = (a[0] - product) - error + a[1] - first * b[1]
    return two_sum(first, rest / b[0])


def total(terms: Pair) -> Pair:
    """Sum over the last axis.

    Examples
    --------
    >>> terms = np.array([1e20, 1.0, -1e20])
    >>> float(total((terms, np.zeros(3)))[0])
    1.0
    """
    high, low = terms
    result = high[..., 0], low[..., 0]
    for k in range(1, high.shape[-1]):
        result = add(result, (high[..., k], low[..., k]))
    return result
