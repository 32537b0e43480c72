"""The reference at the price of a formula: interpolated finite element stiffness of equal pairs.

For two equal spheres in a cylinder of their own radius the stiffness is a smooth function of four
dimensionless numbers. It was computed by the finite element reference on a Chebyshev grid, squeezed
(`tucker.Tucker`) and stored with its provenance in ``data/surrogate.npz``.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache, partial
from importlib.resources import files

import numpy as np
from numpy.typing import NDArray

from bondcell.cell import Cell, FloatArray
from bondcell.models.model import Model, Springs
from bondcell.models.surrogate_axes import AXES
from bondcell.models.tucker import Tucker

LOADS = ("normal", "shear", "torsion", "bending")
"""Loads that the data covers."""

LENGTH_POWER = {"normal": 1, "shear": 1, "torsion": 3, "bending": 3}
"""The stiffness is this power of the radius times the matrix's Young's modulus."""


@dataclass(frozen=True)
class Fit:
    """One load's interpolant of ``log(K / (E_m R^n))`` and its error by gap.

    Parameters
    ----------
    tensor
        The interpolant.
    gaps
        Bounds of gap over radius of the bands in which the error was measured, ascending.
    errors
        Largest relative error found in each band against solves off the grid, with a margin.
    """

    tensor: Tucker
    gaps: FloatArray
    errors: FloatArray


def is_inside(cell: Cell) -> NDArray[np.bool_]:
    """Equal pairs within the ranges of `surrogate_axes.AXES`."""
    same = np.ones(cell.shape, dtype=bool)
    for one, other in (
        (cell.radius_i, cell.radius_j),
        (cell.young_i, cell.young_j),
        (cell.poisson_i, cell.poisson_j),
        (cell.radius_i, cell.cylinder_radius),
    ):
        same &= one == other
    ratio = cell.gap / cell.radius_i
    # A gap given as a multiple of the radius may miss the end of the range by a rounding.
    inside = (ratio >= AXES.gap[0] * (1 - 1e-12)) & (ratio <= AXES.gap[1] * (1 + 1e-12))
    inside = inside & (cell.young_i >= cell.young_m) & (cell.poisson_m >= 0)
    low, high = AXES.poisson
    return np.asarray(same & inside & (cell.poisson_i >= low) & (cell.poisson_i <= high))


def stiffness(cell: Cell, load: str) -> Springs:
    """Stiffness of equal pairs; NaN outside the data.

    Parameters
    ----------
    cell
        Any broadcastable cell.
    load
        One of `LOADS`.
    """
    inside = is_inside(cell)
    own = cell.ravel().take(inside.ravel())
    fit = _load_fit(load)
    gap = np.clip(own.gap / own.radius_i, *AXES.gap)
    softness = own.young_m / own.young_i
    compressibility = 1.5 * (1 - 2 * own.poisson_m) / (1 + own.poisson_m)
    coordinates = AXES.unit_coordinates(gap, softness, compressibility, own.poisson_i)
    scale = own.young_m * own.radius_i ** LENGTH_POWER[load]
    value, error = np.full(cell.shape, np.nan), np.full(cell.shape, np.nan)
    value[inside] = scale * np.exp(fit.tensor(coordinates))
    error[inside] = fit.errors[np.searchsorted(fit.gaps[1:-1], gap)]
    return Springs(value, relative_error=error)


@lru_cache(maxsize=len(LOADS))
def _load_fit(load: str) -> Fit:
    source = files("bondcell.models").joinpath("data/surrogate.npz")
    with source.open("rb") as stream, np.load(stream, allow_pickle=False) as data:
        factors = tuple(data[f"{load}_factor_{k}"].astype(float) for k in range(4))
        tensor = Tucker(data[f"{load}_core"].astype(float), factors)
        return Fit(tensor, data["error_gaps"], data[f"{load}_errors"])


_FUNCTIONS: dict[str, Callable[..., Springs]] = {
    load: partial(stiffness, load=load) for load in LOADS
}

SURROGATE = Model(
    name="surrogate",
    title="interpolated finite elements",
    summary="The finite element reference of equal pairs, interpolated in four numbers.",
    source="This project: the finite element reference on a Chebyshev grid.",
    valid_range="Two equal spheres in a cylinder of their radius (roller), 1e-4 <= gap/R <= 3, "
    "E_i >= E_m up to rigid, 0 <= nu_m <= 1/2, 0 <= nu_i <= 0.45; NaN elsewhere.",
    loads=_FUNCTIONS,
    is_valid=is_inside,
    from_reference=True,
)
