"""How far each analytic model is from the finite element reference, and where it is worst."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr
from numpy.typing import NDArray

from bondcell.results.view import (
    REFERENCE,
    analytic_names,
    axis_values,
    grid_axes,
    parameters,
    parameters_at,
    reference_names,
)
from bondcell.status import Status

SMALL_AXIS = 5
"""An axis with at most this many values also gets a row for each value."""

FloatArray = NDArray[np.float64]


def signed_error(study: xr.Dataset, model: str, reference: str = REFERENCE) -> xr.DataArray:
    """Error of a model against a reference, ``K / K_reference - 1``; NaN where either has no value.

    Parameters
    ----------
    study
        A result with ``stiffness(model, axes...)``.
    model, reference
        Names in the dimension ``model``.

    Returns
    -------
    xarray.DataArray
        Relative error on the swept axes: negative where the model is too soft.
    """
    points = _Points(study)
    template = points.template
    return template.copy(data=points.error(model, reference)).rename("error")


def accuracy_table(study_result: xr.Dataset) -> pd.DataFrame:
    """Error of each analytic model against each finite element reference.

    Parameters
    ----------
    study_result
        A sweep's result: ``stiffness(model, axes...)`` [N m-1], ``status``, ``error_estimate``.

    Returns
    -------
    pandas.DataFrame
        One row for each model, reference and group of points. ``group_axis`` is ``all``, or the
        name of an axis of at most five values, whose value is ``group_value``. Errors are relative,
        ``K / K_fe - 1``: ``error_min``, ``error_max`` (signed), ``abs_error_max``,
        ``abs_error_median``; ``at_<parameter>`` says where the largest is. ``points`` were compared,
        ``points_outside`` of them lie outside the model's valid range, ``abs_error_max_inside`` is
        the largest error of the others; ``left_out`` had no value, for the flags in
        ``left_out_by``. ``reference_error`` is the largest error estimate of the reference itself.

    Notes
    -----
    No point is dropped for being a bad one: only those without a value in the model or in the
    reference are left out, and they are counted.

    Examples
    --------
    >>> ok = ("model", "gap"), [[0, 0], [0, 0]]
    >>> study = xr.Dataset(
    ...     {"stiffness": (("model", "gap"), [[50.0, 110.0], [100.0, 100.0]]), "status": ok},
    ...     coords={"model": ["fsi", "fe"], "gap": [1e-4, 1e-3]},
    ... )
    >>> table = accuracy_table(study)
    >>> table.loc[0, ["error_min", "error_max", "abs_error_max", "at_gap"]].tolist()
    [-0.5, 0.10000000000000009, 0.5, 0.0001]
    """
    axes = grid_axes(study_result)
    columns = [*_LEADING, *(f"at_{name}" for name in parameters(study_result)), *_TRAILING]
    references = reference_names(study_result)
    if not references:
        return pd.DataFrame(columns=columns)
    points = _Points(study_result)
    groups = list(_groups(study_result, axes))
    rows = [
        {"model": model, "reference": reference, **group, **_row(points, model, reference, here)}
        for reference in references
        for model in analytic_names(study_result)
        for here, group in groups
    ]
    return pd.DataFrame(rows, columns=columns)


def accuracy_of_loads(loads: Mapping[str, xr.Dataset]) -> pd.DataFrame:
    """The accuracy tables of all loads below each other, with a first column ``load``.

    Parameters
    ----------
    loads
        Load -> result, see `bondcell.results.load_groups.read_loads`.
    """
    tables = []
    for load, study in loads.items():
        table = accuracy_table(study)
        table.insert(0, "load", load)
        tables.append(table)
    filled = [table for table in tables if not table.empty]
    return pd.concat(filled, ignore_index=True) if filled else tables[0]


_LEADING = (
    "model",
    "reference",
    "group_axis",
    "group_value",
    "error_min",
    "error_max",
    "abs_error_max",
    "abs_error_median",
)
_TRAILING = (
    "points",
    "points_outside",
    "abs_error_max_inside",
    "left_out",
    "left_out_by",
    "reference_error",
)


class _Points:
    """A study's results as plain arrays, ``(axes...)`` for each model."""

    def __init__(self, study: xr.Dataset) -> None:
        stiffness = study["stiffness"].transpose("model", ...)
        self.template = stiffness.isel(model=0, drop=True)
        self.study = study
        self.dims = [str(dim) for dim in self.template.dims]
        self.position = {str(name): i for i, name in enumerate(study["model"].values)}
        self.value = np.asarray(stiffness.values, dtype=float)
        self.status = self._aligned(study, "status", Status.ok, Status.not_computed)
        self.estimate = self._aligned(study, "error_estimate", np.nan, np.nan)
        flags = [flag.value for flag in Status if flag.has_value]
        self.has_value = np.isfinite(self.value) & np.isin(self.status, flags)

    def _aligned(self, study: xr.Dataset, name: str, absent: float, missing: float) -> FloatArray:
        if name not in study:
            return np.full(self.value.shape, float(absent))
        values = study[name].transpose("model", *self.template.dims).values.astype(float)
        return np.where(np.isnan(values), float(missing), values)

    def error(self, model: str, reference: str) -> FloatArray:
        this, that = self.position[model], self.position[reference]
        good = self.has_value[this] & self.has_value[that] & (self.value[that] != 0)
        error = np.full(good.shape, np.nan)
        np.divide(self.value[this], self.value[that], out=error, where=good)
        return error - 1


