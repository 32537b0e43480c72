"""The general model: a sequential core around the axis, in parallel with the bond farther out."""

from __future__ import annotations

import numpy as np

from bondcell.cell import Cell, FloatArray
from bondcell.models.columns import Columns, annulus
from bondcell.models.fsi import matrix_is_weaker
from bondcell.models.model import Model, Springs, in_series, radius_ratio

RELATIVE_ERROR = 2e-14
"""Bound of round-off and quadrature, see tests/verification/test_models_mpmath.py."""


def normal(cell: Cell, core_radius_ratio: float | None = None) -> Springs:
    """Normal stiffness of the core and the bond around it.

    Parameters
    ----------
    cell
        Bond cells of any shape.
    core_radius_ratio
        Radius of the core, r_b / min(R_i, R_j), in (0, 1]; None chooses `film_core`.

    Returns
    -------
    Springs
        ``K_n`` and ``k_i``, ``k_lr``, ``k_j``, ``k_par`` [N/m].

    Notes
    -----
    ``K_n = 1/(1/k_i + 1/k_lr + 1/k_j) + k_par`` with ``k_i = 2 pi E_i r_b^2/(R_i + sqrt(R_i^2 -
    r_b^2))``, the constant layer ``k_lr = pi E_m r_b^2 / L_g``, and ``k_par`` the generatrix
    integral over r > r_b. The paper draws these springs (figure 3b and d) but gives no formula;
    this is the project's.

    Examples
    --------
    >>> cell = Cell.from_values(
    ...     radius_i=1.0, gap=0.02, young_i=1e3, young_m=1.0, poisson_i=0.2, poisson_m=0.2
    ... )
    >>> for ratio in (0.1, None, 1.0):
    ...     print(float(normal(cell, core_radius_ratio=ratio).stiffness.round(3)))
    11.477
    12.026
    149.6
    """
    if core_radius_ratio is None:
        square, complement = film_core(cell)
    else:
        or_none = ", or None for the default"
        ratio = np.asarray(radius_ratio("core_radius_ratio", core_radius_ratio, or_none))
        square, complement = ratio**2, (1.0 - ratio) * (1.0 + ratio)
    core_square = square * np.minimum(cell.radius_i, cell.radius_j) ** 2
    lines = Columns.outside(cell, square, complement)
    height_i, height_j = lines.heights(cell)
    k_i = 2.0 * np.pi * cell.young_i * core_square / (cell.radius_i + height_i)
    k_j = 2.0 * np.pi * cell.young_j * core_square / (cell.radius_j + height_j)
    k_lr = np.pi * cell.young_m * core_square / cell.gap
    k_par = 2.0 * np.pi * cell.young_m * (lines.integral() + annulus(cell))
    stiffness = in_series(k_i, k_lr, k_j) + k_par
    return Springs.of_cell(
        cell, stiffness, RELATIVE_ERROR, k_i=k_i, k_lr=k_lr, k_j=k_j, k_par=k_par
    )


def film_core(cell: Cell) -> tuple[FloatArray, FloatArray]:
    """Default core: up to where the matrix between the particles has about doubled its thickness.

    Returns
    -------
    square, complement
        ``(r_b / min(R_i, R_j))^2`` and one less that, each to full precision.

    Notes
    -----
    Near the axis ``h_m = L_g + r^2 / (2 R*)`` with ``1/R* = 1/R_i + 1/R_j``, twice L_g at
    ``r^2 = 2 R* L_g``. A layer of constant thickness can stand for the matrix up to about there and
    not beyond. ``1/r_b^2 = 1/(2 R* L_g) + 1/min(R_i, R_j)^2`` is that radius for a narrow gap and
    stays inside the smaller particle for a wide one. As the core shrinks with the gap, k_lr has the
    finite limit ``2 pi E_m R*``, where a core of fixed radius would turn rigid. Against finite
    elements at nu_m = 0 the model is within 20 % for 1e-3 <= L_g/R <= 1 and E_i/E_m >= 1 with this
    core; with one of 0.7 R it is up to seventy times too stiff.
    """
    large = np.maximum(cell.radius_i, cell.radius_j)
    small = np.minimum(cell.radius_i, cell.radius_j)
    doubling = 2.0 * large / (large + small) * (cell.gap / small)
    return doubling / (1.0 + doubling), 1.0 / (1.0 + doubling)


GENERAL = Model(
    name="general",
    title="general model, core and parallel bond",
    summary="A core of both particles and a constant layer in series, in parallel with the "
    "generatrix lines outside it.",
    source="Kacianauskas et al., PARTICLES 2013, figure 3b and d, which gives no formula; "
    "definition of this project.",
    valid_range="A matrix no stiffer than the particles. Poisson's effect is ignored as in fsi. "
    "The constant layer needs a core no wider than about sqrt(2 R* L_g), the "
    "default.",
    loads={"normal": normal},
    options={
        "core_radius_ratio": "Radius of the core over the smaller particle's radius, in (0, 1]; "
        "default: where the matrix between the particles has doubled its thickness."
    },
    is_valid=matrix_is_weaker,
)
