"""Error of each model over two axes: where it may be trusted and where not."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import BoundaryNorm, Colormap, ListedColormap
from matplotlib.figure import Figure
from matplotlib.patheffects import withStroke
from matplotlib.ticker import NullLocator

from bondcell.figures.layout import Layout, Panel, axis_label, is_logarithmic, map_layout
from bondcell.figures.style import Drawing, new_figure
from bondcell.results.accuracy import signed_error
from bondcell.results.view import analytic_names, axis_values, reference_names
from bondcell.wording import listed, meaning, model_name, percent, symbol

BOUNDS = (-1.0, -0.3, -0.1, -0.03, -0.01, 0.01, 0.03, 0.1, 0.3, 1.0)
"""Errors between which a colour lasts; above the last there is one more colour."""

COLUMNS = 3
"""Maps beside each other when there is only one map a model."""

_CROSS: dict[str, Any] = {
    "marker": "x",
    "color": "black",
    "markersize": 5,
    "clip_on": False,
    "path_effects": [withStroke(linewidth=3, foreground="white")],
}

Grid = np.ndarray[Any, Any]


@dataclass(frozen=True)
class _Map:
    model: str
    title: str
    error: Grid


def draw_error_maps(study: xr.Dataset, name: str = "error_maps") -> Drawing | None:
    """Maps of each model's error against the first reference.

    Parameters
    ----------
    study
        A sweep's result.
    name
        File name without suffix.

    Returns
    -------
    Drawing or None
        None when the sweep has no two long axes or no reference.
    """
    layout = map_layout(study)
    if layout is None or layout.y is None or not reference_names(study):
        return None
    maps = _maps(study, layout)
    if not maps:
        return None
    columns = len(layout.panels) if len(layout.panels) > 1 else min(COLUMNS, len(maps))
    rows = -(-len(maps) // columns)
    figure = new_figure(1.0 + 2.3 * columns, 1.1 + 1.75 * rows)
    grid = figure.subplots(rows, columns, sharex=True, sharey=True, squeeze=False)
    for axes in grid.ravel()[len(maps) :]:
        axes.set_visible(False)
    colours, norm = _colours()
    for axes, shown in zip(grid.ravel(), maps, strict=False):
        _draw_map(axes, study, layout, shown, (colours, norm))
    for axes in grid[-1]:
        axes.set_xlabel(axis_label(study, layout.x))
    for axes in grid[:, 0]:
        axes.set_ylabel(axis_label(study, layout.y))
    _colour_bar(figure, grid, colours, norm)
    return Drawing(figure, name, _caption(study, layout), _description(maps))


def _maps(study: xr.Dataset, layout: Layout) -> list[_Map]:
    reference = reference_names(study)[0]
    return [
        _Map(model, _title(model, panel), _grid(study, layout, panel, model, reference))
        for model in analytic_names(study)
        for panel in layout.panels
    ]


def _title(model: str, panel: Panel) -> str:
    return f"{model_name(model)}, {panel.title}" if panel.title else model_name(model)


def _grid(study: xr.Dataset, layout: Layout, panel: Panel, model: str, reference: str) -> Grid:
    error = signed_error(study, model, reference).isel(panel.index)
    return np.asarray(error.transpose(layout.y, layout.x).values, dtype=float)


def _draw_map(
    axes: Axes,
    study: xr.Dataset,
    layout: Layout,
    shown: _Map,
    scale: tuple[Colormap, BoundaryNorm],
) -> None:
    x, y = axis_values(study, layout.x), axis_values(study, layout.y or "")
    colours, norm = scale
    axes.pcolormesh(
        _edges(x), _edges(y), shown.error, cmap=colours, norm=norm, rasterized=True, zorder=1
    )
    axes.patch.set(facecolor="#f2f2f2", hatch="////", edgecolor="#9a9a9a", linewidth=0)
    if np.isfinite(shown.error).any():
        row, column = np.unravel_index(np.nanargmax(np.abs(shown.error)), shown.error.shape)
        axes.plot(x[column], y[row], **_CROSS)
    for axis, values in ((axes.xaxis, x), (axes.yaxis, y)):
        if is_logarithmic(values):
            axis.set_tick_params(which="both", length=2)
            getattr(axes, f"set_{axis.axis_name}scale")("log")
            axis.set_minor_locator(NullLocator())
    axes.set_title(shown.title, fontsize=8)
    axes.grid(visible=False)


def _edges(values: Grid) -> Grid:
    """Cell edges midway between the values, by logarithm when they are spaced so."""
    logarithmic = is_logarithmic(values)
    points = np.log(values.astype(float)) if logarithmic else values.astype(float)
    middle = (points[1:] + points[:-1]) / 2
    first, last = 2 * points[0] - middle[0], 2 * points[-1] - middle[-1]
    edges = np.concatenate([[first], middle, [last]])
    return np.exp(edges) if logarithmic else edges


def _colours() -> tuple[Colormap, BoundaryNorm]:
    """Orange is too soft, purple too stiff, white within one per cent; the classes mirror."""
    half = (len(BOUNDS) - 1) // 2
    soft = colormaps["PuOr"](np.linspace(0.08, 0.40, half))
    stiff = colormaps["PuOr"](np.linspace(0.60, 0.92, half))
    classes = ListedColormap(np.vstack([soft, [[1, 1, 1, 1]], stiff]), name="error")
    colours = classes.with_extremes(over="#14001f", bad=(0, 0, 0, 0))
    return colours, BoundaryNorm(list(BOUNDS), colours.N)


def _colour_bar(figure: Figure, grid: Grid, colours: Colormap, norm: BoundaryNorm) -> None:
    bar = figure.colorbar(
        ScalarMappable(norm, colours),
        ax=grid,
        location="top",
        extend="max",
        ticks=BOUNDS,
        aspect=45,
        shrink=0.9,
        pad=0.01,
    )
    bar.ax.set_xticklabels([percent(bound, sign=True) for bound in BOUNDS], fontsize=7)
    bar.ax.minorticks_off()
    bar.set_label("error against finite elements: too soft < 0 < too stiff", fontsize=8)


def _caption(study: xr.Dataset, layout: Layout) -> str:
    y = layout.y or ""
    words = (
        f"Error of each model against {model_name(reference_names(study)[0])} over the "
        f"{meaning(layout.x)} {symbol(layout.x)} and the {meaning(y)} {symbol(y)}"
    )
    if layout.panel_axis:
        words += f", a column for each value of the {meaning(layout.panel_axis)}"
    return (
        f"{words}. White is within ±1 %; the cross marks the worst point of a map; hatched: no "
        f"value.{layout.note()}"
    )


def _description(maps: list[_Map]) -> str:
    sentences = []
    for shown in maps:
        title = shown.title.replace("$", "").replace(r"\nu", "ν")
        known = shown.error[np.isfinite(shown.error)]
        if not known.size:
            sentences.append(f"{title}: no value")
            continue
        good = float(np.mean(np.abs(known) <= BOUNDS[5]))
        span = listed([percent(known.min(), sign=True), percent(known.max(), sign=True)], "to")
        sentences.append(f"{title}: error {span}, {percent(good)} of the points within 1 %")
    return ". ".join(sentences) + "."
