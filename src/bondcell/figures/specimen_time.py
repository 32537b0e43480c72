"""Error in energy against run time, lattices and meshes of the solid on one plot."""

from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.ticker import FuncFormatter, LogLocator, NullLocator

from bondcell.figures.specimen_style import METHODS
from bondcell.figures.style import GREY, Drawing, new_figure
from bondcell.specimen.view import NAMES, Results, error_table, first_walls
from bondcell.wording import percent, quantity


def draw_time(results: Results) -> Drawing:
    """A panel for each loading; the band below which the reference itself is unsure is grey.

    Parameters
    ----------
    results
        All groups.
    """
    study = results[""]
    walls = first_walls(study)
    table = error_table(results)
    table = table[table["walls"] == walls]
    loadings = list(dict.fromkeys(table["loading"]))
    figure = new_figure(7.4, 4.2)
    panels = figure.subplots(1, len(loadings), sharey=True, squeeze=False)[0]
    found: dict[str, Any] = {}
    for axes, loading in zip(panels, loadings, strict=True):
        found |= _panel(axes, table[table["loading"] == loading])
        doubt = float(study["reference_error"].sel(loading=loading, walls=walls))
        if np.isfinite(doubt):
            axes.axhspan(1e-6, max(doubt, 2e-6), color=GREY, alpha=0.15, linewidth=0)
        axes.set_title(f"{loading} loading")
    panels[0].set_ylabel("error of the energy, |U / U_best − 1|")
    figure.legend(found.values(), found.keys(), loc="outside upper center", ncols=3)
    caption = (
        f"Error of the energy against run time, {walls} walls: lattices with the finite elements "
        "of their bonds (and of the pockets' cell), the solid without its mesh; in the grey band "
        "the solid's limit is itself unsure"
    )
    return Drawing(figure, "error_against_time", f"{caption}.", _description(table))


def _panel(axes: Axes, table: pd.DataFrame) -> dict[str, Any]:
    found = {}
    for (method, order), rows in table.groupby(["method", "order"], sort=False, dropna=False):
        name, style = NAMES[str(method)], METHODS[str(method)]
        if order > 2:
            name, style = f"{name}, order {order:g}", style | {"markerfacecolor": "white"}
        (found[name],) = axes.plot(
            rows["seconds"],
            np.maximum(rows["energy_error"].abs(), 1e-5),
            linestyle="-" if len(rows) > 1 else "none",
            markersize=6 if order <= 2 or np.isnan(order) else 5 + order,
            **style,
        )
    axes.set(xscale="log", yscale="log", xlabel="time")
    lowest = max(1e-4, 0.5 * float(table["energy_error"].abs().min()))
    axes.set_ylim(lowest, 1.5)
    axes.xaxis.set_major_locator(LogLocator(numticks=6))
    axes.xaxis.set_minor_locator(NullLocator())
    axes.xaxis.set_major_formatter(FuncFormatter(lambda value, _: quantity(value, "s", 1)))
    axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: percent(value, 1)))
    return found


def _description(table: pd.DataFrame) -> str:
    words = [
        f"{row.loading}, {NAMES[row.method]}"
        + ("" if np.isnan(row.per_gap) else f" at {row.per_gap:g} of the gap, order {row.order:g}")
        + f": {percent(row.energy_error, sign=True)} in {quantity(row.seconds, 's', 2)}"
        for row in table.itertuples()
    ]
    return "; ".join(words) + "."
