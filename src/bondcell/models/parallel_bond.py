"""The parallel bond of the bonded-particle model, as a discrete element code would set it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from bondcell.cell import Cell
from bondcell.models.model import Model, Springs, radius_ratio

RELATIVE_ERROR = 2e-15
"""Bound of the round-off of six operations."""

LARGEST_GAP_RATIO = 0.1
"""L_g / (R_i + R_j) up to which particles count as touching; also the error of the length."""


def normal(cell: Cell, bond_radius_ratio: float = 1.0) -> Springs:
    """Normal stiffness of a cylinder of cement between the particle centres.

    Parameters
    ----------
    cell
        Bond cells of any shape.
    bond_radius_ratio
        Radius multiplier, bond radius over min(R_i, R_j), in (0, 1].

    Returns
    -------
    Springs
        ``K_n`` [N/m], no parts.

    Notes
    -----
    Potyondy and Cundall give the bond the stiffness per area ``k = E / (R_i + R_j)`` over the
    disk of radius ``R = lambda min(R_i, R_j)``:

    ``K_n = pi R^2 E_m / (R_i + R_j)``, an elastic beam from centre to centre.

    The bond's modulus is a free parameter of theirs, calibrated to the macroscopic modulus; here
    it is the matrix', the value a user has at hand. The contact springs of the particles (4 R E
    each, in series) act beside the bond, but only while the particles overlap: across a gap they
    carry nothing, and neither the gap nor E_i, E_j enter.

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
    >>> float(normal(cell).stiffness.round(3))
    16493.361
    """
    ratio = radius_ratio("bond_radius_ratio", bond_radius_ratio)
    bond_radius = ratio * np.minimum(cell.radius_i, cell.radius_j)
    stiffness = np.pi * bond_radius**2 * cell.young_m / (cell.radius_i + cell.radius_j)
    return Springs.of_cell(cell, stiffness, RELATIVE_ERROR)


def is_nearly_touching(cell: Cell) -> NDArray[np.bool_]:
    """Whether the gap is small against the bond's length."""
    touching = cell.gap <= LARGEST_GAP_RATIO * (cell.radius_i + cell.radius_j)
    return np.broadcast_to(touching, cell.shape)


PARALLEL_BOND = Model(
    name="parallel_bond",
    title="parallel bond",
    summary="A cylinder of matrix from one particle's centre to the other's.",
    source="Potyondy and Cundall, A bonded-particle model for rock, Int. J. Rock Mech. Min. Sci. "
    "41 (2004) 1329-1364, with the bond's modulus equal to the matrix'.",
    valid_range="Nearly touching particles, gap at most a tenth of R_i + R_j. The stiffness knows "
    "neither the gap nor the particles' moduli: in practice the bond's modulus is calibrated.",
    loads={"normal": normal},
    options={
        "bond_radius_ratio": "Radius multiplier: bond radius over the smaller particle's radius, "
        "in (0, 1]; default 1."
    },
    is_valid=is_nearly_touching,
)
