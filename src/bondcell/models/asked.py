"""An analytic model's answer with what became of each point."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bondcell.cell import Cell
from bondcell.models.model import Model, Springs
from bondcell.status import Status


def ask(model: Model, load: str, cell: Cell, **options: Any) -> tuple[Springs, NDArray[np.int8]]:
    """Evaluate a model and flag every point.

    Parameters
    ----------
    model
        An analytic model.
    load
        One of its loads.
    cell
        Bond cells of any shape.
    **options
        Its options.

    Returns
    -------
    Springs
        The model's answer; stiffness and error are NaN where the stiffness is no finite number.
    numpy.ndarray
        `Status` codes of the cell's shape: ``diverges`` there, or ``not_computed`` where a model
        has no value outside its valid range; else ``outside_valid_range`` or ``ok``.

    Examples
    --------
    >>> from bondcell.models import MODELS
    >>> cell = Cell.from_values(
    ...     radius_i=1.0,
    ...     gap=0.02,
    ...     young_i=1e3,
    ...     young_m=[1.0, 1e4],
    ...     poisson_i=0.2,
    ...     poisson_m=0.2,
    ... )
    >>> springs, status = ask(MODELS["fsi"], "normal", cell)
    >>> [Status(code).name for code in status]
    ['ok', 'outside_valid_range']
    """
    with np.errstate(divide="ignore", over="ignore", invalid="ignore"):
        springs = model.loads[load](cell, **options)
    outside = ~model.holds(load, cell)
    status = np.where(outside, Status.outside_valid_range, Status.ok).astype(np.int8)
    missing = ~np.isfinite(springs.stiffness)
    if not np.any(missing):
        return springs, status
    known = replace(
        springs,
        stiffness=np.where(missing, np.nan, springs.stiffness),
        relative_error=np.where(missing, np.nan, springs.relative_error),
    )
    silent = np.isnan(springs.stiffness) & outside
    reason = np.where(silent, Status.not_computed, Status.diverges).astype(np.int8)
    return known, np.where(missing, reason, status)
