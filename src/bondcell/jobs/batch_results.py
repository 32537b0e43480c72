"""What a batch's file holds: its points with their inputs, and the results by model."""

from __future__ import annotations

import numpy as np
import xarray as xr

from bondcell.cell import LONG_NAMES, UNITS
from bondcell.jobs.batch import Batch
from bondcell.jobs.point_hash import SCHEME
from bondcell.outputs import DETAILS, OUTPUTS, PointResults, output_attributes


def batch_dataset(batch: Batch, results: dict[str, PointResults]) -> xr.Dataset:
    """What a batch's file holds: its points with their inputs, and the results by model.

    Parameters
    ----------
    batch
        The batch.
    results
        Name -> results at its points.

    Returns
    -------
    xarray.Dataset
        The outputs on ``(model, point)``, details too if any of the results has them, and what
        `about_batch` gives.
    """
    attributes = output_attributes(batch.load)
    stacked = {
        name: np.stack([getattr(result, name) for result in results.values()]) for name in OUTPUTS
    }
    for name in DETAILS:
        if any(name in result.details for result in results.values()):
            stacked[name] = np.stack([result.detail(name) for result in results.values()])
    variables = {
        name: (("model", "point"), values, attributes[name]) for name, values in stacked.items()
    }
    return about_batch(batch).assign(variables).assign_coords(model=list(results))


def about_batch(batch: Batch) -> xr.Dataset:
    """The points of a batch and what was asked for there: enough to know the batch again.

    Returns
    -------
    xarray.Dataset
        The ten inputs on ``(point,)``; attributes ``load``, ``rows`` (JSON) and ``hash_scheme``.
    """
    inputs = {
        name: ("point", getattr(batch.points, name), {"units": unit, "long_name": LONG_NAMES[name]})
        for name, unit in UNITS.items()
    }
    about = {"load": batch.load, "rows": batch.rows_json, "hash_scheme": SCHEME}
    return xr.Dataset(inputs, attrs=about)
