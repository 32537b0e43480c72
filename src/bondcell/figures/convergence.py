"""What accuracy costs: error over unknowns and over run time."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, NullLocator

from bondcell.convergence import STRUCTURED, TRIANGLES, convergence_table
from bondcell.figures.style import BLACK, Drawing, marker_style, new_figure
from bondcell.wording import case_name, ladder_name, listed, model_name, number, quantity

LADDERS: dict[str, dict[str, Any]] = {
    STRUCTURED: {"color": BLACK, "linestyle": "-", "marker": "o", "markersize": 4.5},
    TRIANGLES: {"color": "#d55e00", "linestyle": "--", "marker": "^", "markersize": 5.5},
}
"""How each discretisation is drawn."""

EDGE = 3
"""Cases beside each other."""


def convergence_drawings(convergence: xr.Dataset) -> Iterator[Drawing]:
    """Error over unknowns, and error over run time with the analytic models.

    Parameters
    ----------
    convergence
        A convergence study on ``(case, method, level)``.
    """
    table = convergence_table(convergence)
    ladders = table[table["level"].notna()]
    if ladders["error"].notna().any():
        yield _drawing(
            ladders,
            "dof",
            "convergence_dof",
            "degrees of freedom",
            "Error of both discretisations, against the finest structured level, over the number "
            "of unknowns",
        )
    if table["error"].notna().any():
        yield _drawing(
            table,
            "seconds",
            "convergence_time",
            "run time",
            "Error against run time: the discretisations level by level (mesh, assembly and "
            "solution of one cell), the analytic models as single marks (one point of many)",
        )


def _drawing(table: pd.DataFrame, work: str, name: str, label: str, caption: str) -> Drawing:
    cases = list(dict.fromkeys(table["case"]))
    columns = min(EDGE, len(cases))
    rows = -(-len(cases) // columns)
    figure = new_figure(max(4.9, 3.2 * columns), 0.8 + 3.1 * rows)
    grid = figure.subplots(rows, columns, sharex=True, sharey=True, squeeze=False)
    for axes in grid.ravel()[len(cases) :]:
        axes.set_visible(False)
    for axes, case in zip(grid.ravel(), cases, strict=False):
        here = table[table["case"] == case]
        _panel(axes, here, work)
        axes.set_title(f"{case_name(case)} ({here['bc'].iloc[0]})")
    for axes in grid[:, 0]:
        axes.set_ylabel("relative error of $K_n$")
    for axes in grid[-1]:
        axes.set_xlabel(label)
    _legend(figure, grid)
    end = ", a panel for each case." if len(cases) > 1 else "."
    return Drawing(figure, name, caption + end, _description(table, work))


def _panel(axes: Axes, here: pd.DataFrame, work: str) -> None:
    axes.set_xscale("log")
    axes.set_yscale("log")
    models = 0
    for method, rows in here.groupby("method", sort=False):
        drawn = rows[rows["error"].notna() & (rows["error"] > 0)]
        x = drawn[work].to_numpy(dtype=float)
        y = drawn["error"].to_numpy(dtype=float)
        if method in LADDERS:
            axes.plot(x, y, label=ladder_name(str(method)), **LADDERS[str(method)])
        else:
            # Hollow, for models lie close together here.
            style = marker_style(str(method), models) | {
                "fillstyle": "none",
                "markeredgewidth": 1.8,
            }
            axes.plot(x, y, label=model_name(str(method)), **style)
            models += 1
    axes.yaxis.set_major_locator(LogLocator(numticks=9))
    axes.yaxis.set_minor_locator(NullLocator())
    axes.xaxis.set_minor_locator(NullLocator())
    if work == "seconds":
        axes.xaxis.set_major_locator(LogLocator(numticks=6))
        axes.xaxis.set_major_formatter(FuncFormatter(lambda value, _: quantity(value, "s", 1)))
    else:
        axes.xaxis.set_major_locator(LogLocator(subs=(1, 3), numticks=9))
        axes.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:.0f}"))


def _legend(figure: Figure, grid: np.ndarray[Any, Any]) -> None:
    found: dict[str, Any] = {}
    for axes in grid.ravel():
        handles, labels = axes.get_legend_handles_labels()
        found = dict(zip(labels, handles, strict=True)) | found
    width = figure.get_size_inches()[0]
    figure.legend(
        found.values(), found.keys(), loc="outside upper center", ncols=max(2, int(width / 1.7))
    )


def _description(table: pd.DataFrame, work: str) -> str:
    sentences = []
    for (case, method), rows in table.groupby(["case", "method"], sort=False):
        drawn = rows[rows["error"].notna()]
        if drawn.empty:
            continue
        name = ladder_name(str(method)) if method in LADDERS else model_name(str(method))
        ends = [drawn.iloc[0], drawn.iloc[-1]] if len(drawn) > 1 else [drawn.iloc[0]]
        steps = [f"{number(end['error'], 2)} at {_work(end[work], work)}" for end in ends]
        sentences.append(f"{case_name(str(case))}, {name}: error {listed(steps, 'to')}")
    return ". ".join(sentences) + "."


def _work(value: Any, work: str) -> str:
    return quantity(value, "s", 2) if work == "seconds" else f"{int(value)} unknowns"
