"""A bank of springs for a model that has values but no formula: non-negative least squares.

The stiffness of any bond between elastic particles is ``K_0 + sum m X/(1 + a X)`` in one modulus of
the matrix, with a spectrum of softness that a fine fixed grid stands for. What the fit misses is
measured and reported.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from bondcell.cell import FloatArray
from bondcell.prony.bank import Bank

PER_DECADE = 6
"""Grid points of softness a decade."""

MARGIN = 1e3
"""How far the grid reaches beyond the moduli sampled."""

LOWEST = 1e-9
"""Least share of the modulus sampled: a fluid ends in ``K_0 + m X``."""


def sampled_bank(
    stiffness: Callable[[FloatArray], FloatArray], largest: FloatArray, lowest_share: float
) -> tuple[Bank, FloatArray]:
    """Fit a bank to values.

    Parameters
    ----------
    stiffness
        K of all points at given shares of the largest modulus, shape (shares, points).
    largest
        Modulus at t = 0 [Pa], shape (points,).
    lowest_share
        Long-term modulus over it.

    Returns
    -------
    Bank
        In units of `largest`.
    ndarray
        Largest relative error at the samples, NaN where K has no value, shape (points,).
    """
    low = max(lowest_share, LOWEST)
    decades = -np.log10(low)
    shares = np.geomspace(low, 1.0, int(np.ceil(PER_DECADE * decades)) + 8)
    values = stiffness(shares)
    reach = np.log10(MARGIN)
    count = int(np.ceil(PER_DECADE * (decades + 2 * reach)))
    from scipy.optimize import nnls  # slow to load, and the models' banks need none

    softness = np.concatenate(([0.0], np.geomspace(1 / MARGIN, MARGIN / low, count)))
    x = shares[:, None]
    table = np.column_stack([np.ones(x.size), x * (1 + softness) / (1 + softness * x)])
    points = largest.size
    weights, error = np.zeros((points, table.shape[1])), np.full(points, np.nan)
    for k in np.flatnonzero(np.isfinite(values).all(axis=0)):
        rows = table / values[:, k, None]
        # A constant that only fits the noise of the lowest samples would end a fluid's flow.
        keep_constant = values[0, k] > 10 * low * values[-1, k]
        rows[:, 0] *= keep_constant
        weights[k], _ = nnls(rows, np.ones(x.size))
        weights[k, 0] *= keep_constant
        error[k] = np.abs(rows @ weights[k] - 1).max()
    strength = weights[:, 1:] * (1 + softness) / largest[:, None]
    return Bank(strength, softness / largest[:, None], weights[:, 0]), error
