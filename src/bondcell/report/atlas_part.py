"""What the page says on an accuracy atlas: sentences and tables."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np
import pandas as pd
import xarray as xr

from bondcell.models import MODELS
from bondcell.report.findings import Finding
from bondcell.report.tables import Table
from bondcell.results.atlas import (
    ANY,
    BAND_WORDS,
    BANDS,
    accuracy_by_region,
    best_models,
    error_against_time,
    is_formula,
    valid_everywhere,
    worst_errors,
)
from bondcell.results.view import REFERENCE, analytic_names
from bondcell.wording import listed, model_name, model_phrase, percent, quantity

PAPER, BEST = "fsi", "film"
"""The model that the study started from, and the one made to replace it."""

FIRST = ("fsi", "film", "bounds", "surrogate", "generatrix")
"""Models whose columns come first: a table may be wider than the page."""

SHOWN = (0.1, 0.03, 0.01, 1e-3)
"""Wanted errors in the table of best models."""


def atlas_findings(loads: Mapping[str, xr.Dataset], table: pd.DataFrame) -> Iterator[Finding]:
    """How good the paper's model and its successor are, and what serves where.

    Parameters
    ----------
    loads
        Load -> result of an atlas.
    table
        See `bondcell.results.atlas.accuracy_by_region`.
    """
    yield from _paper(table)
    yield from _successor(table)
    yield from _interpolant(table)
    for load, study in loads.items():
        yield _serving(load, study)
    yield from _cost(table)


def _whole(table: pd.DataFrame) -> pd.DataFrame:
    return error_against_time(table)


def _paper(table: pd.DataFrame) -> Iterator[Finding]:
    rows = table[(table["model"] == PAPER) & (table["load"] == "normal")]
    bands = rows[(rows[["gaps", "particles"]] == ANY).all(axis=1) & (rows["poisson"] != ANY)]
    everywhere = _whole(rows)
    if everywhere.empty:
        return
    row = everywhere.iloc[0]
    parts = [
        f"{percent(band['abs_error_median'])} for {BAND_WORDS[band['poisson']]}"
        for _, band in bands.iterrows()
    ]
    text = (
        f"FSI, the paper's model, is off by {percent(row['abs_error_median'])} in the median and "
        f"{percent(row['abs_error_max'])} at most"
    )
    text += f"; in the median {listed(parts)}." if len(parts) > 1 else "."
    yield Finding(text, percent(row["abs_error_median"]), "median error of FSI", "series model")


def _successor(table: pd.DataFrame) -> Iterator[Finding]:
    rows = _whole(table[table["model"] == BEST])
    if rows.empty:
        return
    parts = [
        f"{row['load']} {percent(row['abs_error_median'])} and "
        f"{percent(row['abs_error_max_inside'])}"
        for _, row in rows.iterrows()
    ]
    worst, median = rows["abs_error_max_inside"].max(), rows["abs_error_median"].max()
    cost = quantity(rows["seconds"].max(), "s", 2)
    yield Finding(
        f"The {model_name(BEST)} model, with nothing calibrated, is off by (median, and at most "
        f"inside its stated range): {listed(parts, 'and')}.",
        percent(worst),
        f"largest error of the {model_name(BEST)} model, all loads",
        "best formula",
        f"Use the {model_name(BEST)} model instead: inside its stated range it is within "
        f"{percent(worst)} of finite elements, {percent(median)} or less in the median, under "
        f"{listed(rows['load'])} load{'s' if len(rows) > 1 else ''}, at {cost} a point or less.",
    )


def _interpolant(table: pd.DataFrame) -> Iterator[Finding]:
    rows = _whole(table)
    rows = rows[[name in MODELS and MODELS[name].from_reference for name in rows["model"]]]
    for name, group in rows[rows["points"] > 0].groupby("model", sort=False):
        phrase = model_phrase(str(name))
        yield Finding(
            f"{phrase[0].upper()}{phrase[1:]} gives finite elements back to "
            f"{percent(group['abs_error_max'].max())} under {listed(group['load'])} load"
            f"{'s' if len(group) > 1 else ''}, at {quantity(group['seconds'].max(), 's', 2)} a "
            "point or less."
        )


def _serving(load: str, study: xr.Dataset) -> Finding:
    """Share of the points at which each formula is within one per cent."""
    wanted, shares = 0.01, {}
    for name in analytic_names(study):
        if is_formula(name):
            good = np.abs(worst_errors(study, name)) <= wanted
            shares[name] = float((good & valid_everywhere(study, name)).mean())
    words = [
        f"{model_phrase(name)} at {percent(share)}"
        for name, share in sorted(shares.items(), key=lambda item: -item[1])
        if share > 0
    ]
    said = listed(words) if words else "no formula anywhere"
    return Finding(
        f"Load {load}: within {percent(wanted)} of finite elements, inside its range, is {said} "
        "of the points."
        if words
        else f"Load {load}: {said} is within {percent(wanted)}."
    )


def _cost(table: pd.DataFrame) -> Iterator[Finding]:
    rows = _whole(table)
    parts = [
        f"{model_phrase(name)} {_span(group['seconds'])}"
        for name, group in rows.groupby("model", sort=False)
        if name in (PAPER, BEST, "surrogate", REFERENCE)
    ]
    if parts:
        yield Finding(f"A point of this sweep takes: {listed(parts)}.")


def _span(seconds: pd.Series) -> str:
    low, high = quantity(seconds.min(), "s", 2), quantity(seconds.max(), "s", 2)
    return low if low == high else f"{low} to {high} (by load)"


def atlas_lines(table: pd.DataFrame) -> list[Table]:
    """Accuracy by region of each load, best models, error against run time.

    Parameters
    ----------
    table
        See `bondcell.results.atlas.accuracy_by_region`.
    """
    loads = dict.fromkeys(table["load"])
    regions = [_region_table(str(load), table[table["load"] == load]) for load in loads]
    best = best_models(table)
    return [_time_table(table), *regions, *(_best_table(best, str(load)) for load in loads)]


def _region_table(load: str, table: pd.DataFrame) -> Table:
    known = [name for name in dict.fromkeys(table["model"]) if name != REFERENCE]
    names = sorted(known, key=lambda name: FIRST.index(name) if name in FIRST else len(FIRST))
    lines = []
    keys = ["gaps", "particles", "poisson"]
    for key, group in table.groupby(keys, sort=False):
        if ANY in key and set(key) != {ANY}:
            continue
        cells = group.set_index("model")
        row = [_band(band) for band in key]
        row += [_errors(cells.loc[name]) for name in names]
        lines.append([*row, str(cells["points"].max())])
    bands = "; ".join(f"{band} {BAND_WORDS[band]}" for found in BANDS.values() for band in found)
    return Table(
        f"Load {load}: largest / median size of the error [%] by region; * some points are outside "
        f"the model's stated range, – some have no value. Bands: {bands}.",
        ["gaps", "particles", "ν_m", *(model_name(name) for name in names), "points"],
        lines,
        names=3,
    )


def _band(band: str) -> str:
    return "all" if band == ANY else band


def _errors(row: pd.Series) -> str:
    if not row["points"]:
        return "–"
    mark = "*" if row["points_outside"] else ""
    mark += "–" if row["left_out"] else ""
    largest, median = (
        percent(row[name]).removesuffix(" %") for name in ("abs_error_max", "abs_error_median")
    )
    return f"{largest} / {median}{mark}"


def _best_table(best: pd.DataFrame, load: str) -> Table:
    """By all combinations of bands for the normal load, by single bands for the others."""
    keys = ["gaps", "particles", "poisson"]
    shown = best[best["wanted"].isin(SHOWN) & (best["load"] == load)]
    lines = []
    for key, group in shown.groupby(keys, sort=False):
        bands = sum(band != ANY for band in key)
        if bands in (0, 3 if load == "normal" else 1):
            choices = [_choice(row) for _, row in group.iterrows()]
            lines.append([*(_band(band) for band in key), *choices])
    return Table(
        f"Load {load}: the cheapest formula whose largest error in a region is not above the "
        "wanted one, with its time a point of this sweep; where none serves, in brackets the "
        "cheapest other way.",
        ["gaps", "particles", "ν_m", *(percent(wanted) for wanted in SHOWN)],
        lines,
        names=7,
    )


def _choice(row: pd.Series) -> str:
    if row["formula"]:
        return f"{model_name(row['formula'])} {quantity(row['formula_seconds'], 's', 2)}"
    if row["model"]:
        return f"({model_name(row['model'])} {quantity(row['seconds'], 's', 2)})"
    return "–"


def _time_table(table: pd.DataFrame) -> Table:
    lines = [
        [
            row["load"],
            model_name(row["model"]),
            percent(row["abs_error_median"]),
            percent(row["abs_error_95"]),
            percent(row["abs_error_max"]),
            percent(row["abs_error_max_inside"]),
            quantity(row["seconds"], "s", 2),
            f"{row['points']} of {row['points'] + row['left_out']}",
            str(row["points_outside"]),
        ]
        for _, row in _whole(table).iterrows()
    ]
    header = [
        "load",
        "model",
        "median |error|",
        "95 of 100 below",
        "largest",
        "largest in range",
        "time a point",
        "compared",
        "outside range",
    ]
    caption = "Error and time of each model over the whole atlas; finite elements: their estimate."
    return Table(caption, header, lines, names=2)


def atlas_part(loads: Mapping[str, xr.Dataset]) -> tuple[list[Finding], list[Table]]:
    """Sentences and tables of an atlas.

    Parameters
    ----------
    loads
        As in `atlas_findings`.
    """
    table = accuracy_by_region(loads)
    return list(atlas_findings(loads, table)), atlas_lines(table)
