"""A bond's Prony series as a table for discrete element codes, as it is or with few terms."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np
import xarray as xr

from bondcell.errors import InputError, Violation
from bondcell.prony.chain import Chain
from bondcell.prony.reduction import reduce_chain
from bondcell.storage import replacing

SERIES = ("K_inf", "K_k", "tau_k")


def reduce_series(
    series: xr.Dataset,
    terms: int | None = None,
    window: tuple[float, float] | None = None,
    *,
    error: float | None = None,
) -> xr.Dataset:
    """Replace each point's series by the best one of few terms over a window of time.

    Parameters
    ----------
    series
        What `bondcell.relaxation_series` gave.
    terms
        Most Maxwell elements that the bond may have.
    window
        First and last time [s] of the simulation.
    error
        In place of `terms`: largest relative error of K(t) in the window; each point gets as few
        terms as that takes.

    Returns
    -------
    xarray.Dataset
        The same variables; ``reduction_error(...)`` is the largest relative error of K(t) in the
        window, ``error_estimate`` includes it; attribute ``window``.

    Examples
    --------
    >>> import bondcell
    >>> study = xr.Dataset(
    ...     {
    ...         "radius_i": 7.5e-3,
    ...         "gap": 5e-4,
    ...         "young_i": 3e10,
    ...         "poisson_i": 0.25,
    ...         "young_m": 1.4e6,
    ...         "poisson_m": 0.46,
    ...     }
    ... )
    >>> prony = bondcell.Prony([0.3, 0.3, 0.2, 0.1], [1e-3, 1e-2, 1.0, 1e2])
    >>> series = bondcell.relaxation_series(study, prony, "generatrix")
    >>> few = reduce_series(series, window=(1e-4, 1e4), error=0.01)
    >>> series.sizes["term"], few.sizes["term"], bool(few.reduction_error < 0.01)
    (16, 4, True)
    """
    _check(series)
    dims = series.K_inf.dims
    strengths = series.K_k.transpose(*dims, "term").values
    times = series.tau_k.transpose(*dims, "term").values
    shape = series.K_inf.shape
    K_inf = series.K_inf.values
    found: dict[tuple[int, ...], Chain] = {}
    missed = np.full(shape, np.nan)
    for point in np.ndindex(shape):
        own = np.isfinite(strengths[point])
        if not np.isfinite(K_inf[point]):
            continue
        chain = Chain(np.asarray(K_inf[point]), strengths[point][own], times[point][own])
        found[point], missed[point] = reduce_chain(chain, terms, window, error)
    width = max((chain.count for chain in found.values()), default=0)
    few = np.full((2, *shape, width), np.nan)
    for point, chain in found.items():
        few[0][point][: chain.count], few[1][point][: chain.count] = chain.strengths, chain.times
    about = {"units": "1", "long_name": "largest relative error of K(t) in the window"}
    reduced = series.drop_vars(["K_k", "tau_k"]).assign(
        K_k=((*dims, "term"), few[0], series.K_k.attrs),
        tau_k=((*dims, "term"), few[1], series.tau_k.attrs),
        reduction_error=(dims, missed, about),
    )
    if "error_estimate" in reduced:
        reduced["error_estimate"] = (dims, reduced.error_estimate.values + missed)
        reduced.error_estimate.attrs = series.error_estimate.attrs
    return reduced.assign_attrs(window=[float(time) for time in window or ()])


def write_bond_table(series: xr.Dataset, path: str | Path) -> Path:
    """Write the series of one point as a CSV table to be typed into a generalised Maxwell bond.

    Parameters
    ----------
    series
        One point of `bondcell.relaxation_series` or `reduce_series`; several points belong into
        netCDF, `bondcell.storage.write_dataset`.
    path
        The file.

    Returns
    -------
    pathlib.Path
        `path`. Columns: ``element`` (0 is the lasting spring), ``stiffness``, ``relaxation_time``
        [s], ``viscosity`` (stiffness times time); units, model and errors stand in remarks.
    """
    _check(series)
    if series.K_inf.size != 1:
        given = dict(series.K_inf.sizes)
        raise InputError([Violation("series", given, "one point, for example series.isel(gap=0)")])
    units = str(series.K_inf.attrs.get("units", "N m-1"))
    remarks = {name: series.attrs[name] for name in sorted(series.attrs)}
    for name in ("error_estimate", "reduction_error"):
        if name in series:
            remarks[name] = f"{series[name].item():.3g}"
    for axis, coord in series.coords.items():
        if coord.size == 1:
            remarks[str(axis)] = f"{coord.item()!r} {coord.attrs.get('units', '')}".strip()
    strengths, times = series.K_k.values.ravel(), series.tau_k.values.ravel()
    used = np.isfinite(strengths)
    with replacing(path) as temporary, temporary.open("w", newline="", encoding="utf-8") as file:
        for name, value in remarks.items():
            file.write(f"# {name}: {value}\n")
        table = csv.writer(file, lineterminator="\n")
        table.writerow(
            ["element", f"stiffness [{units}]", "relaxation_time [s]", f"viscosity [{units} s]"]
        )
        table.writerow([0, repr(float(series.K_inf.item())), "inf", "inf"])
        pairs = zip(strengths[used].tolist(), times[used].tolist(), strict=True)
        for number, (strength, tau) in enumerate(pairs, start=1):
            table.writerow([number, repr(strength), repr(tau), repr(strength * tau)])
    return Path(path)


def _check(series: object) -> None:
    if not isinstance(series, xr.Dataset):
        allowed = "what bondcell.relaxation_series gives"
        raise InputError([Violation("series", type(series).__name__, allowed)])
    missing = [
        Violation(name, None, "a variable of what bondcell.relaxation_series gives")
        for name in SERIES
        if name not in series
    ]
    if missing:
        raise InputError(missing)
