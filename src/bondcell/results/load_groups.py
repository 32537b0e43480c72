"""The loads of a scene's file: the first in the root group, each other one in a group."""

from __future__ import annotations

from pathlib import Path

import xarray as xr

from bondcell.cell import UNITS
from bondcell.errors import DataError
from bondcell.outputs import STIFFNESS_UNITS
from bondcell.results.view import load_name
from bondcell.storage import read_dataset


def read_loads(path: str | Path) -> dict[str, xr.Dataset]:
    """Results of a scene by load, each with the scene's inputs.

    Parameters
    ----------
    path
        A scene's study.nc.

    Returns
    -------
    dict
        Load -> result on ``(model, axes...)``, the root group's first; a file without points (of
        convergence studies alone) has its root only.
    """
    root = read_dataset(path)
    if "stiffness" not in root:
        return {"normal": root}
    inputs = root[[name for name in UNITS if name in root.data_vars]]
    found = {load_name(root): root}
    for load in STIFFNESS_UNITS:
        if load not in found:
            try:
                group = read_dataset(path, group=load)
            except DataError as error:
                if error.violations[0].field != "group":
                    raise
            else:
                found[load] = group.assign(inputs)
    return found
