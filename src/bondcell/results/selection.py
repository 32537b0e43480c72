"""A part of a result: some of its variables at chosen positions, as a table."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from difflib import get_close_matches
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from bondcell.errors import InputError, Violation
from bondcell.results.view import axis_unit, axis_values
from bondcell.scenes.quantities import EXAMPLES, NotAllowed, parse_quantity

if TYPE_CHECKING:
    import pandas as pd

NEAR = 1e-6
"""Relative distance within which a given position counts as one of an axis."""

_SHOWN = 12


def narrowed(data: xr.Dataset, positions: Iterable[str]) -> xr.Dataset:
    """The data at given positions of its axes.

    Parameters
    ----------
    data
        Results.
    positions
        Texts such as ``"model=fe"`` or ``"gap=0.5 mm"``.

    Raises
    ------
    InputError
        Lists every text that names no axis or no value on it.

    Examples
    --------
    >>> gap = ("gap", [5e-4, 1e-3], {"units": "m"})
    >>> data = xr.Dataset({"stiffness": ("gap", [2.0, 1.0])}, {"gap": gap})
    >>> narrowed(data, ["gap=1 mm"]).stiffness.item()
    1.0
    """
    index: dict[str, int] = {}
    violations = []
    for text in positions:
        axis, sign, value = (part.strip() for part in text.partition("="))
        if not sign or axis not in data.dims:
            allowed = f"AXIS=VALUE with one of the axes {', '.join(map(str, data.dims)) or 'none'}"
            violations.append(Violation("--at", text, allowed))
            continue
        place = _position(data, axis, value)
        if place is None:
            violations.append(Violation("--at", text, f"a value of {axis}: {_values(data, axis)}"))
        else:
            index[axis] = place
    if violations:
        raise InputError(violations)
    return data.isel(index)


def _position(data: xr.Dataset, axis: str, text: str) -> int | None:
    values = axis_values(data, axis)
    if values.dtype.kind in "OUS":
        matches = np.flatnonzero(values.astype(str) == text)
        return int(matches[0]) if matches.size else None
    unit = axis_unit(data, axis)
    try:
        known = unit in EXAMPLES
        wanted = parse_quantity(text, unit, allow_infinite=True) if known else float(text)
    except (NotAllowed, ValueError):
        return None
    if math.isinf(wanted):
        matches = np.flatnonzero(values == wanted)
        return int(matches[0]) if matches.size else None
    finite = np.where(np.isfinite(values), values, np.nan)
    distance = np.abs(finite - wanted)
    if not np.isfinite(distance).any():
        return None
    nearest = int(np.nanargmin(distance))
    return nearest if distance[nearest] <= NEAR * max(abs(wanted), 1e-300) else None


def _values(data: xr.Dataset, axis: str) -> str:
    values = axis_values(data, axis)
    numeric = values.dtype.kind in "iuf"
    shown = [f"{value:.6g}" if numeric else str(value) for value in values[:_SHOWN]]
    more = f" and {len(values) - _SHOWN} more" if len(values) > _SHOWN else ""
    unit = axis_unit(data, axis)
    return ", ".join(shown) + more + (f" [{unit}]" if numeric and unit != "1" else "")


def chosen_variables(data: xr.Dataset, names: Sequence[str]) -> list[str]:
    """The asked variables; without any those that lie on the axes of the chief one.

    Parameters
    ----------
    data
        Results.
    names
        Names of variables.

    Raises
    ------
    InputError
        Lists every name that the data does not have.
    """
    known = [str(name) for name in data.data_vars]
    if not known:
        raise InputError([Violation("file", "no variable", "a group with variables")])
    violations = []
    for name in names:
        if name not in data.variables:
            close = get_close_matches(name, known, 1)
            hint = f"; did you mean {close[0]}?" if close else ""
            violations.append(Violation("--variable", name, f"one of {', '.join(known)}{hint}"))
    if violations:
        raise InputError(violations)
    if names:
        return list(dict.fromkeys(names))
    chief = "stiffness" if "stiffness" in data else max(known, key=lambda name: data[name].ndim)
    dims = set(data[chief].dims)
    return [name for name in known if set(data[name].dims) == dims]


def as_table(data: xr.Dataset, names: Sequence[str]) -> pd.DataFrame:
    """A row for each point, a column for each axis and variable; flags by their names.

    Parameters
    ----------
    data
        Results.
    names
        Variables of it.
    """
    part = data[list(names)]
    part = part.drop_vars([name for name in part.coords if name not in part.dims])
    for name in names:
        part[name] = _named(part[name])
    if not part.dims:
        part = part.expand_dims("point")
    for dim in part.dims:
        if dim not in part.coords:
            part = part.assign_coords({dim: np.arange(part.sizes[dim])})
    table = part.to_dataframe().reset_index()
    return table[[*part.dims, *(name for name in names if name not in part.dims)]]


def _named(values: xr.DataArray) -> xr.DataArray:
    """Flag values replaced by their meanings."""
    if "flag_meanings" not in values.attrs:
        return values
    meanings: dict[int, Any] = dict(
        zip(
            np.atleast_1d(values.attrs["flag_values"]).tolist(),
            str(values.attrs["flag_meanings"]).split(),
            strict=False,
        )
    )
    words = [meanings.get(int(code), f"flag {code}") for code in values.values.ravel()]
    return values.copy(data=np.array(words, dtype=str).reshape(values.shape))
