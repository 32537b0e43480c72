"""The bonds' own series of a scene as one table for discrete element codes."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd
import xarray as xr

from bondcell.bond_tables import reduce_series
from bondcell.results.relaxation_tables import AT, relaxation_axes
from bondcell.results.view import analytic_names, reference_names

if TYPE_CHECKING:
    from bondcell.scenes.scene import Scene

WINDOW = ("window_start", "window_end")


def bond_series(scene: Scene, study: xr.Dataset) -> xr.Dataset:
    """The series that `prony.bond` asks for, reduced where it says so.

    Parameters
    ----------
    scene
        A scene with a prony block.
    study
        Its result under one load.

    Returns
    -------
    xarray.Dataset
        ``K_inf``, ``K_k``, ``tau_k``, ``error_estimate`` and, where terms were reduced,
        ``reduction_error`` on ``(model, convention, series, axes..., term)``. Generated series are
        left out where there are others.
    """
    block = scene.prony
    assert block is not None
    wanted = list(block.bond.models) or reference_names(study)[:1] or analytic_names(study)
    names = [name for name in wanted if name in study["model"].values]
    kinds = study["series_kind"].values
    chosen = np.flatnonzero(kinds != "generated") if np.any(kinds != "generated") else slice(None)
    here = study.sel(model=names).isel(series=chosen)
    dims = ["model", *AT, *relaxation_axes(study)]
    series = here[["K_inf", "K_k", "tau_k"]].assign(error_estimate=here["series_error"])
    series = series.transpose(*dims, "term").reset_coords(drop=True)
    if block.bond.terms is not None or block.bond.error is not None:
        window = block.times.start, block.times.stop
        series = reduce_series(series, block.bond.terms, window, error=block.bond.error)
        series = series.assign_attrs(window_start=window[0], window_end=window[1])
        del series.attrs["window"]
    used = int(np.isfinite(series["K_k"].values).any(axis=tuple(range(len(dims)))).sum())
    return series.isel(term=slice(0, used)).assign_attrs(load=scene.load, title=scene.title)


def bond_table(series: xr.Dataset) -> pd.DataFrame:
    """The same as rows to be typed: element 0 is the lasting spring.

    Parameters
    ----------
    series
        What `bond_series` gives.

    Returns
    -------
    pandas.DataFrame
        ``model``, ``convention``, ``series``, the axes, ``element``, ``stiffness`` [N m-1;
        N m rad-1], ``relaxation_time`` [s], ``viscosity`` (their product), ``error_estimate`` of
        K(t), of which ``reduction_error`` is due to fewer terms.
    """
    return pd.DataFrame(list(_elements(series)))


def _elements(series: xr.Dataset) -> Iterator[dict[str, Any]]:
    dims = [str(dim) for dim in series["K_inf"].dims]
    about = [name for name in ("error_estimate", "reduction_error") if name in series]
    for point in np.ndindex(series["K_inf"].shape):
        here = dict(zip(dims, point, strict=True))
        head = {dim: series[dim].values[k].item() for dim, k in here.items()}
        at = series.isel(here)
        if not np.isfinite(at["K_inf"].item()):
            continue
        tail = {name: at[name].item() for name in about}
        lasting = {"element": 0, "stiffness": at["K_inf"].item()}
        endless = {"relaxation_time": np.inf, "viscosity": np.inf}
        yield head | lasting | endless | tail
        strengths, times = at["K_k"].values, at["tau_k"].values
        used = np.isfinite(strengths)
        pairs = zip(strengths[used].tolist(), times[used].tolist(), strict=True)
        for number, (strength, time) in enumerate(pairs, start=1):
            element = {"element": number, "stiffness": strength, "relaxation_time": time}
            yield head | element | {"viscosity": strength * time} | tail
