"""The cementation theory of Dvorkin, Mavko and Nur: elastic grains on a thin layer of cement."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from bondcell.cell import Cell, FloatArray
from bondcell.models.elastic_foundation import RELATIVE_ERROR, compliance_factor
from bondcell.models.model import Model, Springs, radius_ratio

LARGEST_GAP_RATIO = 0.1
"""L_g / min(R_i, R_j) up to which the layer counts as thin."""

LARGEST_POISSON = 0.3
"""nu_m up to which springs side by side can stand for the layer."""

LARGEST_MODULUS_RATIO = 0.1
"""E_m / E_i up to which the cell around the grains counts for little against the cement."""


def normal(cell: Cell, cement_radius_ratio: float = 1.0) -> Springs:
    """Normal stiffness of two elastic spheres cemented by a thin layer.

    Parameters
    ----------
    cell
        Bond cells of any shape.
    cement_radius_ratio
        Radius of the cement over the smaller particle's radius, ``a / min(R_i, R_j)``, in (0, 1].

    Returns
    -------
    Springs
        ``K_n`` [N/m], no parts; inf at poisson_m = 1/2, where the theory has no answer.

    Notes
    -----
    The layer, ``h(r) = L_g + r^2/(2 R*)`` thick with ``1/R* = 1/R_i + 1/R_j``, cannot spread
    sideways and resists like springs side by side of modulus ``M_m = E_m (1 - nu_m)/((1 + nu_m)(1
    - 2 nu_m))``; the grains settle like half-spaces. The traction p(r) on r < a solves

    ``h p / M_m + sum of (1 - nu_i^2)/(pi E_i) * integral of p dA'/|x - x'| = 1``

    and K_n is its resultant. Scaled by a it is the problem of `elastic_foundation` with
    ``G = 2 R* L_g/a^2`` and ``c = 8 R* M_m/(pi a) * sum of (1 - nu_i^2)/E_i``;
    ``K_n = 4 pi R* M_m Y(G, c)``. Rigid grains give ``2 pi R* M_m ln(1 + a^2/(2 R* L_g))``.

    The widely used polynomials S_n(alpha, Lambda_n) (Dvorkin and Nur 1996, ``K_n = pi R M_m S_n``,
    ``c = 4 Lambda_n R/a``) approximate the solution for equal grains in contact, L_g = 0. They are
    within 5 % of it for 0.1 <= Lambda_n <= 1 and off by a factor of a thousand at
    Lambda_n = 1e-4, a bitumen; so the equation itself is solved here.

    Examples
    --------
    >>> cell = Cell.from_values(
    ...     radius_i=7.5e-3,
    ...     gap=5e-4,
    ...     young_i=3e10,
    ...     young_m=1.4e6,
    ...     poisson_i=0.25,
    ...     poisson_m=[0.0, 0.46, 0.5],
    ... )
    >>> normal(cell).stiffness.round(-2)
    array([ 91400., 421700.,     inf])
    """
    ratio = radius_ratio("cement_radius_ratio", cement_radius_ratio)
    radius = ratio * np.minimum(cell.radius_i, cell.radius_j)
    curvature = 1.0 / (1.0 / cell.radius_i + 1.0 / cell.radius_j)
    modulus = oedometric_modulus(cell.young_m, cell.poisson_m)
    finite = np.isfinite(modulus)
    safe_modulus = np.where(finite, modulus, cell.young_m)
    gap = 2.0 * curvature / radius * (cell.gap / radius)
    grains = (1.0 - cell.poisson_i**2) / cell.young_i + (1.0 - cell.poisson_j**2) / cell.young_j
    flexibility = 8.0 * curvature * safe_modulus / (np.pi * radius) * grains
    stiffness = 4.0 * np.pi * curvature * safe_modulus * compliance_factor(gap, flexibility)
    return Springs.of_cell(cell, np.where(finite, stiffness, np.inf), RELATIVE_ERROR)


def oedometric_modulus(young: FloatArray, poisson: FloatArray) -> FloatArray:
    """Modulus of confined compression, inf for an incompressible material [Pa]."""
    with np.errstate(divide="ignore"):
        return np.asarray(young * (1.0 - poisson) / ((1.0 + poisson) * (1.0 - 2.0 * poisson)))


def is_thin_cement(cell: Cell) -> NDArray[np.bool_]:
    """Whether the layer is thin, compressible and softer than the grains."""
    thin = cell.gap <= LARGEST_GAP_RATIO * np.minimum(cell.radius_i, cell.radius_j)
    soft = cell.young_m <= LARGEST_MODULUS_RATIO * np.minimum(cell.young_i, cell.young_j)
    return np.broadcast_to(thin & soft & (cell.poisson_m <= LARGEST_POISSON), cell.shape)


CEMENTATION = Model(
    name="cementation",
    title="cementation theory",
    summary="Elastic half-spaces on a thin layer of cement that resists like springs side by "
    "side, the integral equation solved.",
    source="Dvorkin, Mavko and Nur, The effect of cementation on the elastic properties of "
    "granular material, Mechanics of Materials 12 (1991) 207-217; polynomials for "
    "contact: Dvorkin and Nur, Elasticity of high-porosity sandstones, Geophysics 61 "
    "(1996) 1363-1370.",
    valid_range="Thin, compressible cement, softer than the grains: gap at most a tenth of the "
    "smaller radius, poisson_m at most 0.3, E_m at most a tenth of E_i and E_j; "
    "there it is within 30 % of the finite elements (equal spheres). The layer "
    "cannot flow sideways, so the stiffness diverges as poisson_m -> 1/2.",
    loads={"normal": normal},
    options={
        "cement_radius_ratio": "Radius of the cement over the smaller particle's radius, in (0, "
        "1]; default 1: the matrix fills the cell.",
    },
    is_valid=is_thin_cement,
)
