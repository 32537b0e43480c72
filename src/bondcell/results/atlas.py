"""Accuracy atlas: error by region, the cheapest good model, error against run time."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import product
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr
from numpy.typing import NDArray

from bondcell.results.accuracy import signed_error
from bondcell.models import MODELS
from bondcell.results.view import REFERENCE, analytic_names
from bondcell.status import Status

FloatArray = NDArray[np.float64]
Mask = NDArray[np.bool_]

ANY = "any"
"""Band of a region that does not look at that axis."""

BANDS: Mapping[str, Mapping[str, tuple[float, float]]] = {
    "gap_ratio": {"film": (0.0, 0.1), "moderate": (0.1, 1.0), "wide": (1.0, np.inf)},
    "modulus_ratio": {"soft": (0.0, 99.0), "stiff": (99.0, np.inf)},
    "poisson_m": {"low": (-1.0, 0.3), "high": (0.3, 0.49), "near 1/2": (0.49, 0.5)},
}
"""Axis -> band -> values above the first bound, up to the second."""

BAND_WORDS: Mapping[str, str] = {
    "film": "L_g/R_i ≤ 0.1",
    "moderate": "0.1 < L_g/R_i ≤ 1",
    "wide": "L_g/R_i > 1",
    "soft": "E_i/E_m < 100",
    "stiff": "E_i/E_m ≥ 100",
    "low": "ν_m ≤ 0.3",
    "high": "0.3 < ν_m ≤ 0.49",
    "near 1/2": "ν_m > 0.49",
}
"""What a band is, in symbols."""

AXES = tuple(BANDS)
"""Axes of the maps; over all others the worst point counts."""

WANTED = (0.3, 0.1, 0.03, 0.01, 3e-3, 1e-3, 1e-4)
"""Errors for which the cheapest model is looked up."""

ROUNDING = 1e-9
"""A bound of a band holds in spite of round-off in a swept value."""


@dataclass(frozen=True)
class Region:
    """A part of the atlas, a band of each axis or `ANY`."""

    gaps: str = ANY
    particles: str = ANY
    poisson: str = ANY

    def bands(self) -> dict[str, str]:
        """Axis -> band."""
        return dict(zip(BANDS, (self.gaps, self.particles, self.poisson), strict=True))

    def mask(self, study: xr.Dataset) -> Mask:
        """Points of the region, shape of the swept axes."""
        dims = [str(dim) for dim in study["stiffness"].dims if dim != "model"]
        inside = np.ones([study.sizes[dim] for dim in dims], dtype=bool)
        for axis, band in self.bands().items():
            if band != ANY:
                low, high = (bound * (1 + ROUNDING) for bound in BANDS[axis][band])
                along = [-1 if dim == axis else 1 for dim in dims]
                values = study[axis].values.reshape(along)
                inside &= (values > low) & (values <= high)
        return inside


def regions() -> list[Region]:
    """All points, each band of one axis, each combination of bands."""
    names = [tuple(bands) for bands in BANDS.values()]
    single = [
        Region(**{field: band})
        for field, bands in zip(("gaps", "particles", "poisson"), names, strict=True)
        for band in bands
    ]
    return [Region(), *single, *(Region(*bands) for bands in product(*names))]


def worst_errors(study: xr.Dataset, model: str) -> FloatArray:
    """Signed error of a model on `AXES`, the largest in size over all other axes.

    Parameters
    ----------
    study
        Result of an atlas under one load.
    model
        An analytic model; where it lacks a value at any of the other axes' points it is NaN.
    """
    values = _on_axes(signed_error(study, model))
    size = np.where(np.isnan(values), np.inf, np.abs(values))
    return np.asarray(np.take_along_axis(values, size.argmax(-1)[..., None], -1)[..., 0])


def valid_everywhere(study: xr.Dataset, model: str) -> Mask:
    """Whether a model has a value inside its valid range, on `AXES`, at all other axes' points."""
    status = study["status"].sel(model=model, drop=True)
    return np.asarray((_on_axes(status) == Status.ok).all(-1))


def _on_axes(variable: xr.DataArray) -> FloatArray:
    """Values on `AXES` and, last, all other axes as one."""
    others = [str(dim) for dim in variable.dims if dim not in AXES]
    return np.asarray(
        variable.stack(other=others).transpose(*AXES, "other").values
        if others
        else variable.transpose(*AXES).values[..., None]
    )


def accuracy_by_region(loads: Mapping[str, xr.Dataset]) -> pd.DataFrame:
    """Error of each model in each region.

    Parameters
    ----------
    loads
        Load -> result of an atlas, see `bondcell.results.load_groups.read_loads`.

    Returns
    -------
    pandas.DataFrame
        One row for each ``load``, region (``gaps``, ``particles``, ``poisson``) and ``model``.
        Errors are relative to the reference, ``K / K_fe - 1``: ``error_min`` and ``error_max`` are
        signed, ``abs_error_median``, ``abs_error_95`` (95 of 100 points are below) and
        ``abs_error_max`` are sizes, the last also over the points inside the model's valid range
        (``abs_error_max_inside``). ``points`` were compared, ``points_outside`` of them lie
        outside that range, ``left_out`` have no value. ``seconds`` is the median time a point of
        this sweep. Of the reference ``fe`` the error is its own estimate.
    """
    rows = []
    for load, study in loads.items():
        masks = {region: region.mask(study) for region in regions()}
        for name in [*analytic_names(study), REFERENCE]:
            answers = _answers(study, name)
            for region, mask in masks.items():
                if mask.any():
                    where = {"gaps": region.gaps, "particles": region.particles}
                    row = {"load": load, **where, "poisson": region.poisson, "model": name}
                    rows.append(row | _row(answers, mask))
    return pd.DataFrame(rows)