def _groups(
    study: xr.Dataset, axes: Mapping[str, int]
) -> Iterator[tuple[dict[str, int], dict[str, Any]]]:
    """Position along an axis, or none for all points, and the name of the group."""
    yield {}, {"group_axis": "all", "group_value": np.nan}
    for axis, size in axes.items():
        if size <= SMALL_AXIS and len(parameters(study)) > 1:
            for position, value in enumerate(axis_values(study, axis)):
                yield {axis: position}, {"group_axis": axis, "group_value": value}


def _row(points: _Points, model: str, reference: str, here: Mapping[str, int]) -> dict[str, Any]:
    index = tuple(slice(here[a], here[a] + 1) if a in here else slice(None) for a in points.dims)
    this, that = points.position[model], points.position[reference]
    error = points.error(model, reference)[index]
    compared = np.isfinite(error)
    outside = points.status[this][index] == Status.outside_valid_range
    estimate = points.estimate[that][index][compared]
    found, size = error[compared], np.abs(error)
    row = {
        "error_min": _reduced(np.min, found),
        "error_max": _reduced(np.max, found),
        "abs_error_max": _reduced(np.max, size[compared]),
        "abs_error_median": _reduced(np.median, size[compared]),
        "points": int(compared.sum()),
        "points_outside": int((compared & outside).sum()),
        "abs_error_max_inside": _reduced(np.max, size[compared & ~outside]),
        "left_out": int((~compared).sum()),
        "left_out_by": _reasons(points, (model, reference), index),
        "reference_error": _reduced(np.max, estimate[np.isfinite(estimate)]),
    }
    if compared.any():
        worst = np.unravel_index(int(np.nanargmax(size)), error.shape)
        place = {
            dim: (part.start or 0) + int(position)
            for dim, part, position in zip(points.dims, index, worst, strict=True)
        }
        row |= {f"at_{name}": value for name, value in parameters_at(points.study, place).items()}
    return row


def _reasons(points: _Points, names: tuple[str, ...], index: tuple[slice, ...]) -> str:
    """Flags of the points without a value, and how many: ``diverges: 3 (cementation)``."""
    reasons = []
    for name in names:
        position = points.position[name]
        missing = ~points.has_value[position][index]
        flags, counts = np.unique(points.status[position][index][missing], return_counts=True)
        for flag, count in zip(flags, counts, strict=True):
            label = "no value" if Status(int(flag)).has_value else Status(int(flag)).name
            reasons.append(f"{label}: {count} ({name})")
    return "; ".join(reasons)


def _reduced(function: Any, values: FloatArray) -> float:
    return float(function(values)) if values.size else float("nan")
