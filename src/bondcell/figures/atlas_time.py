"""Error against run time: one point a model, over a whole atlas."""

from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.ticker import FuncFormatter, LogLocator, NullLocator

from bondcell.figures.style import Drawing, marker_style, new_figure
from bondcell.wording import listed, model_name, percent, quantity

LEAST, MOST = 1e-9, 30.0
"""Errors that are drawn."""


def draw_error_against_time(table: pd.DataFrame) -> Drawing:
    """A panel for each load.

    Parameters
    ----------
    table
        See `bondcell.results.atlas.error_against_time`.
    """
    loads = list(dict.fromkeys(table["load"]))
    figure = new_figure(8.6, 1.0 + 2.9 * -(-len(loads) // 2))
    grid = figure.subplots(-(-len(loads) // 2), 2, sharex=True, sharey=True, squeeze=False)
    handles: dict[str, Any] = {}
    for axes in grid.ravel()[len(loads) :]:
        axes.set_visible(False)
    for axes, load in zip(grid.ravel(), loads, strict=False):
        rows = table[table["load"] == load]
        for position, (_, row) in enumerate(rows.iterrows()):
            handles.setdefault(model_name(row["model"]), _draw(axes, row, position))
        axes.set_title(load)
        _scales(axes)
    for axes in grid[:, 0]:
        axes.set_ylabel("relative error")
    for axes in grid[-1]:
        axes.set_xlabel("time a point of this sweep")
    figure.legend(handles.values(), handles.keys(), loc="outside upper center", ncols=5)
    caption = (
        "Error against run time over the whole atlas: the marker is the median error of a model, "
        "its line goes up to the largest inside the model's stated range, dotted to the largest "
        "of all. Finite elements: their own estimate. A point of a sweep shares its geometry with "
        "others; one by itself costs more with film, bounds and finite elements."
    )
    return Drawing(figure, "error_against_time", caption, _in_words(table))


def _draw(axes: Axes, row: pd.Series, position: int) -> Any:
    style = marker_style(row["model"], position)
    median, inside, worst = (
        float(np.clip(row[name], LEAST, MOST)) if np.isfinite(row[name]) else np.nan
        for name in ("abs_error_median", "abs_error_max_inside", "abs_error_max")
    )
    x, colour = row["seconds"], style["color"]
    axes.plot([x, x], [median, worst], color=colour, linestyle=":", linewidth=1)
    axes.plot([x, x], [median, inside], color=colour, linestyle="-", linewidth=1.6)
    axes.plot([x], [inside], color=colour, marker="_", markersize=8)
    return axes.plot([x], [median], **style)[0]


def _scales(axes: Axes) -> None:
    axes.set(xscale="log", yscale="log", ylim=(LEAST, 2 * MOST))
    axes.yaxis.set_major_locator(LogLocator(numticks=12))
    axes.xaxis.set_major_locator(LogLocator(numticks=9))
    axes.xaxis.set_major_formatter(FuncFormatter(lambda value, _: quantity(value, "s", 1)))
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_minor_locator(NullLocator())
    axes.tick_params(labelleft=True)


def _in_words(table: pd.DataFrame) -> str:
    sentences = []
    for load, rows in table.groupby("load", sort=False):
        parts = [
            f"{model_name(row['model'])} {percent(row['abs_error_median'])} in the median, "
            f"{percent(row['abs_error_max'])} at most, {quantity(row['seconds'], 's', 2)}"
            for _, row in rows.iterrows()
        ]
        sentences.append(f"Load {load}: {listed(['; '.join(parts)])}")
    return ". ".join(sentences) + "."
