"""Builds the data file of the surrogate: grid, fit, and its error off the grid."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

import numpy as np

from bondcell.cell import Cell, FloatArray
from bondcell.fem.reference import solve
from bondcell.fem.surrogate_grid import ORDER, sample
from bondcell.models.surrogate import LENGTH_POWER, LOADS
from bondcell.models.surrogate_axes import AXES
from bondcell.models.tucker import Tucker

TRUNCATION = 1e-5
"""Absolute error in the sum of squares over the grid that the fit may drop, a variable."""

CHECKS, SEED = 150, 20260101
"""Random cells a load on which the error is measured, and the seed that draws them."""

MARGIN = 2.0
"""The stored error is the largest one found, times this."""

BANDS = (1e-4, 1e-3, 1e-2, 1e-1, 3.0)
"""Gap over radius of the bands with an error of their own."""


def fit(values: FloatArray) -> Tucker:
    """The interpolant of a sampled grid in single precision, as it is stored."""
    tensor = Tucker.fit(values, TRUNCATION)
    return Tucker(
        tensor.core.astype(np.float32).astype(float),
        tuple(factor.astype(np.float32).astype(float) for factor in tensor.factors),
    )


def random_cells(count: int, seed: int) -> Cell:
    """Equal pairs all over the valid range, its borders included [m, Pa]."""
    rng = np.random.default_rng(seed)
    low, high = np.log(AXES.gap)
    # Squares crowd the ends: nearly rigid and nearly incompressible cells are the hard ones.
    softness = 10 ** rng.uniform(-9, 0, count) * (rng.random(count) > 0.05)
    poisson_m = 0.5 - 0.5 * rng.random(count) ** rng.choice([1, 4, 12], count)
    with np.errstate(divide="ignore"):
        young_i = 1 / softness
    return Cell.from_values(
        radius_i=1.0,
        gap=np.exp(rng.uniform(low, high, count)),
        young_i=young_i,
        young_m=1.0,
        poisson_i=rng.uniform(*AXES.poisson, count),
        poisson_m=poisson_m,
    )


def errors_by_band(tensor: Tucker, load: str, cells: Cell) -> FloatArray:
    """Largest relative error in each band of gaps against the reference, times the margin."""
    cells = cells.ravel()
    gap, softness = cells.gap, cells.young_m / cells.young_i
    compressibility = 1.5 * (1 - 2 * cells.poisson_m) / (1 + cells.poisson_m)
    coordinates = AXES.unit_coordinates(gap, softness, compressibility, cells.poisson_i)
    value = np.exp(tensor(coordinates))
    true = np.array(
        [
            solve(cells.take(slice(k, k + 1)), load, tolerance=1e-5).stiffness[0]
            for k in range(gap.size)
        ]
    )
    error = np.abs(value / true - 1)
    band = np.searchsorted(BANDS[1:-1], gap)
    return np.array([MARGIN * error[band == b].max(initial=0) for b in range(len(BANDS) - 1)])


def build(
    path: Path,
    loads: Iterable[str] = LOADS,
    provenance: dict[str, str] | None = None,
    progress: Callable[[str, int, int], None] | None = None,
    grid: Callable[..., FloatArray] = sample,
) -> None:
    """Compute and write the data file; minutes a load.

    Parameters
    ----------
    path
        Where to write.
    loads
        Loads to cover.
    provenance
        What to store about versions and machine.
    progress
        Called as ``progress(load, gaps_done, gaps)``.
    grid
        Gives the sampled values of a load.
    """
    arrays: dict[str, Any] = {"error_gaps": np.array(BANDS)}
    for load in loads:
        tell = (lambda done, all_, load=load: progress(load, done, all_)) if progress else None
        tensor = fit(grid(load, tell))
        arrays[f"{load}_core"] = tensor.core.astype(np.float32)
        for k, factor in enumerate(tensor.factors):
            arrays[f"{load}_factor_{k}"] = factor.astype(np.float32)
        arrays[f"{load}_errors"] = errors_by_band(tensor, load, random_cells(CHECKS, SEED))
    about = {
        "quantity": "log(K / (E_m R^n))",
        "powers": LENGTH_POWER,
        "nodes": AXES.shape,
        "gap": AXES.gap,
        "order": ORDER,
        "truncation": TRUNCATION,
        "checks": CHECKS,
        "seed": SEED,
        **(provenance or {}),
    }
    with path.open("wb") as stream:
        np.savez_compressed(stream, **arrays, about=np.array(json.dumps(about)))
