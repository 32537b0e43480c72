"""The paper's specimen: eighteen spheres in a box (theory: section 5)."""

from __future__ import annotations

import numpy as np

from bondcell.lattice.packing import Packing, packing

RADIUS, GAP = 7.5e-3, 0.5e-3
"""Of all spheres and between neighbours [m]."""

ROWS = (5, 6, 7)
"""Spheres of each row, from the top; the centres of the last lie on the bottom wall."""

BOX = ((-56e-3, 56e-3), (0.0, 36e-3), (-9e-3, 9e-3))
"""Walls of x, y and z [m]."""

YOUNG_PARTICLE, POISSON_PARTICLE = 3e10, 0.25
YOUNG_MATRIX, POISSON_MATRIX = 1.4e6, 0.46
"""Elastic constants [Pa, 1]."""

LOADED = (0, 1, 2)
"""Spheres whose displacement is prescribed; the paper counts from 1."""

DISPLACEMENT = 0.5e-3
"""Prescribed displacement [m]."""

SIDE = (0, 4, 5, 10)
"""Spheres with a spring to a side wall."""

PAPER_STIFFNESS, PAPER_SIDE_STIFFNESS = 1.05e5, 1.2e2
"""Bonds and side springs of the paper's lattice [N/m]."""


def specimen_packing() -> Packing:
    """The spheres, in the paper's order: row by row from the top, each from the left.

    Examples
    --------
    >>> specimen = specimen_packing()
    >>> specimen.count, len(specimen.neighbours(cutoff=1e-3))
    (18, 37)
    """
    spacing = 2 * RADIUS + GAP
    height = spacing * np.sqrt(3) / 2
    centres = [
        (spacing * (k - (count - 1) / 2), height * (len(ROWS) - 1 - row), 0.0)
        for row, count in enumerate(ROWS)
        for k in range(count)
    ]
    return packing(centres, RADIUS, BOX)
