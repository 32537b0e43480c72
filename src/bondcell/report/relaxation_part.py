"""What the page says on relaxation: accuracy over time, methods, checks, bonds' own series."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd
import xarray as xr

from bondcell.report.findings import Finding
from bondcell.report.relaxation_lines import (
    accuracy_lines,
    bond_lines,
    methods_lines,
    place,
    series_lines,
    stability_lines,
)
from bondcell.report.tables import Table
from bondcell.results.relaxation_names import METHODS as METHODS_GROUP
from bondcell.results.relaxation_tables import (
    accuracy_over_time,
    methods_table,
    relaxation_stability,
)
from bondcell.results.relaxation_view import convention_words, series_words
from bondcell.storage import read_dataset
from bondcell.wording import METHODS, listed, model_phrase, number, percent, quantity

SHORTCUT = "shortcut"


@dataclass(frozen=True)
class Relaxing:
    """A scene's relaxation as the page needs it.

    Parameters
    ----------
    study
        Result under the first load.
    accuracy, stability
        See `bondcell.results.relaxation_tables`; empty where there is nothing to compare or check.
    methods
        Convergence table of the methods in time, empty without.
    bonds
        The bonds' own series, None where the file is missing.
    """

    study: xr.Dataset
    accuracy: pd.DataFrame
    stability: pd.DataFrame
    methods: pd.DataFrame
    bonds: xr.Dataset | None


def read_relaxing(folder: Path, loads: Mapping[str, xr.Dataset], *, with_methods: bool) -> Relaxing:
    """Put together what a scene's files say.

    Parameters
    ----------
    folder
        The scene's folder of results.
    loads
        Load -> result.
    with_methods
        Whether methods in time were compared.
    """
    methods = pd.DataFrame()
    if with_methods:
        methods = methods_table(read_dataset(folder / "study.nc", METHODS_GROUP))
    path = folder / "bond_series.nc"
    return Relaxing(
        study=next(iter(loads.values())),
        accuracy=accuracy_over_time(loads),
        stability=relaxation_stability(loads),
        methods=methods,
        bonds=read_dataset(path) if path.is_file() else None,
    )


def relaxation_findings(found: Relaxing) -> list[Finding]:
    """Sentences that the results warrant."""
    return [
        *_over_time(found),
        *_best(found),
        *_shortcut(found),
        *_methods(found),
        *_stability(found),
        *_bonds(found),
        *_materials(found),
    ]


def relaxation_lines(found: Relaxing) -> list[Table | None]:
    """Tables on accuracy over time, methods, checks, bonds and series."""
    return [
        accuracy_lines(found.accuracy, found.study),
        methods_lines(found.methods),
        stability_lines(found.stability, found.study),
        bond_lines(found.bonds),
        series_lines(found.study),
    ]


def _over_time(found: Relaxing) -> Iterator[Finding]:
    """The model whose error grows most where Poisson's ratio rises."""
    table = _of_models(found.accuracy)
    table = table[table["error_start"].notna() & table["error_end"].notna()]
    if table.empty:
        return
    growth = table["error_end"].abs() - table["error_start"].abs()
    row = table.loc[growth.idxmax()]
    if growth.max() < 0.02:
        text = "No model's error grows by more than two per cent of K as the matrix relaxes."
        yield Finding(text)
        return
    start, end = (percent(row[name], sign=True) for name in ("error_start", "error_end"))
    rise = f"{number(row['poisson_start'], 6)} to {number(row['poisson_end'], 6)}"
    yield Finding(
        f"A model that is good at t = 0 need not be good later: the error of "
        f"{model_phrase(row['model'])} goes from {start} at t = 0 to {end} at the last time, while "
        f"Poisson's ratio of the matrix rises from {rise} ({place(row, found.study)}).",
        f"{start} → {end}",
        f"error of {model_phrase(row['model'])} from t = 0 to the end of relaxation",
        "relaxation",
    )


def _best(found: Relaxing) -> Iterator[Finding]:
    """Largest error over all times of every model, best first."""
    table = _of_models(found.accuracy)
    worst = table.groupby("model")["abs_error_max"].max().dropna().sort_values()
    if worst.empty:
        return
    words = [f"{model_phrase(str(m))} {percent(error)}" for m, error in worst.items()]
    yield Finding(f"Largest error over all times, series and points: {listed(words)}.")
    left = table[table["left_valid_range_at"].notna()]
    if not left.empty:
        names = listed(model_phrase(str(name)) for name in dict.fromkeys(left["model"]))
        yield Finding(
            f"In {len(left)} of {len(table)} curves the model is outside its valid range at some "
            f"time, and flagged there: {names}."
        )


