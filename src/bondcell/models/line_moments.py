"""Second moment of lines parallel to the axis, each a series of particle, matrix and particle."""

from __future__ import annotations

import numpy as np

from bondcell.cell import Cell, FloatArray
from bondcell.models.double_exponential import unit_interval_rule


def moment(cell: Cell, softness_i: FloatArray, softness_j: FloatArray) -> FloatArray:
    """Integral of ``r^3 dr / (h_m + s_i h_i + s_j h_j)`` over 0 < r < R_c [m^3].

    Parameters
    ----------
    cell
        Bond cells of any shape.
    softness_i, softness_j
        Modulus of the matrix over that of the particles, 0 for rigid ones.

    Notes
    -----
    Over the smaller sphere r dr = -x dx in its height x, over the rest of the larger one likewise,
    and ``(R_c^4 - R^4)/(4 L)`` beside both. The integrands are positive and singular at most just
    outside the ends, where a double exponential rule takes them to round-off.
    """
    i_is_large = cell.radius_i >= cell.radius_j
    large = np.maximum(cell.radius_i, cell.radius_j)
    small = np.minimum(cell.radius_i, cell.radius_j)
    soft_large = np.where(i_is_large, softness_i, softness_j)
    soft_small = np.where(i_is_large, softness_j, softness_i)
    ledge = np.sqrt((large - small) * (large + small))
    total = np.zeros(np.broadcast_shapes(cell.shape, soft_large.shape))
    for point, complement, weight in unit_interval_rule():
        height, below = small * point, small * complement
        square = below * (small + height)
        tall = np.where(ledge == 0.0, height, np.hypot(ledge, height))
        dips = below + square / (large + tall)
        length = cell.gap + dips + soft_large * tall + soft_small * height
        total += weight * small * height * square / length
        tall, below = ledge * point, ledge * complement
        length = cell.gap + small + (large - ledge) + below + soft_large * tall
        total += weight * ledge * tall * (large - tall) * (large + tall) / length
    outer = cell.cylinder_radius
    beside = (outer - large) * (outer + large) * (outer**2 + large**2) / (4 * cell.length)
    return np.asarray(total + beside)
