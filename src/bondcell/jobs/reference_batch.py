"""The finite element reference of a scene at the points of one batch."""

from __future__ import annotations

from typing import TYPE_CHECKING

import xarray as xr

from bondcell.by_geometry import Progress, solve_points
from bondcell.fem.reference import solve
from bondcell.jobs.batch import Batch
from bondcell.jobs.batch_results import batch_dataset

if TYPE_CHECKING:
    from bondcell.jobs.job_bounds import Bounds


def compute_reference(
    batch: Batch, progress: Progress | None = None, bounds: Bounds | None = None
) -> xr.Dataset:
    """Finite element stiffness at a batch's points, geometry by geometry.

    Parameters
    ----------
    batch
        One row of the reference.
    progress
        Called as ``progress(points_done, points)`` after each geometry.
    bounds
        Memory and time that the job has.
    """
    (row,) = batch.rows
    solver = bounds.bounded(solve) if bounds else solve
    options = dict(row.options) | row.condition
    results = solve_points(batch.points, solver, row.load, progress, **options)
    return batch_dataset(batch, {row.model: results})
