"""Axes that reach infinity get a companion that can be drawn."""

from __future__ import annotations

import numpy as np
import xarray as xr

PREFIX = "inverse_"
"""Begin of the companion's name."""


def with_finite_axes(dataset: xr.Dataset) -> xr.Dataset:
    """The dataset with the reciprocal of every axis that reaches infinity, as a coordinate on it.

    Rigid particles are an infinite ratio of moduli, which no map can place: a plot over the
    reciprocal, zero for rigid particles, shows them.

    Parameters
    ----------
    dataset
        Results on their axes.

    Examples
    --------
    >>> axis = ("modulus_ratio", [1.0, 100.0, np.inf], {"units": "1", "long_name": "E_i/E_m"})
    >>> with_finite_axes(xr.Dataset(coords={"modulus_ratio": axis})).inverse_modulus_ratio.values
    array([1.  , 0.01, 0.  ])
    """
    companions = {}
    for name in dataset.dims:
        axis = dataset.variables.get(name)
        if axis is None or axis.dtype.kind != "f" or not np.isinf(axis.values).any():
            continue
        with np.errstate(divide="ignore"):
            values = 1 / axis.values
        unit = axis.attrs.get("units", "1")
        attributes = {
            "units": unit if unit == "1" else f"({unit})-1",
            "long_name": f"reciprocal of the {axis.attrs.get('long_name', name)}",
            "comment": f"0 where {name} is infinite; plot over this axis to see that point",
        }
        companions[f"{PREFIX}{name}"] = (name, values, attributes)
    return dataset.assign_coords(companions)
