"""Error estimate against time at every point of the reference, by flag."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.ticker import FuncFormatter, LogLocator, NullLocator

from bondcell.figures.style import BLACK, Drawing, new_figure
from bondcell.results.stability import stability_table
from bondcell.wording import listed, number, quantity

FLAGS: dict[str, dict[str, Any]] = {
    "ok": {"color": "#0072b2", "marker": "o"},
    "tolerance_not_met": {"color": "#d55e00", "marker": "^"},
    "limit_exceeded": {"color": "#cc79a7", "marker": "s"},
    "solver_failed": {"color": BLACK, "marker": "x"},
    "mesh_failed": {"color": BLACK, "marker": "+"},
    "diverges": {"color": "#009e73", "marker": "D"},
}
"""Marker of each flag."""

COLUMNS = 3
NO_VALUE = 1.0
"""Where points without an estimate are drawn."""


def draw_stability(loads: Mapping[str, xr.Dataset], name: str = "stability") -> Drawing:
    """A panel for each load; points without an estimate stand at 1.

    Parameters
    ----------
    loads
        Load -> result.
    name
        File name without suffix.
    """
    table = stability_table(loads)
    kinds = list(loads)
    rows = -(-len(kinds) // COLUMNS)
    width = 5.6 if len(kinds) == 1 else 3.2 * min(COLUMNS, len(kinds))
    figure = new_figure(width, 0.7 + 3.1 * rows)
    grid = figure.subplots(rows, min(COLUMNS, len(kinds)), sharey=True, squeeze=False)
    found: dict[str, Any] = {}
    for axes, load in zip(grid.ravel(), kinds, strict=False):
        found |= _panel(axes, table[table["load"] == load])
        axes.set_title(load)
    for axes in grid.ravel()[len(kinds) :]:
        axes.set_visible(False)
    for axes in grid[:, 0]:
        axes.set_ylabel("estimated relative error")
    figure.legend(found.values(), found.keys(), loc="outside upper center", ncols=3)
    caption = (
        "Estimated error of the reference over the time of a point, a mark for each corner; marks "
        "at 1 have no value"
    )
    return Drawing(figure, name, f"{caption}.", _description(table))


def _panel(axes: Axes, table: pd.DataFrame) -> dict[str, Any]:
    found = {}
    for flag, rows in table.groupby("status", sort=False):
        style = FLAGS.get(str(flag), {"color": BLACK, "marker": "*"})
        estimate = rows["error_estimate"].fillna(NO_VALUE).to_numpy()
        seconds = np.maximum(rows["seconds"].to_numpy(dtype=float), 1e-6)
        (found[str(flag).replace("_", " ")],) = axes.plot(
            seconds, np.maximum(estimate, 1e-16), linestyle="none", markersize=4.5, **style
        )
    axes.set(xscale="log", yscale="log", xlabel="time of a point")
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_locator(LogLocator(numticks=7))
        axis.set_minor_locator(NullLocator())
    axes.xaxis.set_major_formatter(FuncFormatter(lambda value, _: quantity(value, "s", 1)))
    return found


def _description(table: pd.DataFrame) -> str:
    sentences = []
    for load, rows in table.groupby("load", sort=False):
        flags = rows["status"].value_counts()
        counts = [f"{n} {str(flag).replace('_', ' ')}" for flag, n in flags.items()]
        worst = number(rows["error_estimate"].max(), 2)
        sentences.append(f"{load}: {listed(counts)}; largest estimate {worst}")
    return ". ".join(sentences) + "."
