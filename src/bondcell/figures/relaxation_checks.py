"""Error against run time of the methods in time, and the check of every series."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr
from matplotlib.ticker import FuncFormatter, LogLocator, NullLocator

from bondcell.figures.style import BLACK, GREY, Drawing, marker_style, new_figure
from bondcell.results.relaxation_tables import methods_table, relaxation_stability
from bondcell.results.relaxation_view import series_words
from bondcell.wording import METHODS, model_name, number, percent, quantity

STYLES: dict[str, dict[str, Any]] = {
    "exact_series": {"color": "#d55e00", "marker": "o", "linestyle": "-"},
    "time_stepping": {"color": "#0072b2", "marker": "s", "linestyle": "--"},
    "laplace_inversion": {"color": "#009e73", "marker": "^", "linestyle": "-."},
    "shortcut": {"color": GREY, "marker": "X", "linestyle": "none", "markersize": 8},
}

SMALLEST = 1e-17
"""Where a check without any difference is drawn."""


def draw_methods(methods: xr.Dataset, name: str = "relaxation_methods") -> Drawing:
    """A panel for each case: error over run time, set-up included.

    Parameters
    ----------
    methods
        The group of the comparison.
    name
        File name without suffix.
    """
    table = methods_table(methods)
    cases = list(dict.fromkeys(table["case"]))
    figure = new_figure(5.6 if len(cases) == 1 else 3.4 * len(cases), 4.0)
    grid = figure.subplots(1, len(cases), sharey=True, squeeze=False)[0]
    found: dict[str, Any] = {}
    sentences = []
    for axes, case in zip(grid, cases, strict=True):
        here = table[(table["case"] == case) & table["error"].notna()]
        for method, rows in here.groupby("method", sort=False):
            (found[METHODS[str(method)]],) = axes.plot(
                rows["seconds"], np.maximum(rows["error"], 1e-16), **STYLES[str(method)]
            )
            best = rows.loc[rows["error"].idxmin()]
            words = f"{percent(best['error'])} in {quantity(best['seconds'], 's', 2)}"
            sentences.append(f"{series_words(case)}, {METHODS[str(method)]}: {words}")
        axes.set(xscale="log", yscale="log", xlabel="run time, set-up included")
        axes.xaxis.set_minor_locator(NullLocator())
        axes.xaxis.set_major_formatter(FuncFormatter(lambda v, _: quantity(v, "s", 1)))
        axes.set_title(series_words(case))
    grid[0].set_ylabel("largest relative error of K(t)")
    figure.legend(found.values(), found.keys(), loc="outside upper center", ncols=2)
    caption = (
        "Largest error of K(t) over run time by finite elements: the exact series of a finer and "
        "finer mesh, time stepping and Laplace inversion of one mesh with more and more steps or "
        "nodes, and the shortcut K(0) g(t)."
    )
    return Drawing(figure, name, caption, ". ".join(sentences) + ".")


def draw_checks(loads: Mapping[str, xr.Dataset], name: str = "relaxation_checks") -> Drawing:
    """Difference of every series from elastic stiffnesses over what its estimates allow.

    Parameters
    ----------
    loads
        Load -> result with checks.
    name
        File name without suffix.
    """
    table = relaxation_stability(loads)
    figure = new_figure(5.6, 4.2)
    axes = figure.subplots()
    known = table[table["check_error"].notna()]
    for position, (model, rows) in enumerate(known.groupby("model", sort=False)):
        style = marker_style(str(model), position) | {"markersize": 4.5}
        error = np.maximum(rows["check_error"].to_numpy(), SMALLEST)
        axes.plot(rows["check_allowed"], error, label=model_name(str(model)), **style)
    ends = np.array([SMALLEST, 1.0])
    axes.plot(ends, ends, color=BLACK, linewidth=0.8)
    axes.set(xscale="log", yscale="log", xlim=_limits(known), ylim=(SMALLEST / 3, 1))
    axes.set_xlabel("allowed by the error estimates of both sides")
    axes.set_ylabel("largest difference from the elastic stiffness")
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_locator(LogLocator(numticks=9))
        axis.set_minor_locator(NullLocator())
    figure.legend(loc="outside upper center", ncols=4)
    caption = (
        "Check of every series at real Laplace variables, where it must be the elastic stiffness "
        "of the modulus there: below the line it is within what the error estimates allow."
    )
    return Drawing(figure, name, caption, _description(known))


def _limits(known: pd.DataFrame) -> tuple[float, float]:
    allowed = known["check_allowed"]
    return (float(allowed.min()) / 10, float(allowed.max()) * 10) if len(known) else (1e-13, 1.0)


def _description(known: pd.DataFrame) -> str:
    sentences = []
    for model, rows in known.groupby("model", sort=False):
        within = int((rows["check_error"] <= rows["check_allowed"]).sum())
        worst = number(rows["check_error"].max(), 2)
        words = f"{within} of {len(rows)} series within, largest difference {worst}"
        sentences.append(f"{model_name(str(model))}: {words}")
    return ". ".join(sentences) + "."
