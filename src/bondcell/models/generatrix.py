"""The generatrix model: every line parallel to the axis is a series, all lines in parallel."""

from __future__ import annotations

import numpy as np

from bondcell.cell import Cell
from bondcell.models.columns import Columns, annulus
from bondcell.models.model import Model, Springs

RELATIVE_ERROR = 2e-14
"""Bound of round-off and quadrature, see tests/verification/test_models_mpmath.py."""


def normal(cell: Cell) -> Springs:
    """Normal stiffness of all lines in parallel.

    Parameters
    ----------
    cell
        Bond cells of any shape.

    Returns
    -------
    Springs
        ``K_n`` [N/m], no parts.

    Notes
    -----
    ``K_n = integral of dA / (h_i/E_i + h_m/E_m + h_j/E_j)`` over 0 < r < R_c. The uniaxial stress
    of each line balances itself and leaves the sides free, so at any Poisson's ratio K_n is a
    lower bound of the cell between frictionless rigid plates (``bc=roller``).

    Examples
    --------
    A homogeneous cell is a bar, ``pi E R_c^2 / L``:

    >>> cell = Cell.from_values(
    ...     radius_i=1.0, gap=2.0, young_i=4.0, young_m=4.0, poisson_i=0.2, poisson_m=0.2
    ... )
    >>> float(normal(cell).stiffness / np.pi)
    1.0
    """
    lines = Columns.of_cell(cell).integral() + annulus(cell)
    return Springs.of_cell(cell, 2.0 * np.pi * cell.young_m * lines, RELATIVE_ERROR)


GENERATRIX = Model(
    name="generatrix",
    title="generatrix lines",
    summary="Lines parallel to the axis, each a series of particle, matrix and particle, all of "
    "them in parallel.",
    source="Derived for this project from the generatrix idea of Kacianauskas et al., PARTICLES "
    "2013, section 4.",
    valid_range="Every cell: a rigorous lower bound of the stiffness between frictionless plates "
    "at any Poisson's ratio. As an estimate it is close for poisson_m near 0 only.",
    loads={"normal": normal},
)
