"""How the models of a sweep compare with finite elements, in sentences."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr

from bondcell.models import MODELS
from bondcell.report.findings import Finding
from bondcell.results.accuracy import signed_error
from bondcell.results.view import axis_unit, parameters_at, reference_names
from bondcell.wording import at, model_name, model_phrase, number, percent

POISSON = "poisson_m"

CLEAR = 3.0
"""Errors that differ by this factor are said to depend on what differs."""


def series_model(study: xr.Dataset, table: pd.DataFrame) -> Iterator[Finding]:
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
        key = percent(error.item(), sign=True)
        yield Finding(text, key, "error of FSI", topic="series model")
        return
    low, high = (_place(study, error, find) for find in (np.nanargmin, np.nanargmax))
    median = percent(rows.iloc[0]["abs_error_median"])
    text = f"Over all points FSI's error runs from {low} to {high}, with {median} in the median."
    key = "" if len(by_ratio) > 1 else median
    yield Finding(text, key, "median error of FSI", topic="series model")


def _by_poisson(study: xr.Dataset, best: pd.Series, worst: pd.Series, reference: str) -> Finding:
    low, high = percent(best["abs_error_median"]), percent(worst["abs_error_median"])
    text = (
        f"FSI, the paper's model, is off by {low} in the median for a matrix with "
        f"{at(POISSON, best['group_value'])}"
    )
    there = at(POISSON, worst["group_value"])
    if worst["abs_error_median"] < CLEAR * best["abs_error_median"]:
        text = f"{text} and by {high} with {there}."
        return Finding(text, high, "median error of FSI", topic="series model")
    error = signed_error(study, "fsi", reference).sel({POISSON: worst["group_value"]})
    side = "soft" if error.median() < 0 else "stiff"
    return Finding(
        f"{text}, but by {high} with {there} (too {side}). So the agreement with finite elements "
        "that the paper reports depends on the Poisson's ratio of the matrix, which the model "
        "ignores.",
        f"{low} → {high}",
        f"median error of FSI, {at(POISSON, best['group_value'])} → {number(worst['group_value'])}",
        topic="series model",
        brief=f"{text}, but by {high} with {there}: too {side}, for it ignores Poisson's effect.",
    )


def _place(study: xr.Dataset, error: xr.DataArray, find: Callable[..., Any]) -> str:
    """An extreme error and where it is."""
    index = np.unravel_index(int(find(error.values)), error.shape)
    place = {str(dim): int(position) for dim, position in zip(error.dims, index, strict=True)}
    places = [
        at(name, value, axis_unit(study, name))
        for name, value in parameters_at(study, place).items()
    ]
    return f"{percent(error.values[index], sign=True)} (at {', '.join(places)})"


def ranking(study: xr.Dataset, table: pd.DataFrame) -> Iterator[Finding]:
    """Which formula is closest, among those with a value everywhere."""
    rows = table[table["reference"] == reference_names(study)[0]]
    interpolants = [name for name, model in MODELS.items() if model.from_reference]
    yield from _interpolants(rows[rows["model"].isin(interpolants)])
    rows = rows[~rows["model"].isin(interpolants)]
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
                f"Of {len(complete)} formulas compared here none stays nearer to finite elements "
                f"than {bound} at every point: that is the largest error of "
                f"{model_phrase(safest['model'])}, the smallest of its kind; {closest}."
            )
            yield Finding(text, bound, "largest error of the best formula", "ranking")
        else:
            worst = f"the smallest largest error ({bound}) is that of"
            name = model_phrase(safest["model"])
            yield Finding(f"With {at(axis, value)} {closest}; {worst} {name}.")


def _interpolants(rows: pd.DataFrame) -> Iterator[Finding]:
    """How well models made from the reference give it back."""
    for _, row in rows[(rows["group_axis"] == "all") & (rows["points"] > 0)].iterrows():
        name = model_phrase(row["model"])
        yield Finding(
            f"{name[0].upper()}{name[1:]} interpolates finite elements and gives them back to "
            f"{percent(row['abs_error_max'])} at {row['points']} points."
        )


def lower_bound(table: pd.DataFrame) -> Iterator[Finding]:
    """The generatrix model must not lie above the reference where it is a bound."""
    rows = table[(table["model"] == "generatrix") & (table["group_axis"] == "all")]
    if "load" in rows:
        rows = rows[rows["load"].isin(["normal", "torsion"])]
    for _, row in rows[rows["points"] > 0].iterrows():
        slack = 0.0 if np.isnan(row["reference_error"]) else row["reference_error"]
        name = model_name(row["reference"])
        if row["error_max"] <= slack:
            yield Finding(
                "The generatrix model is a lower bound by theory; indeed it is nowhere above "
                f"{name}, at {row['points']} points compared."
            )
        else:
            yield Finding(
                f"The generatrix model should be a lower bound, but it is above {name} by up to "
                f"{percent(row['error_max'])}: one of the two is wrong there.",
                percent(row["error_max"], sign=True),
                "violation of a lower bound",
                topic="lower bound",
            )


def outside_range(table: pd.DataFrame) -> Iterator[Finding]:
    """Models that claim nothing at some points, and how they do at the others."""
    rows = table[(table["group_axis"] == "all") & (table["points_outside"] > 0)]
    for _, row in rows.iterrows():
        inside = row["points"] - row["points_outside"]
        text = (
            f"{model_phrase(row['model'])} is outside its stated range at {row['points_outside']} "
            f"of {row['points']} points"
        )
        if inside:
            text += f"; inside, its largest error is {percent(row['abs_error_max_inside'])}"
        yield Finding(f"{text[0].upper()}{text[1:]}.")
