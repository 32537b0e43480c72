"""Sentences that results warrant; every number and every claim in them comes from the data."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr

from bondcell.accuracy import signed_error
from bondcell.particle_influence import PAPER_RATIO, RATIO_AXIS, particles_negligible_from
from bondcell.result_view import (
    analytic_names,
    axis_unit,
    axis_values,
    model_names,
    reference_names,
    swept_axes,
)
from bondcell.status import Status
from bondcell.wording import (
    at,
    listed,
    model_name,
    model_phrase,
    number,
    percent,
    quantity,
    symbol,
)

POISSON = "poisson_m"

CLEAR = 3.0
"""Errors that differ by this factor are said to depend on what differs."""


@dataclass(frozen=True)
class Finding:
    """A sentence for a section; with a key figure it also stands on the first screen.

    Parameters
    ----------
    text
        The sentence or sentences.
    key
        The figure that says it in short, empty for a finding of the section only.
    label
        What the figure is.
    """

    text: str
    key: str = ""
    label: str = ""


def sweep_findings(study: xr.Dataset, table: pd.DataFrame) -> list[Finding]:
    """What a sweep shows, most important first.

    Parameters
    ----------
    study
        A sweep's result.
    table
        Its accuracy table.
    """
    found: list[Finding] = []
    if not table.empty:
        found += _series_model(study, table)
    found += _particles(study)
    if not table.empty:
        found += _ranking(study, table)
        found += _lower_bound(table)
        found += _reference(study, table)
    found += _without_value(study)
    found += _speed(study)
    return found


def _series_model(study: xr.Dataset, table: pd.DataFrame) -> Iterator[Finding]:
    """How the paper's model compares, and whether that depends on Poisson's ratio."""
    reference = reference_names(study)[0]
    rows = table[(table["model"] == "fsi") & (table["reference"] == reference)]
    rows = rows[rows["points"] > 0]
    if rows.empty:
        return
    by_ratio = rows[rows["group_axis"] == POISSON].sort_values("abs_error_median")
    if len(by_ratio) > 1:
        yield _by_poisson(study, by_ratio.iloc[0], by_ratio.iloc[-1], reference)
    error = signed_error(study, "fsi", reference)
    if error.size == 1:
        side = "soft" if error.item() < 0 else "stiff"
        text = f"FSI, the paper's model, is too {side} by {percent(abs(error.item()))}."
        yield Finding(text, percent(error.item(), sign=True), "error of FSI")
        return
    low, high = (_place(study, error, find) for find in (np.nanargmin, np.nanargmax))
    median = percent(rows.iloc[0]["abs_error_median"])
    text = f"Over all points FSI's error runs from {low} to {high}, with {median} in the median."
    yield Finding(text, "" if len(by_ratio) > 1 else median, "median error of FSI")


def _by_poisson(study: xr.Dataset, best: pd.Series, worst: pd.Series, reference: str) -> Finding:
    low, high = percent(best["abs_error_median"]), percent(worst["abs_error_median"])
    text = (
        f"FSI, the paper's model, is off by {low} in the median for a matrix with "
        f"{at(POISSON, best['group_value'])}"
    )
    there = at(POISSON, worst["group_value"])
    if worst["abs_error_median"] < CLEAR * best["abs_error_median"]:
        return Finding(f"{text} and by {high} with {there}.", high, "median error of FSI")
    error = signed_error(study, "fsi", reference).sel({POISSON: worst["group_value"]})
    side = "soft" if error.median() < 0 else "stiff"
    return Finding(
        f"{text}, but by {high} with {there} (too {side}). So the agreement with finite elements "
        "that the paper reports depends on the Poisson's ratio of the matrix, which the model "
        "ignores.",
        f"{low} → {high}",
        f"median error of FSI, {at(POISSON, best['group_value'])} → {number(worst['group_value'])}",
    )


def _place(study: xr.Dataset, error: xr.DataArray, find: Callable[..., Any]) -> str:
    """An extreme error and where it is."""
    index = np.unravel_index(int(find(error.values)), error.shape)
    places = [
        at(str(axis), axis_values(study, axis)[position], axis_unit(study, str(axis)))
        for axis, position in zip(error.dims, index, strict=True)
        if error.sizes[axis] > 1
    ]
    return f"{percent(error.values[index], sign=True)} (at {', '.join(places)})"


def _particles(study: xr.Dataset) -> Iterator[Finding]:
    """From which modulus ratio on the particles do not matter, against what the paper says."""
    table = particles_negligible_from(study)
    known = table[table["ratio_from"].notna()]
    if known.empty:
        return
    parts, shortfalls = [], []
    for method, rows in known.groupby("method", sort=False):
        against = "the stiffness k_int of its interface" if method == "fsi" else "rigid particles"
        name = "FSI" if method == "fsi" else model_name(str(method))
        spans = _spans(rows)
        parts.append(f"by {name} from E_i/E_m = {spans} on (against {against})")
        gap = rows["deviation_at_paper_ratio"].dropna()
        if not gap.empty:
            low, high = percent(gap.min()), percent(gap.max())
            shortfalls.append(f"{low if low == high else f'{low} to {high}'} ({name})")
    text = f"The particles no longer matter, within 1 % of K_n, {listed(parts)}."
    lowest = known["ratio_from"].min()
    if shortfalls and lowest > PAPER_RATIO:
        text += (
            f" The paper puts this at {number(PAPER_RATIO)}; there K_n is still "
            f"{listed(shortfalls)} below that limit."
        )
    key = f"{symbol(RATIO_AXIS)} ≥ {_range(known['ratio_from'])}"
    yield Finding(text, key, "particles no longer matter")


def _spans(rows: pd.DataFrame) -> str:
    """Ratios by Poisson's ratio where it is an axis, as a range over all other axes."""
    if POISSON not in rows or _same(rows["ratio_from"]):
        return _range(rows["ratio_from"])
    return listed(
        f"{_range(group['ratio_from'])} ({at(POISSON, value)})"
        for value, group in rows.groupby(POISSON)
    )


