"""What a sweep's result holds: its axes with values and units, its models and references."""

from __future__ import annotations

from collections.abc import Hashable, Mapping
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from bondcell.cell import UNITS
from bondcell.models import MODELS

SAMPLE = "sample"
"""Dimension of points that are no grid; their parameters are coordinates along it."""

REFERENCE = "fe"
"""Name of the reference in the dimension ``model``; others of its kind are called ``fe_<bc>``."""


def is_reference(name: str) -> bool:
    """Whether a name of the dimension ``model`` stands for a finite element reference.

    Examples
    --------
    >>> [is_reference(name) for name in ("fe", "fe_clamped", "fsi")]
    [True, True, False]
    """
    return name == REFERENCE or name.startswith(REFERENCE + "_")


def model_names(study: xr.Dataset) -> list[str]:
    """Entries of the dimension ``model`` that cover the load, in the order of the file."""
    if "stiffness" not in study or "model" not in study["stiffness"].dims:
        return []
    load = load_name(study)
    return [str(name) for name in study["model"].values if _covers(str(name), load)]


def _covers(name: str, load: str) -> bool:
    """Whether a row of a result can hold values: a file has the same rows under every load."""
    if is_reference(name):  # only the normal load has several boundary conditions
        return load == "normal" or name == REFERENCE
    return name not in MODELS or load in MODELS[name].loads


def reference_names(study: xr.Dataset) -> list[str]:
    """Entries of the dimension ``model`` that are finite element references."""
    return [name for name in model_names(study) if is_reference(name)]


def analytic_names(study: xr.Dataset) -> list[str]:
    """Entries of the dimension ``model`` that are analytic models."""
    return [name for name in model_names(study) if not is_reference(name)]


def swept_axes(study: xr.Dataset) -> dict[str, int]:
    """Swept axes of more than one value and their lengths, in the order of the file."""
    if "stiffness" not in study:
        return {}
    sizes = study["stiffness"].sizes
    return {str(name): size for name, size in sizes.items() if name != "model" and size > 1}


def is_scattered(study: xr.Dataset) -> bool:
    """Whether the points are those of a design, no grid."""
    return "stiffness" in study and SAMPLE in study["stiffness"].dims


def parameters(study: xr.Dataset) -> list[str]:
    """What varies from point to point: swept axes, and in place of samples their parameters.

    Examples
    --------
    >>> samples = xr.Dataset(
    ...     {"stiffness": (("model", "gap", "sample"), np.ones((1, 2, 2)))},
    ...     {"gap": [1.0, 2.0], "sample": [0, 1], "poisson_m": ("sample", [0.1, 0.2])},
    ... )
    >>> parameters(samples)
    ['gap', 'poisson_m']
    """
    axes = [axis for axis in swept_axes(study) if axis != SAMPLE]
    if not is_scattered(study):
        return axes
    along = [str(name) for name, coord in study.coords.items() if coord.dims == (SAMPLE,)]
    return axes + [name for name in along if name != SAMPLE]


def grid_axes(study: xr.Dataset) -> dict[str, int]:
    """Swept axes without the samples of a design."""
    return {axis: size for axis, size in swept_axes(study).items() if axis != SAMPLE}


def parameters_at(study: xr.Dataset, point: Mapping[str, int]) -> dict[str, Any]:
    """Values of the parameters at a point.

    Parameters
    ----------
    study
        A sweep's result.
    point
        Position on each dimension.
    """
    return {
        name: axis_values(study, name)[point[SAMPLE if name not in point else name]]
        for name in parameters(study)
    }


def axis_values(study: xr.Dataset | xr.DataArray, axis: Hashable) -> NDArray[Any]:
    """Coordinate values of an axis; positions 0, 1, ... when the file has no coordinate for it."""
    if axis in study.coords:
        return np.asarray(study.coords[axis].values)
    return np.arange(study.sizes[axis])


def axis_unit(study: xr.Dataset, axis: str) -> str:
    """Unit of an axis: what the file says, else that of the input of this name, else ``1``."""
    given = study.coords[axis].attrs.get("units") if axis in study.coords else None
    return str(given or UNITS.get(axis, "1"))


def stiffness_unit(study: xr.Dataset) -> str:
    """Unit of the stiffness as UDUNITS writes it."""
    return str(study["stiffness"].attrs.get("units", "N m-1"))


def load_name(study: xr.Dataset) -> str:
    """Load of the study, the first word of the stiffness' long name."""
    if "stiffness" not in study:
        return "normal"
    return str(study["stiffness"].attrs.get("long_name", "normal")).split()[0]