@dataclass(frozen=True)
class _Answers:
    error: FloatArray
    outside: Mask
    seconds: FloatArray


def _answers(study: xr.Dataset, name: str) -> _Answers:
    here = study.sel(model=name, drop=True)

    def values(variable: xr.DataArray) -> FloatArray:
        dims = [str(dim) for dim in here["stiffness"].dims]
        return np.asarray(variable.transpose(*dims).values, dtype=float)

    error = here["error_estimate"] if name == REFERENCE else signed_error(study, name)
    outside = values(here["status"]) == Status.outside_valid_range
    return _Answers(values(error), outside, values(here["seconds"]))


def _row(answers: _Answers, mask: Mask) -> dict[str, Any]:
    error, outside = answers.error[mask], answers.outside[mask]
    known = np.isfinite(error)
    size = np.abs(error[known])
    return {
        "abs_error_median": _reduced(np.median, size),
        "abs_error_95": _reduced(lambda values: np.quantile(values, 0.95), size),
        "abs_error_max": _reduced(np.max, size),
        "abs_error_max_inside": _reduced(np.max, size[~outside[known]]),
        "error_min": _reduced(np.min, error[known]),
        "error_max": _reduced(np.max, error[known]),
        "points": int(known.sum()),
        "points_outside": int(outside[known].sum()),
        "left_out": int((~known).sum()),
        "seconds": _reduced(np.nanmedian, answers.seconds[mask]),
    }


def best_models(table: pd.DataFrame) -> pd.DataFrame:
    """The cheapest model that is good enough in a region, for each wanted error.

    Parameters
    ----------
    table
        See `accuracy_by_region`.

    Returns
    -------
    pandas.DataFrame
        One row for each ``load``, region and ``wanted`` error: ``model`` is the one of least time
        whose largest error there is not above the wanted one, at points that all have a value
        inside its valid range, with its ``abs_error_max`` and ``seconds``; ``formula`` is the same
        among the models that do not interpolate the reference, empty if there is none.
    """
    rows = []
    for key, group in table.groupby(["load", "gaps", "particles", "poisson"], sort=False):
        whole = group[(group["left_out"] == 0) & (group["points_outside"] == 0)]
        ordered = whole.sort_values("seconds")
        formulas = ordered[[is_formula(name) for name in ordered["model"]]]
        for wanted in WANTED:
            row = dict(zip(("load", "gaps", "particles", "poisson"), key, strict=True))
            row |= {"wanted": wanted, **_first(ordered, wanted, "model", "")}
            rows.append(row | _first(formulas, wanted, "formula", "formula_"))
    return pd.DataFrame(rows)


def is_formula(name: str) -> bool:
    """Whether a model is made without the reference.

    Examples
    --------
    >>> [is_formula(name) for name in ("fsi", "film", "surrogate", "fe")]
    [True, True, False, False]
    """
    return not (MODELS[name].is_reference or MODELS[name].from_reference)


def _first(ordered: pd.DataFrame, wanted: float, name: str, prefix: str) -> dict[str, Any]:
    good = ordered[ordered["abs_error_max"] <= wanted]
    if good.empty:
        return {name: "", f"{prefix}abs_error_max": np.nan, f"{prefix}seconds": np.nan}
    row = good.iloc[0]
    return {
        name: row["model"],
        f"{prefix}abs_error_max": row["abs_error_max"],
        f"{prefix}seconds": row["seconds"],
    }


def error_against_time(table: pd.DataFrame) -> pd.DataFrame:
    """One row for each load and model over the whole atlas: errors and time a point.

    Parameters
    ----------
    table
        See `accuracy_by_region`.
    """
    everywhere = (table[["gaps", "particles", "poisson"]] == ANY).all(axis=1)
    columns = [name for name in table if name not in ("gaps", "particles", "poisson")]
    return table.loc[everywhere, columns].reset_index(drop=True)


def atlas_tables(loads: Mapping[str, xr.Dataset]) -> Iterator[tuple[str, pd.DataFrame]]:
    """Name and content of each table of an atlas.

    Parameters
    ----------
    loads
        As in `accuracy_by_region`.
    """
    table = accuracy_by_region(loads)
    yield "accuracy_by_region", table
    yield "best_models", best_models(table)
    yield "error_against_time", error_against_time(table)


def _reduced(function: Any, values: FloatArray) -> float:
    return float(function(values)) if np.isfinite(values).any() else float("nan")
