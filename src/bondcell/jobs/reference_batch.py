"""The finite element reference of a scene at the points of one batch."""

from __future__ import annotations

from typing import TYPE_CHECKING

import xarray as xr

from bondcell.by_geometry import Progress, solve_points
from bondcell.errors import InputError, Violation
from bondcell.fem.reference import solve
from bondcell.inputs import cell_from_study
from bondcell.jobs.batch import REFERENCE, Batch, cell_at
from bondcell.jobs.batch_results import batch_dataset

if TYPE_CHECKING:
    from bondcell.jobs.job_bounds import Bounds

OTHER_LOADS = ("shear", "torsion", "bending")
"""Loads without boundary conditions to choose from."""


def compute_reference(
    study: xr.Dataset,
    batch: Batch,
    tolerance: float,
    progress: Progress | None = None,
    bounds: Bounds | None = None,
) -> xr.Dataset:
    """Finite element stiffness at the batch's points, geometry by geometry.

    Parameters
    ----------
    study
        Inputs of the whole scene.
    batch
        Which of its geometries; its method ends in a boundary condition of the normal load, or in
        another load.
    tolerance
        Relative error at which refinement stops.
    progress
        Called as ``progress(points_done, points)`` after each geometry.
    bounds
        Memory and time that the job has.
    """
    method, _, variant = batch.method.partition("_")
    if method != REFERENCE or not variant:
        allowed = f"{REFERENCE}_<boundary condition or load>_<part>of<parts>"
        raise InputError([Violation("batch", batch.name, allowed)])
    load = variant if variant in OTHER_LOADS else "normal"
    options = {"bc": variant} if load == "normal" else {}
    cell, _ = cell_from_study(study)
    positions = batch.points(cell)
    solver = bounds.bounded(solve) if bounds else solve
    results = solve_points(
        cell_at(cell, positions), solver, load, progress, tolerance=tolerance, **options
    )
    return batch_dataset(positions, {batch.method: results}, load)