def _shortcut(found: Relaxing) -> Iterator[Finding]:
    if found.accuracy.empty:
        return
    table = found.accuracy[found.accuracy["model"] == SHORTCUT]
    worst = table.groupby("convention", sort=False)["abs_error_max"].max().dropna()
    if worst.empty:
        return
    words = [f"{percent(e)} with a {convention_words(str(c))}" for c, e in worst.items()]
    yield Finding(
        f"The tempting shortcut K(0) g(t) is wrong by up to {listed(words)}.",
        percent(worst.max()),
        "error of the shortcut K(0) g(t)",
        "shortcut",
    )


def _methods(found: Relaxing) -> Iterator[Finding]:
    table = found.methods
    if table.empty:
        return
    good = table[table["error"].notna()]
    best = {
        str(method): rows.loc[rows["error"].idxmin()]
        for method, rows in good.groupby("method", sort=False)
    }
    words = [
        f"{METHODS[name]} {percent(row['error'])} in {quantity(row['seconds'], 's', 2)}"
        for name, row in best.items()
    ]
    text = f"Error of K(t) against run time, the best of each way: {listed(words)}."
    if {"exact_series", "time_stepping"} <= set(best):
        exact, steps = best["exact_series"], best["time_stepping"]
        faster = good[(good["method"] == "exact_series") & (good["error"] < steps["error"])]
        if not faster.empty:
            gain = steps["seconds"] / faster["seconds"].min()
            text += f" The error of the finest stepping costs the exact series 1/{number(gain, 2)} "
            text += "of its time."
        yield Finding(
            text, percent(exact["error"]), "error of the exact series of finite elements", "methods"
        )
        return
    yield Finding(text)


def _stability(found: Relaxing) -> Iterator[Finding]:
    table = found.stability
    if table.empty:
        return
    sound = int(table["sound"].sum())
    ratio = (table["check_error"] / table["check_allowed"]).max()
    text = (
        f"{sound} of {len(table)} series are sound: their difference from elastic stiffnesses at "
        f"real Laplace variables is within the error estimates (at most {percent(ratio)} of them) "
        "and K never rises, or a flag says that there is no value."
    )
    yield Finding(text, f"{sound} of {len(table)}", "extreme series that are sound", "checks")
    fluids = table[table["is_fluid"] & table["K_inf"].notna()]
    if not fluids.empty:
        nothing = int((fluids["K_inf"] == 0).sum())
        yield Finding(
            f"{nothing} of {len(fluids)} bonds in a matrix that relaxes to a fluid end in nothing."
        )
    lost = table[table["K_start"].isna()]
    if not lost.empty:
        flags = lost["status"].value_counts()
        words = listed(f"{n} {str(flag).replace('_', ' ')}" for flag, n in flags.items())
        yield Finding(f"Without a value, by their flag: {words}.")


def _bonds(found: Relaxing) -> Iterator[Finding]:
    bonds = found.bonds
    if bonds is None:
        return
    terms = np.isfinite(bonds["K_k"].values).sum(axis=-1)
    count = terms[np.isfinite(bonds["K_inf"].values)]
    if not count.size:
        return
    text = f"bond_series.csv holds {count.size} series of bonds"
    if "reduction_error" in bonds:
        error = bonds["reduction_error"].values
        window = [quantity(bonds.attrs[f"window_{end}"], "s", 2) for end in ("start", "end")]
        text += (
            f", reduced to at most {count.max()} terms with an error of K(t) of "
            f"{percent(np.nanmin(error))} to {percent(np.nanmax(error))} between "
            f"{window[0]} and {window[1]}; the exact ones are in study.nc."
        )
    else:
        text += f", exact, of {count.min()} to {count.max()} terms."
    yield Finding(text)


def _materials(found: Relaxing) -> Iterator[Finding]:
    kinds = found.study["series_kind"].values
    names = [
        series_words(str(name))
        for name, kind in zip(found.study["series"].values, kinds, strict=True)
        if kind == "mixture"
    ]
    if names:
        verb = "is a mixture" if len(names) == 1 else "are mixtures"
        yield Finding(
            f"{listed(names)} {verb}, binder with aggregate as a whole: as the matrix between two "
            "stones they stand in for the mastic, whose coefficients the sources do not give."
        )


def _of_models(table: pd.DataFrame) -> pd.DataFrame:
    """The table without the shortcut; empty tables have no columns."""
    columns = ["model", "error_start", "error_end", "abs_error_max", "left_valid_range_at"]
    if table.empty:
        return pd.DataFrame(columns=columns)
    return table[table["model"] != SHORTCUT]
