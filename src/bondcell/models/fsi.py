"""The fully sequential interface (FSI) model: particle, interface and particle as three springs."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from bondcell.cell import Cell, FloatArray
from bondcell.models.columns import Columns, annulus
from bondcell.models.model import Model, Springs, in_series

RELATIVE_ERROR = 1e-14
"""Bound of the round-off, see tests/verification/test_models_mpmath.py."""


def normal(cell: Cell) -> Springs:
    """Normal stiffness of the three springs in series.

    Parameters
    ----------
    cell
        Bond cells of any shape.

    Returns
    -------
    Springs
        ``K_n`` and ``k_i``, ``k_int``, ``k_j`` [N/m]; ``k_i`` is inf for a rigid particle.

    Notes
    -----
    Each spring is the integral over its own region of E dA / length:

    ``k_i = integral of E_i 2 pi r dr / sqrt(R_i^2 - r^2) = 2 pi E_i R_i``, the hemisphere and
    nothing else, whatever R_c and the other radius are;

    ``k_int = integral of E_m 2 pi r dr / h_m(r)`` over all of 0 < r < R_c, h_m being the matrix
    on the line: between both particles, beside the smaller one and around both. For equal radii
    and R_c = R it is ``2 pi E_m [(L/4) ln(L/L_g) - R/2]``;

    ``1/K_n = 1/k_i + 1/k_int + 1/k_j``.

    Examples
    --------
    >>> cell = Cell.from_values(
    ...     radius_i=7.5e-3,
    ...     gap=[1e-6, 5e-4, 0.1],
    ...     young_i=3e10,
    ...     young_m=1.4e6,
    ...     poisson_i=0.25,
    ...     poisson_m=0.46,
    ... )
    >>> normal(cell).parts["k_int"].round(4)
    array([284230.5331,  84065.1275,   2358.822 ])
    """
    k_i = particle(cell.young_i, cell.radius_i)
    k_j = particle(cell.young_j, cell.radius_j)
    k_int = interface(cell)
    stiffness = in_series(k_i, k_int, k_j)
    return Springs.of_cell(cell, stiffness, RELATIVE_ERROR, k_i=k_i, k_int=k_int, k_j=k_j)


def particle(young: FloatArray, radius: FloatArray) -> FloatArray:
    """Spring of a hemisphere, ``2 pi E R`` [N/m]."""
    return 2.0 * np.pi * young * radius


def interface(cell: Cell) -> FloatArray:
    """Spring of the matrix between rigid particles, k_int [N/m]."""
    lines = Columns.of_cell(cell, rigid=True).integral() + annulus(cell)
    return 2.0 * np.pi * cell.young_m * lines


def matrix_is_weaker(cell: Cell) -> NDArray[np.bool_]:
    """Whether the matrix is no stiffer than either particle."""
    weaker = cell.young_m <= np.minimum(cell.young_i, cell.young_j)
    return np.broadcast_to(weaker, cell.shape)


FSI = Model(
    name="fsi",
    title="fully sequential interface",
    summary="Two particle springs and an interface spring in series, each the integral of E dA "
    "over length in its own region.",
    source="Kacianauskas et al., Interaction of particles via solid interface: model and analysis, "
    "PARTICLES 2013, figure 3a and c; unequal radii and wider cylinders by the same definition.",
    valid_range="Claimed for a matrix no stiffer than the particles, any gap. It ignores "
    "Poisson's effect: of the paper's base case it misses 4 % at poisson_m = 0 but "
    "half the stiffness at 0.46, where a thin, nearly incompressible matrix has to "
    "flow sideways. Its particle springs spread the force over the whole particle: "
    "at E_i/E_m = 10 and a gap of R/1000 it is twice too stiff. A wide cylinder's "
    "matrix hangs behind the particle springs: K_n stays below k_i.",
    loads={"normal": normal},
    is_valid=matrix_is_weaker,
)
