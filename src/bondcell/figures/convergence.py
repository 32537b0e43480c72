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

from bondcell.figures.style import BLACK, Drawing, marker_style, new_figure
from bondcell.results.convergence import BASIS, GRADED, STRUCTURED, TRIANGLES, convergence_table
from bondcell.wording import case_name, ladder_name, listed, model_name, number, quantity

LADDERS: dict[str, dict[str, Any]] = {
    STRUCTURED: {"color": BLACK, "linestyle": "-", "marker": "o", "markersize": 4.5},
    GRADED: {"color": "#6b6b6b", "linestyle": ":", "marker": "s", "markersize": 4},
    TRIANGLES: {"color": "#d55e00", "linestyle": "--", "marker": "^", "markersize": 5.5},
    BASIS: {"color": "#0072b2", "linestyle": "-", "marker": "x", "markersize": 5},
}
"""How each discretisation is drawn."""

_BASIS_LINES: dict[str, dict[str, Any]] = {
    "bound": {"color": "#0072b2", "linestyle": "--", "marker": "v", "label": "bound"},
    "sample_error": {"color": BLACK, "linestyle": "-", "marker": "o", "label": "true error"},
}
"""What is drawn of a growing basis."""

EDGE = 3
"""Cases beside each other."""


def convergence_drawings(convergence: xr.Dataset) -> Iterator[Drawing]:
    """Error over unknowns, over run time with the analytic models, and over a basis' size.

    Parameters
    ----------
    convergence
        A convergence study on ``(case, method, level)``.
    """
    table = convergence_table(convergence)
    ladders = table[table["level"].notna() & (table["method"] != BASIS)]
    if ladders["error"].notna().any():
        yield _drawing(
            ladders,
            "dof",
            "convergence_dof",
            "degrees of freedom",
            "Error of each discretisation, against the finest structured level, over the number "
            "of unknowns",
        )
    if table["error"].notna().any():
        yield _drawing(
            table,
            "seconds",
            "convergence_time",
            "run time",
            "Error against run time: the discretisations level by level (mesh, assembly and "
            "solution of one cell), a growing reduced basis and the analytic models by one point "
            "of many",
        )
    if table["sample_error"].notna().any():
        yield _basis_drawing(table[table["sample_error"].notna()])


def _basis_drawing(table: pd.DataFrame) -> Drawing:
    """Bound and true error of a reduced basis over its size, a panel for each case."""
    cases = list(dict.fromkeys(table["case"]))
    figure, panels = _panels(cases)
    for axes, case in zip(panels, cases, strict=False):
        here = table[table["case"] == case]
        axes.set_yscale("log")
        for name, style in _BASIS_LINES.items():
            axes.plot(here["refinement"], here[name], markersize=4.5, **style)
        axes.yaxis.set_major_locator(LogLocator(numticks=9))
        axes.yaxis.set_minor_locator(NullLocator())
        axes.set_title(_title(here))
        axes.set_ylabel("relative error")
        axes.set_xlabel("vectors in the basis")
    _legend(figure, np.array(panels))
    caption = (
        "Largest error of the reduced basis over random materials on one geometry (modulus ratios "
        "up to 1e8, Poisson's ratios of the matrix from 0 to 0.4999) over its size: the bound that "
        "it gives itself, and the true error against solutions without it"
    )
    words = ". ".join(
        f"{case_name(str(case))}: bound {number(rows['bound'].iloc[-1], 2)} and true error "
        f"{number(rows['sample_error'].iloc[-1], 2)} with {int(rows['refinement'].iloc[-1])} "
        "vectors"
        for case, rows in table.groupby("case", sort=False)
    )
    return Drawing(figure, "convergence_basis", f"{caption}.", f"{words}.")


def _title(here: pd.DataFrame) -> str:
    """Case with its boundary condition, or its load where there is no choice of conditions."""
    row = here.iloc[0]
    if row["load"] in row["case"]:
        return case_name(row["case"])
    return f"{case_name(row['case'])} ({row['bc'] if row['load'] == 'normal' else row['load']})"


def _panels(cases: list[str]) -> tuple[Figure, list[Axes]]:
    columns = min(EDGE, len(cases))
    rows = -(-len(cases) // columns)
    figure = new_figure(max(4.9, 3.2 * columns), 0.8 + 3.1 * rows)
    grid = figure.subplots(rows, columns, sharey=True, squeeze=False)
    for axes in grid.ravel()[len(cases) :]:
        axes.set_visible(False)
    return figure, list(grid.ravel()[: len(cases)])


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
        axes.set_title(_title(here))
    for axes in grid[:, 0]:
        axes.set_ylabel("relative error of the stiffness")
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