def _range(values: pd.Series) -> str:
    low, high = number(values.min(), 2), number(values.max(), 2)
    return low if _same(values) or low == high else f"{low} to {high}"


def _same(values: pd.Series) -> bool:
    return bool(values.max() <= 1.005 * values.min())


def _ranking(study: xr.Dataset, table: pd.DataFrame) -> Iterator[Finding]:
    """Which model is closest, among those with a value everywhere."""
    rows = table[table["reference"] == reference_names(study)[0]]
    for (axis, value), group in rows.groupby(
        ["group_axis", "group_value"], sort=False, dropna=False
    ):
        complete = group[(group["left_out"] == 0) & (group["points"] > 1)]
        if len(complete) < 2 or axis not in ("all", POISSON):
            continue
        typical = complete.loc[complete["abs_error_median"].idxmin()]
        safest = complete.loc[complete["abs_error_max"].idxmin()]
        bound = percent(safest["abs_error_max"])
        closest = (
            f"in the median {model_phrase(typical['model'])} is closest "
            f"({percent(typical['abs_error_median'])})"
        )
        if axis == "all":
            text = (
                f"No model stays nearer to finite elements than {bound} at every point: that is "
                f"the largest error of {model_phrase(safest['model'])}, the smallest of its kind; "
                f"{closest}."
            )
            yield Finding(text, bound, "largest error of the best model")
        else:
            worst = f"the smallest largest error ({bound}) is that of"
            name = model_phrase(safest["model"])
            yield Finding(f"With {at(axis, value)} {closest}; {worst} {name}.")


def _lower_bound(table: pd.DataFrame) -> Iterator[Finding]:
    """The generatrix model must not lie above the reference."""
    rows = table[(table["model"] == "generatrix") & (table["group_axis"] == "all")]
    for _, row in rows[rows["points"] > 0].iterrows():
        slack = 0.0 if np.isnan(row["reference_error"]) else row["reference_error"]
        name = model_name(row["reference"])
        if row["error_max"] <= slack:
            yield Finding(
                f"The generatrix model is a lower bound by theory, and it is below {name} at all "
                f"{row['points']} points compared (closest: {percent(row['error_max'])})."
            )
        else:
            yield Finding(
                f"The generatrix model should be a lower bound, but it is above {name} by up to "
                f"{percent(row['error_max'])}: one of the two is wrong there.",
                percent(row["error_max"], sign=True),
                "violation of a lower bound",
            )


def _reference(study: xr.Dataset, table: pd.DataFrame) -> Iterator[Finding]:
    """How sure the reference is of itself."""
    for name in reference_names(study):
        rows = table[(table["reference"] == name) & (table["group_axis"] == "all")]
        error = rows["reference_error"].max()
        if error == error:
            yield Finding(
                f"The values of {model_name(name)} are sure to {number(error, 2)} (relative, the "
                f"largest estimate over all points), far finer than the differences above."
                if error < 1e-3
                else f"The values of {model_name(name)} are sure only to {percent(error)}."
            )


def _without_value(study: xr.Dataset) -> Iterator[Finding]:
    """Points without a value, by model and flag."""
    if "status" not in study:
        return
    losses = []
    for name in model_names(study):
        codes, counts = np.unique(study["status"].sel(model=name).values, return_counts=True)
        bad = [
            f"{count} ({Status(int(code)).name.replace('_', ' ')})"
            for code, count in zip(codes, counts, strict=True)
            if not Status(int(code)).has_value
        ]
        if bad:
            losses.append(f"{model_name(name)} at {listed(bad)}")
    total = int(np.prod(list(swept_axes(study).values())))
    if losses:
        yield Finding(f"Without a value, of {total} points: {listed(losses)}.")


def _speed(study: xr.Dataset) -> Iterator[Finding]:
    """What a point costs."""
    if "seconds" not in study or not model_names(study):
        return
    seconds = study["seconds"].transpose("model", ...)
    cost = {
        str(name): float(np.nanmedian(seconds.sel(model=name).values))
        for name in model_names(study)
        if np.isfinite(seconds.sel(model=name).values).any()
    }
    analytic = [cost[name] for name in analytic_names(study) if name in cost]
    reference = [cost[name] for name in reference_names(study) if name in cost]
    parts = []
    if analytic:
        low, high = quantity(min(analytic), "s", 2), quantity(max(analytic), "s", 2)
        parts.append(f"an analytic model {low if low == high else f'{low} to {high}'}")
    if reference:
        parts.append(f"finite elements {quantity(max(reference), 's', 2)}")
    if parts:
        yield Finding(f"A point costs {listed(parts)} (median wall time on the machine below).")
