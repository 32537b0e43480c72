"""The slices model: every plane slice is a parallel, all slices in series."""

from __future__ import annotations

import numpy as np

from bondcell.cell import Cell, FloatArray
from bondcell.models.model import Model, Springs

RELATIVE_ERROR = 1e-14
"""Bound of the round-off, see tests/verification/test_models_mpmath.py."""


def normal(cell: Cell) -> Springs:
    """Normal stiffness of all slices in series.

    Parameters
    ----------
    cell
        Bond cells of any shape.

    Returns
    -------
    Springs
        ``K_n`` and ``k_i``, ``k_int``, ``k_j`` [N/m]: the slices through particle i with the matrix
        around it, those of the gap, those through particle j.

    Notes
    -----
    ``1/K_n = integral of dz / (E A)``, ``E A = pi E_m [R_c^2 + kappa (R_i^2 - z^2)]`` in particle
    i, ``kappa = E_i/E_m - 1``. With ``w = kappa R_i^2/R_c^2`` ``1/k_i = R_i/(pi E_m R_c^2) *
    asinh(sqrt(w)) / (sqrt(w) sqrt(1 + w))``, which is an arc tangent for w < 0 and 1 for w = 0: a
    homogeneous cell gives ``pi E R_c^2 / L`` to the last digit.

    Plane slices that do not contract are a kinematically admissible displacement: an upper bound of
    the cell if all Poisson's ratios are zero. Otherwise neighbouring slices hinder each other's
    contraction, even with equal ratios, and no bound is proven.

    Examples
    --------
    >>> cell = Cell.from_values(
    ...     radius_i=7.5e-3,
    ...     gap=5e-4,
    ...     young_i=[1.4e7, 3e10],
    ...     young_m=1.4e6,
    ...     poisson_i=0.25,
    ...     poisson_m=0.46,
    ... )
    >>> normal(cell).stiffness.round(3)
    array([ 73299.131, 490897.563])
    """
    area_modulus = np.pi * cell.young_m * cell.cylinder_radius**2
    soft_i = cell.radius_i * _mean_compliance(cell, cell.radius_i, cell.young_i)
    soft_j = cell.radius_j * _mean_compliance(cell, cell.radius_j, cell.young_j)
    with np.errstate(divide="ignore"):  # a rigid particle has an infinite spring
        k_i, k_j = area_modulus / soft_i, area_modulus / soft_j
    k_int = area_modulus / cell.gap
    stiffness = area_modulus / (soft_i + soft_j + cell.gap)
    return Springs.of_cell(cell, stiffness, RELATIVE_ERROR, k_i=k_i, k_int=k_int, k_j=k_j)


def _mean_compliance(cell: Cell, radius: FloatArray, young: FloatArray) -> FloatArray:
    """Mean of ``E_m R_c^2 / (E_m R_c^2 + (E - E_m) (R^2 - z^2))`` over 0 < z < R: 1 for E = E_m."""
    outer = cell.cylinder_radius
    share = (radius / outer) ** 2
    w = share * ((young - cell.young_m) / cell.young_m)
    matrix_share = (outer - radius) * (outer + radius) / outer**2
    # A particle much softer than the matrix: 1 + w has lost its digits, the two shares have not.
    one_plus_w = np.where(w < -0.5, matrix_share + share * (young / cell.young_m), 1.0 + w)
    root, scale = np.sqrt(np.abs(w)), np.sqrt(one_plus_w)
    with np.errstate(
        invalid="ignore", divide="ignore"
    ):  # w = 0, and inf / inf for a rigid particle
        angle = np.where(w > 0, np.arcsinh(root), np.arctan(root / scale)) / root
        mean = angle / scale
    mean = np.where(w == 0.0, 1.0, mean)
    return np.asarray(np.where(np.isinf(young), 0.0, mean))


SLICES = Model(
    name="slices",
    title="plane slices",
    summary="Slices across the axis, each a parallel of particle and matrix, all of them in "
    "series.",
    source="Derived for this project, the counterpart of the generatrix lines.",
    valid_range="Every cell. An upper bound of the stiffness if all Poisson's ratios are zero; "
    "far too stiff for stiff particles, whose slices turn rigid with the matrix "
    "around them.",
    loads={"normal": normal},
)
