"""What a file of results holds, as plain values that JSON knows."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import xarray as xr


def contents(path: str) -> dict[str, Any]:
    """Attributes, dimensions and variables of each group of a file.

    Parameters
    ----------
    path
        A file of results.

    Raises
    ------
    DataError
        It is missing, damaged or no netCDF file.
    """
    from bondcell.storage import group_names, read_dataset

    groups = {"/": read_dataset(path)}
    groups |= {f"/{name}": read_dataset(path, group=name) for name in group_names(path)}
    return {
        "file": path,
        "attributes": {str(name): str(value) for name, value in groups["/"].attrs.items()},
        "groups": {name: _group(data) for name, data in groups.items()},
    }


def _group(data: xr.Dataset) -> dict[str, Any]:
    return {
        "dimensions": {str(name): size for name, size in data.sizes.items()},
        "variables": {str(name): _variable(data[name]) for name in data.variables},
    }


def _variable(values: xr.DataArray) -> dict[str, Any]:
    about: dict[str, Any] = {
        "dimensions": [str(dim) for dim in values.dims],
        "units": values.attrs.get("units"),
        "long_name": values.attrs.get("long_name"),
    }
    if "flag_meanings" in values.attrs:
        words = str(values.attrs["flag_meanings"]).split()
        codes = np.atleast_1d(values.attrs["flag_values"]).tolist()
        known = {word: int((values == code).sum()) for word, code in zip(words, codes, strict=True)}
        return about | {"points_by_flag": {word: count for word, count in known.items() if count}}
    if values.dtype.kind not in "iuf":
        return about | {"values": [str(value) for value in values.values.ravel()]}
    missing = int(values.isnull().sum())
    if missing == values.size:
        return about | {"missing": missing}
    low, high = float(values.min()), float(values.max())
    about |= {"minimum": plain_number(low), "maximum": plain_number(high), "missing": missing}
    if values.name in values.dims:
        about["values"] = [plain_number(float(value)) for value in values.values]
    return about


def plain_number(value: float) -> float | str | None:
    """JSON knows no NaN (here null) and no infinity (here text).

    Examples
    --------
    >>> plain_number(1.5), plain_number(float("inf")), plain_number(float("nan"))
    (1.5, 'inf', None)
    """
    if math.isfinite(value):
        return value
    return None if math.isnan(value) else "inf" if value > 0 else "-inf"
