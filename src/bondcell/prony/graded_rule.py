"""Gauss quadrature of an interval that refines toward both ends as far as the integrand needs."""

from __future__ import annotations

import numpy as np
from numpy.polynomial.legendre import leggauss

from bondcell.cell import FloatArray

DIGITS = 40.0
"""Natural logarithm of one over the relative error aimed at, with room to spare."""


def graded_rule(
    length: FloatArray, start: FloatArray, end: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Points, their distances from the upper end, and weights for the interval [0, length].

    Parameters
    ----------
    length
        Of each interval, shape (points,), may be zero.
    start
        Distance from 0 of the integrand's singularities there, in any direction but upward.
    end
        Distance from the upper end of its singularities beyond, on the real axis.

    Returns
    -------
    tuple of ndarray
        Each of shape (points, n); points and distances both to full relative precision.

    Notes
    -----
    The lower half is ``v = start sinh y``, the upper one ``length - v = end (e^y - 1)``: in y the
    singularities are about pi/4 and pi away, however near they are in v. Gauss-Legendre with n
    points over a range l gains ``2 ln rho`` digits a point, ``rho = d + sqrt(1 + d^2)``, ``d``
    twice that distance over l.

    Examples
    --------
    >>> v, rest, w = graded_rule(np.ones(1), np.ones(1), np.array([1e-12]))
    >>> bool(abs((w / (1e-12 + rest)).sum() / np.log1p(1e12) - 1) < 1e-14)
    True
    """
    positive = np.where(length > 0, length, 1.0)
    start, end = np.minimum(start, positive), np.minimum(end, positive)
    low, high = np.arcsinh(positive / 2 / start), np.log1p(positive / 2 / end)
    t, w = _unit_gauss(low.max(), np.pi / 4)
    y = low[:, None] * t
    lower = start[:, None] * np.sinh(y)
    lower_weight = start[:, None] * np.cosh(y) * low[:, None] * w
    t, w = _unit_gauss(high.max(), np.pi)
    y = high[:, None] * t
    upper = end[:, None] * np.expm1(y)
    upper_weight = end[:, None] * np.exp(y) * high[:, None] * w
    whole = positive[:, None]
    share = np.where(length > 0, 1.0, 0.0)[:, None]
    return (
        np.concatenate((lower, whole - upper), axis=1) * share,
        np.concatenate((whole - lower, upper), axis=1) * share,
        np.concatenate((lower_weight, upper_weight), axis=1) * share,
    )


def _unit_gauss(length: float, distance: float) -> tuple[FloatArray, FloatArray]:
    """Gauss-Legendre on [0, 1] for singularities at ``distance`` from a range of ``length``."""
    d = 2 * distance / max(length, 1.0)
    count = int(np.ceil(DIGITS / (2 * np.log(d + np.hypot(1, d))))) + 2
    node, weight = leggauss(count)
    return (node + 1) / 2, weight / 2
