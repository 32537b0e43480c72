"""Tables of the page on relaxation: cells as text, ready to print."""

from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd
import xarray as xr

from bondcell.outputs import STIFFNESS_UNITS
from bondcell.report.tables import Table
from bondcell.results.relaxation_tables import relaxation_axes
from bondcell.results.relaxation_view import convention_words, series_words
from bondcell.results.view import axis_unit
from bondcell.wording import METHODS, at, listed, model_name, number, percent, quantity

MOST_CHECKS = 20
"""Lines of the table of checks."""


def place(row: Any, study: xr.Dataset) -> str:
    """Series, convention (where the row has one) and point of a row in words."""
    axes = relaxation_axes(study)
    point = [at(axis, row[axis], axis_unit(study, axis)) for axis in axes]
    convention = [convention_words(str(row["convention"]))] if "convention" in row else []
    return ", ".join([series_words(str(row["series"])), *convention, *point])


def accuracy_lines(table: pd.DataFrame, study: xr.Dataset) -> Table | None:
    """Each model under each convention: error at both ends, the worst and where it is."""
    if table.empty:
        return None
    lines = []
    for (model, convention), rows in table.groupby(["model", "convention"], sort=False):
        known = rows[rows["abs_error_max"].notna()]
        if known.empty:
            continue
        worst = known.loc[known["abs_error_max"].idxmax()]
        name = METHODS.get(str(model)) or model_name(str(model))
        moment = f"t = {quantity(worst['time_of_max'], 's', 2)}"
        lines.append(
            [
                name,
                convention_words(str(convention)).removeprefix("constant "),
                percent(known["error_start"].abs().max()),
                percent(known["error_end"].abs().max()),
                percent(worst["abs_error_max"]),
                f"{moment}, {place(worst.drop('convention'), study)}",
            ]
        )
    header = [
        "model",
        "constant",
        "largest |error| at t = 0",
        "at the end",
        "at any time",
        "largest at",
    ]
    caption = (
        "Error of each model over time against finite elements, K(t) / K_FE(t) − 1, and of the "
        "shortcut against finite elements; every curve is in accuracy_over_time.csv."
    )
    return Table(caption, header, lines, names=2)


def methods_lines(table: pd.DataFrame) -> Table | None:
    """Every level of every way to K(t)."""
    if table.empty:
        return None
    said = {
        "exact_series": "tolerance {}",
        "time_stepping": "steps a decade: {}",
        "laplace_inversion": "nodes: {}",
    }
    lines = [
        [
            series_words(str(row.case)),
            METHODS[str(row.method)],
            said.get(str(row.method), "–").format(number(row.refinement)),
            str(row.dof),
            percent(row.error),
            quantity(row.seconds, "s", 2),
            str(row.status).replace("_", " "),
        ]
        for row in table.itertuples()
    ]
    header = ["series", "way", "refinement", "unknowns", "largest error", "time", "flag"]
    caption = (
        "Error of K(t) against run time by finite elements, set-up included; the error is that "
        "against the exact series of a finer mesh, so stepping and inversion end at the error of "
        "their own mesh."
    )
    return Table(caption, header, lines, names=3)


def stability_lines(table: pd.DataFrame, study: xr.Dataset) -> Table | None:
    """For each model and series the worst point."""
    if table.empty:
        return None
    lines = []
    for (model, series), rows in table.groupby(["model", "series"], sort=False):
        ratio = (rows["check_error"] / rows["check_allowed"]).fillna(np.inf)
        worst = rows.loc[ratio.idxmax()]
        unit = STIFFNESS_UNITS[str(worst["load"])]
        point = [at(axis, worst[axis], axis_unit(study, axis)) for axis in relaxation_axes(study)]
        flags = listed(str(flag).replace("_", " ") for flag in dict.fromkeys(rows["status"]))
        ends = [quantity(worst[name], unit) for name in ("K_start", "K_inf")]
        lines.append(
            [
                model_name(str(model)),
                series_words(str(series)),
                f"{int(rows['sound'].sum())} of {len(rows)}",
                flags,
                number(worst["check_error"], 2),
                number(worst["check_allowed"], 2),
                str(int(rows["terms"].max())),
                *ends,
                ", ".join(point) or "the cell",
            ]
        )
    header = [
        "model",
        "series of the matrix",
        "sound",
        "flags",
        "check",
        "allowed",
        "most terms",
        "K at t = 0",
        "K_inf",
        "worst at",
    ]
    caption = (
        "Every series against elastic stiffnesses at real Laplace variables: the largest relative "
        "difference (check) at the worst point, and what the error estimates allow there; every "
        "point is in relaxation_stability.csv."
    )
    return Table(caption, header, lines, names=2)


def bond_lines(bonds: xr.Dataset | None) -> Table | None:
    """The first series of bond_series.csv, element by element."""
    if bonds is None:
        return None
    dims = [str(dim) for dim in bonds["K_inf"].dims]
    finite = np.argwhere(np.isfinite(bonds["K_inf"].values))
    if not finite.size:
        return None
    # The middle of every swept axis, the first of all else.
    point = {dim: bonds.sizes[dim] // 2 if i > 2 else 0 for i, dim in enumerate(dims)}
    here = bonds.isel(point)
    if not np.isfinite(here["K_inf"].item()):
        here = bonds.isel(dict(zip(dims, finite[0], strict=True)))
    unit = str(bonds["K_inf"].attrs["units"])
    lines = [["0", quantity(here["K_inf"].item(), unit, 6), "∞"]]
    pairs = zip(here["K_k"].values, here["tau_k"].values, strict=True)
    for number_of, (strength, tau) in enumerate(pairs, start=1):
        if np.isfinite(strength):
            lines.append([str(number_of), quantity(strength, unit, 6), quantity(tau, "s", 6)])
    where = [
        series_words(str(here["series"].item())),
        convention_words(str(here["convention"].item())),
        *(at(dim, here[dim].item(), axis_unit(bonds, dim)) for dim in dims[3:]),
        model_name(str(here["model"].item())),
    ]
    error = here["reduction_error"] if "reduction_error" in here else here["error_estimate"]
    caption = (
        f"One bond to be typed into a generalised Maxwell element: {', '.join(where)}; largest "
        f"error {percent(error.item())} of K(t). Element 0 is the spring that lasts."
    )
    return Table(caption, ["element", "stiffness", "relaxation time"], lines)


def series_lines(study: xr.Dataset) -> Table:
    """What each series of the matrix is."""
    lines = []
    for name in study["series"].values:
        here = study.sel(series=name)
        temperature = here["temperature"].item()
        lines.append(
            [
                series_words(str(name)),
                str(here["series_kind"].item()),
                str(here["series_size"].item()),
                number(here["series_decades"].item(), 3),
                percent(here["series_relaxing"].item(), 5),
                f"{temperature - 273.15:.4g} °C" if np.isfinite(temperature) else "–",
            ]
        )
    header = ["series of the matrix", "kind", "terms", "decades", "relaxes", "temperature"]
    return Table("The series of the matrix.", header, lines, names=2)
