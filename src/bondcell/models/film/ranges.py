"""Where the trial fields resolve a cell, by what tests and samples showed."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from bondcell.cell import Cell

LONGEST = 3.0
"""Gap over the cylinder's radius beyond which the rest is a bar."""

SMALLEST_GAP = 1e-5
"""L_g / min(R_i, R_j) down to which the fields resolve the film."""

FINEST_GAP = 1e-16
"""The same below which nothing is computed: points grow with the square of the gap's logarithm."""

WIDEST = 3.0
"""R_c / max(R_i, R_j) up to which the fields were checked."""

SMALLEST_RADIUS = 0.1
"""Ratio of the radii down to which the fields were checked."""


def is_resolved(cell: Cell) -> NDArray[np.bool_]:
    """Whether the trial fields resolve the cell."""
    small = np.minimum(cell.radius_i, cell.radius_j)
    large = np.maximum(cell.radius_i, cell.radius_j)
    shape = (cell.gap >= SMALLEST_GAP * small) & (small >= SMALLEST_RADIUS * large)
    shape = shape & (cell.cylinder_radius <= WIDEST * large)
    stiff = np.minimum(cell.young_i, cell.young_j) >= cell.young_m
    return np.broadcast_to(shape & stiff & (cell.poisson_m >= 0), cell.shape)


def is_short(cell: Cell) -> NDArray[np.bool_]:
    """Whether the gap is short enough for trial fields all along it."""
    return np.broadcast_to(cell.gap <= LONGEST * cell.cylinder_radius, cell.shape)
