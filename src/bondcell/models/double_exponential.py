"""The double exponential (tanh-sinh) quadrature rule on the unit interval."""

from __future__ import annotations

from functools import cache
from math import cosh, exp, pi, sinh

STEP = 0.03
"""Spacing of the trapezoidal rule in the stretched variable."""

REACH = 3.22
"""Where the rule is cut: the outermost points lie within 1e-17 of the ends of the interval."""


@cache
def unit_interval_rule() -> tuple[tuple[float, float, float], ...]:
    """Points, their distances from 1, and weights.

    Returns
    -------
    tuple of (point, complement, weight)
        ``point`` and ``complement = 1 - point`` each have full relative precision.

    Notes
    -----
    ``x = 1 / (1 + exp(-pi sinh u))``, trapezoidal in u. Singularities at or just outside the ends
    of the interval cost little, the reason to use it here.

    Examples
    --------
    >>> round(sum(weight * point**0.5 for point, _, weight in unit_interval_rule()), 14)
    0.66666666666667
    """
    count = round(REACH / STEP)
    rule = []
    for k in range(-count, count + 1):
        u = k * STEP
        decay = exp(-pi * abs(sinh(u)))
        near, far = decay / (1.0 + decay), 1.0 / (1.0 + decay)
        point, complement = (far, near) if u > 0 else (near, far)
        rule.append((point, complement, STEP * pi * cosh(u) * near * far))
    return tuple(rule)
