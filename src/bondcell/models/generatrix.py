"""The generatrix model: every line parallel to the axis is a series, all lines in parallel."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from bondcell.cell import Cell, FloatArray
from bondcell.models.columns import Columns, annulus
from bondcell.models.line_moments import moment
from bondcell.models.model import Model, Springs

MOMENT_ERROR = 1e-12
"""The same of torsion and bending."""

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


def shear(cell: Cell) -> Springs:
    """Stiffness against shear, end planes held: all lines in parallel.

    Parameters
    ----------
    cell
        Bond cells of any shape.

    Returns
    -------
    Springs
        ``K_s`` [N/m], no parts.

    Notes
    -----
    ``K_s = integral of dA / (h_i/G_i + h_m/G_m + h_j/G_j)``: the normal stiffness with shear
    moduli. The lines drag each other along, so this is no bound.
    """
    lines = normal(
        replace(
            cell,
            young_i=_shear_modulus(cell.young_i, cell.poisson_i),
            young_j=_shear_modulus(cell.young_j, cell.poisson_j),
            young_m=_shear_modulus(cell.young_m, cell.poisson_m),
        )
    )
    return Springs.of_cell(cell, lines.stiffness, RELATIVE_ERROR)


def torsion(cell: Cell) -> Springs:
    """Stiffness against torsion: all lines in parallel.

    Parameters
    ----------
    cell
        Bond cells of any shape.

    Returns
    -------
    Springs
        ``K_t`` [N m/rad], no parts.

    Notes
    -----
    ``K_t = integral of r^2 dA / (h_i/G_i + h_m/G_m + h_j/G_j)``. The shear stress along the lines
    balances itself and leaves the sides free: a lower bound. It leaves out the stress between
    cylindrical shells that twist differently.
    """
    modulus = _shear_modulus(cell.young_m, cell.poisson_m)
    soft_i = modulus / _shear_modulus(cell.young_i, cell.poisson_i)
    soft_j = modulus / _shear_modulus(cell.young_j, cell.poisson_j)
    value = 2.0 * np.pi * modulus * moment(cell, soft_i, soft_j)
    return Springs.of_cell(cell, value, MOMENT_ERROR)


def bending(cell: Cell) -> Springs:
    """Stiffness against bending, plane j turning about its centre: all lines in parallel.

    Parameters
    ----------
    cell
        Bond cells of any shape.

    Returns
    -------
    Springs
        ``K_b`` [N m/rad], no parts.

    Notes
    -----
    ``K_b = integral of x^2 dA / (h_i/E_i + h_m/E_m + h_j/E_j) + K_s l^2``: turning the plane by 1
    opens the lines by x and slides the middle of the gap by its distance ``l = R_j + L_g/2`` from
    the plane.
    """
    lines = moment(cell, cell.young_m / cell.young_i, cell.young_m / cell.young_j)
    arm = cell.radius_j + cell.gap / 2
    value = np.pi * cell.young_m * lines + shear(cell).stiffness * arm**2
    return Springs.of_cell(cell, value, MOMENT_ERROR)


def _shear_modulus(young: FloatArray, poisson: FloatArray) -> FloatArray:
    return np.asarray(young / (2 * (1 + poisson)))


GENERATRIX = Model(
    name="generatrix",
    title="generatrix lines",
    summary="Lines parallel to the axis, each a series of particle, matrix and particle, all of "
    "them in parallel.",
    source="Derived for this project from the generatrix idea of Kacianauskas et al., PARTICLES "
    "2013, section 4.",
    valid_range="Every cell: a rigorous lower bound of the stiffness between frictionless plates "
    "at any Poisson's ratio, and of the torsion. As an estimate of the normal stiffness it is "
    "close for poisson_m near 0 only; shear within some per cent, torsion and bending too soft.",
    loads={"normal": normal, "shear": shear, "torsion": torsion, "bending": bending},
)
