"""What a batch's file holds: results by model at points named by their position in the study."""

from __future__ import annotations

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from bondcell.outputs import DETAILS, OUTPUTS, PointResults, output_attributes


def batch_dataset(
    positions: NDArray[np.int64], results: dict[str, PointResults], load: str
) -> xr.Dataset:
    """What a batch's file holds: results by model at points named by their position.

    Parameters
    ----------
    positions
        Positions of the points in the raveled study, shape (points,).
    results
        Name -> results at these points.
    load
        Load name.

    Returns
    -------
    xarray.Dataset
        The outputs on ``(model, point)``, details too if any of the results has them, and
        ``point_index(point)``.
    """
    attributes = output_attributes(load)
    stacked = {
        name: np.stack([getattr(result, name) for result in results.values()]) for name in OUTPUTS
    }
    for name in DETAILS:
        if any(name in result.details for result in results.values()):
            stacked[name] = np.stack([result.detail(name) for result in results.values()])
    index = {"long_name": "position of the point in the raveled study", "units": "1"}
    return xr.Dataset(
        {name: (("model", "point"), values, attributes[name]) for name, values in stacked.items()}
        | {"point_index": ("point", positions, index)},
        {"model": list(results)},
        {"load": load},
    )
