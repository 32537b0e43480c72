"""The four stiffnesses of every cell by its own minimisation: upper bounds."""

from __future__ import annotations

import numpy as np

from bondcell.cell import Cell, FloatArray
from bondcell.models.film import lateral
from bondcell.models.film import torsion as torsion_forms
from bondcell.models.film.energies import Assembly, least, minimum
from bondcell.models.film.normal import energies
from bondcell.models.film.ranges import LONGEST, is_short
from bondcell.models.model import Springs

RELATIVE_ERROR = 1e-4
"""Bound of quadrature and round-off, see tests/verification/test_film.py; `reduced` adds to it."""


LONG_ERROR = 5e-4
"""The same for gaps longer than the cylinder's radius, whose lines have as many points."""


LATERAL_BATCH = 4
"""Geometries assembled at once under shear and bending, whose fields have more parts."""


def normal(cell: Cell) -> Springs:
    """Normal stiffness: least energy over fields that join film, particles and cylinder.

    Parameters
    ----------
    cell
        Bond cells of any shape. Those that share geometry and Poisson's ratios of the particles
        share the assembly, which is most of the cost.

    Returns
    -------
    Springs
        ``K_n`` [N/m], no parts. The exact K_n between frictionless plates is not above it, but for
        quadrature, round-off and the bar of long gaps.

    Notes
    -----
    ``K_n = min 2 U(u)`` over displacements u that move end plane j by 1 and keep plane i, with the
    trial fields of `fields` in the matrix and of `particles` in the particles. Nothing
    is calibrated. A gap longer than `LONGEST` radii is a cell of that gap in series with a bar,
    ``pi E_m R_c^2`` over the rest of the length: Saint-Venant's principle.

    Examples
    --------
    >>> cell = Cell.from_values(
    ...     radius_i=7.5e-3,
    ...     gap=5e-4,
    ...     young_i=3e10,
    ...     young_m=1.4e6,
    ...     poisson_i=0.25,
    ...     poisson_m=0.46,
    ... )
    >>> float(normal(cell).stiffness.round(-2))  # finite elements: 162461
    162700.0
    """
    flat = cell.ravel()
    scale = np.maximum(flat.radius_i, flat.radius_j)
    outer = flat.cylinder_radius / scale
    gap = np.minimum(flat.gap / scale, LONGEST * outer)
    value, loss = minimum(flat, gap, energies, least)
    value /= 1 + value * (flat.gap / scale - gap) / (np.pi * outer**2)
    return _springs(cell, value * flat.young_m * scale, loss)


def torsion(cell: Cell) -> Springs:
    """Stiffness against torsion: least energy over trial rotations.

    Parameters
    ----------
    cell
        Bond cells of any shape.

    Returns
    -------
    Springs
        ``K_t`` [N m/rad], no parts; an upper bound as the normal stiffness is.

    Notes
    -----
    See `torsion.energies`. A long gap is in series with a bar, ``G_m pi R_c^4/2`` over its length.

    Examples
    --------
    >>> cell = Cell.from_values(
    ...     radius_i=7.5e-3,
    ...     gap=5e-4,
    ...     young_i=3e10,
    ...     young_m=1.4e6,
    ...     poisson_i=0.25,
    ...     poisson_m=0.46,
    ... )
    >>> float(torsion(cell).stiffness.round(3))  # finite elements: 0.52188
    0.522
    """
    flat = cell.ravel()
    scale = np.maximum(flat.radius_i, flat.radius_j)
    outer = flat.cylinder_radius / scale
    gap = np.minimum(flat.gap / scale, LONGEST * outer)
    value, loss = minimum(flat, gap, torsion_forms.energies, least)
    bar = np.pi * outer**4 / (4 * (1 + flat.poisson_m))
    value /= 1 + value * (flat.gap / scale - gap) / bar
    return _springs(cell, value * flat.young_m * scale**3, loss)


def shear(cell: Cell) -> Springs:
    """Stiffness against shear with both end planes held: least energy over trial displacements.

    Parameters
    ----------
    cell
        Bond cells of any shape.

    Returns
    -------
    Springs
        ``K_s`` [N/m], no parts; an upper bound. NaN where the gap is longer than `LONGEST` radii.

    Notes
    -----
    See `lateral`.

    Examples
    --------
    >>> cell = Cell.from_values(
    ...     radius_i=7.5e-3,
    ...     gap=5e-4,
    ...     young_i=3e10,
    ...     young_m=1.4e6,
    ...     poisson_i=0.25,
    ...     poisson_m=0.46,
    ... )
    >>> float(shear(cell).stiffness.round(-2))  # finite elements: 29586
    29600.0
    """
    return _lateral(cell, lateral.shear_energies, power=1)


def bending(cell: Cell) -> Springs:
    """Stiffness against bending, plane j turning about its centre: least energy.

    Parameters
    ----------
    cell
        Bond cells of any shape.

    Returns
    -------
    Springs
        ``K_b`` [N m/rad], no parts; an upper bound. NaN where the gap is longer than `LONGEST`
        radii.

    Notes
    -----
    See `lateral`.

    Examples
    --------
    >>> cell = Cell.from_values(
    ...     radius_i=7.5e-3,
    ...     gap=5e-4,
    ...     young_i=3e10,
    ...     young_m=1.4e6,
    ...     poisson_i=0.25,
    ...     poisson_m=0.46,
    ... )
    >>> float(bending(cell).stiffness.round(2))  # finite elements: 2.5804
    2.58
    """
    return _lateral(cell, lateral.bending_energies, power=3)


def _lateral(cell: Cell, assemble: Assembly, power: int) -> Springs:
    flat = cell.ravel()
    value, loss = np.full(flat.radius_i.shape, np.nan), np.zeros(flat.radius_i.shape)
    short = np.flatnonzero(is_short(flat))
    if short.size:
        own = flat.take(short)
        scale = np.maximum(own.radius_i, own.radius_j)
        found, loss[short] = minimum(
            own, own.gap / scale, assemble, least, mirrors=False, batch=LATERAL_BATCH
        )
        value[short] = found * own.young_m * scale**power
    return _springs(cell, value, loss)


def _springs(cell: Cell, stiffness: FloatArray, loss: FloatArray) -> Springs:
    flat = cell.ravel()
    own = np.where(flat.gap > flat.cylinder_radius, LONG_ERROR, RELATIVE_ERROR)
    error = (own + loss).reshape(cell.shape)
    return Springs.of_cell(cell, stiffness.reshape(cell.shape), error)
