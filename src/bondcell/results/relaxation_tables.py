"""What relaxation results say in tables: accuracy over time, stability, methods, bonds."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr

from bondcell.results.convergence import COLUMNS
from bondcell.results.view import REFERENCE, analytic_names
from bondcell.status import Status
from bondcell.timing import ATTRIBUTES

AT = ("convention", "series")
"""Dimensions of every table besides the swept axes."""


FADED = 1e-9
"""Share of K(0) below which a bond is gone."""


def has_relaxation(study: xr.Dataset) -> bool:
    """Whether a result has a time dimension."""
    return "relaxation" in study


def relaxation_axes(study: xr.Dataset) -> list[str]:
    """The swept axes under the relaxation."""
    known = {"model", *AT, "time"}
    return [str(dim) for dim in study["relaxation"].dims if dim not in known]


def error_over_time(study: xr.Dataset, model: str, reference: str = REFERENCE) -> xr.DataArray:
    """Signed error ``K(t)/K_FE(t) - 1`` of a model; NaN without a value or once K has faded.

    Parameters
    ----------
    study
        A result with relaxation.
    model, reference
        Names in the dimension ``model``.
    """
    usable = study["relaxation_status"] < Status.limit_exceeded
    curves = study["relaxation"].where(usable)
    true = _not_faded(curves.sel(model=reference, drop=True))
    return (curves.sel(model=model, drop=True) / true - 1).rename("error")


def shortcut_error(study: xr.Dataset, model: str = REFERENCE) -> xr.DataArray:
    """Error of ``K(0) g(t)`` against K(t) of the same model.

    Parameters
    ----------
    study
        A result with relaxation.
    model
        Name in the dimension ``model``.
    """
    curve = study["relaxation"].sel(model=model, drop=True)
    guess = curve.isel(time=0, drop=True) * study["shear_share"]
    return (guess / _not_faded(curve) - 1).transpose(*curve.dims).rename("error")


def _not_faded(curve: xr.DataArray) -> xr.DataArray:
    """NaN where nothing is left of K: ratios of vanishing stiffnesses say nothing."""
    return curve.where(curve > FADED * curve.isel(time=0, drop=True))


def accuracy_over_time(loads: Mapping[str, xr.Dataset]) -> pd.DataFrame:
    """Error of each model against the reference, at t = 0, over time and at its worst.

    Parameters
    ----------
    loads
        Load -> result, see `bondcell.results.load_groups.read_loads`.

    Returns
    -------
    pandas.DataFrame
        One row for each load, model, convention, series and point: ``error_start``, ``error_end``
        (at the last time), ``error_min``, ``error_max`` (signed, relative),
        ``abs_error_max``, ``time_of_max`` [s], ``poisson_start``, ``poisson_end``,
        ``left_valid_range_at`` [s] (NaN: never). The model ``shortcut`` is ``K(0) g(t)`` of the
        reference.
    """
    tables = []
    for load, study in loads.items():
        if not has_relaxation(study):
            continue
        names = [str(name) for name in study["model"].values]
        if REFERENCE not in names:
            continue
        for model in analytic_names(study):
            outside = study["relaxation_status"].sel(model=model) == Status.outside_valid_range
            rows = _rows(study, error_over_time(study, model), outside)
            rows.insert(0, "model", model)
            tables.append(rows.assign(load=load))
        rows = _rows(study, shortcut_error(study), None)
        rows.insert(0, "model", "shortcut")
        tables.append(rows.assign(load=load))
    if not tables:
        return pd.DataFrame()
    whole = pd.concat(tables, ignore_index=True)
    return whole[["load", *(name for name in whole.columns if name != "load")]]


def _rows(study: xr.Dataset, error: xr.DataArray, outside: xr.DataArray | None) -> pd.DataFrame:
    axes = relaxation_axes(study)
    error = error.transpose(*AT, *axes, "time").drop_vars(_extra(error, [*AT, *axes, "time"]))
    size = np.abs(error.values)
    known = np.isfinite(size)
    filled = np.where(known, size, -1.0)
    worst = filled.argmax(axis=-1)
    time = study["time"].values
    poisson = study["poisson_t"].transpose(*AT, *axes, "time").values
    any_known = known.any(axis=-1)
    columns: dict[str, Any] = {
        "error_start": error.values[..., 0],
        "error_end": error.values[..., -1],
        "error_min": _extreme(np.nanmin, error.values, any_known),
        "error_max": _extreme(np.nanmax, error.values, any_known),
        "abs_error_max": np.where(any_known, filled.max(axis=-1), np.nan),
        "time_of_max": np.where(any_known, time[worst], np.nan),
        "poisson_start": poisson[..., 0],
        "poisson_end": poisson[..., -1],
        "left_valid_range_at": np.full(worst.shape, np.nan),
    }
    if outside is not None:
        left = outside.transpose(*AT, *axes, "time").values
        first = time[left.argmax(axis=-1)]
        columns["left_valid_range_at"] = np.where(left.any(axis=-1), first, np.nan)
    index = error.isel(time=0, drop=True)
    frame = pd.DataFrame({name: values.ravel() for name, values in columns.items()})
    grid = np.meshgrid(*(index[dim].values for dim in index.dims), indexing="ij")
    for position, (dim, values) in enumerate(zip(index.dims, grid, strict=True)):
        frame.insert(position, str(dim), values.ravel())
    return frame


def _extreme(function: Any, values: Any, known: Any) -> Any:
    filled = np.where(known[..., None], values, 0.0)
    return np.where(known, function(filled, axis=-1), np.nan)


def _extra(array: xr.DataArray, kept: list[str]) -> list[str]:
    return [str(name) for name in array.coords if name not in kept]


def relaxation_stability(loads: Mapping[str, xr.Dataset]) -> pd.DataFrame:
    """Every series with its flag, estimate and check, the worst first.

    Parameters
    ----------
    loads
        Load -> result.

    Returns
    -------
    pandas.DataFrame
        ``load``, ``model``, ``convention``, ``series``, the axes, ``terms`` of the bond,
        ``K_start``, ``K_inf`` [N m-1; N m rad-1], ``status``, ``error_estimate``, ``check_error``
        (against the elastic stiffness at real Laplace variables), ``check_allowed``, ``sound``:
        whether a value has a check within what its estimates allow and K never rises, or a flag
        says that there is none; ``is_fluid``: the shear modulus relaxes to nothing.
    """
    tables = []
    for load, study in loads.items():
        if not has_relaxation(study) or "correspondence_error" not in study:
            continue
        axes = relaxation_axes(study)
        dims = ["model", *AT, *axes]
        start = study["relaxation"].isel(time=0, drop=True)
        rises = (study["relaxation"].diff("time") > 1e-12 * start).any("time")
        columns = {
            "terms": study["series_terms"],
            "K_start": start,
            "K_inf": study["K_inf"],
            "status": study["series_status"],
            "error_estimate": study["series_error"],
            "check_error": study["correspondence_error"],
            "check_allowed": study["correspondence_allowed"],
            "rises": rises,
            "seconds": study["series_seconds"],
        }
        tidy = xr.Dataset(
            {n: c.transpose(*dims).reset_coords(drop=True) for n, c in columns.items()}
        )
        frame = tidy.to_dataframe(dim_order=dims).reset_index()
        relaxing = study["series_relaxing"].to_series()
        frame.insert(0, "load", load)
        frame["is_fluid"] = frame["series"].map(relaxing).to_numpy() >= 1 - 1e-12
        tables.append(frame[frame["status"] != Status.not_computed])
    if not tables:
        return pd.DataFrame()
    table = pd.concat(tables, ignore_index=True)
    valued = table["K_start"].notna()
    checked = table["check_error"] <= table["check_allowed"]
    flagged = ~valued & (table["status"] >= Status.limit_exceeded)
    table["sound"] = (valued & checked & ~table["rises"]) | flagged
    table["status"] = [Status(int(code)).name for code in table["status"]]
    ratio = (table["check_error"] / table["check_allowed"]).fillna(np.inf)
    order = np.lexsort((-table["error_estimate"].fillna(np.inf), -ratio, table["sound"]))
    return table.iloc[order].drop(columns="rises").reset_index(drop=True)


def methods_table(methods: xr.Dataset) -> pd.DataFrame:
    """The comparison of methods in time in the columns of a convergence table.

    Parameters
    ----------
    methods
        The group that `bondcell.jobs.relaxation_methods.run_methods` gives.
    """
    rows = []
    for case in methods["case"].values:
        here = methods.sel(case=case)
        head = {name: str(here[name].values) for name in ("case", "load", "bc", "unit")}
        for method in here["method"].values:
            ladder = here.sel({"method": method})  # as a keyword it is an option of sel
            for level in ladder["level"].values:
                at = ladder.sel(level=level)
                if at["status"] == Status.not_computed:
                    continue
                wanted = [n for n in ("refinement", "error", *ATTRIBUTES, "dof") if n in at]
                values = {n: at[n].item() for n in wanted}
                status = Status(int(at["status"])).name
                rows.append(
                    head | values | {"method": str(method), "level": int(level), "status": status}
                )
    table = pd.DataFrame(rows, columns=list(COLUMNS))
    return table.astype(dict.fromkeys(["level", "dof", "elements"], "Int64"))
