"""Points that are no grid: error of each model, or its stiffness, over each parameter."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.ticker import FuncFormatter, NullLocator

from bondcell.figures.layout import axis_label, is_logarithmic
from bondcell.figures.style import Drawing, marker_style, mathtext, new_figure
from bondcell.results.accuracy import signed_error
from bondcell.results.view import (
    SAMPLE,
    analytic_names,
    load_name,
    model_names,
    parameters,
    reference_names,
    stiffness_unit,
)
from bondcell.wording import (
    STIFFNESS_SYMBOLS,
    listed,
    model_name,
    number,
    percent,
    quantity,
    symbol,
    unit_text,
)

MOST_POINTS = 1500
"""Points of a model that are drawn: of more every so-manieth."""

COLUMNS = 3
"""Panels beside each other."""

SMALLEST = 1e-6
"""Errors below it are drawn there."""

Values = np.ndarray[Any, Any]


def draw_scatter(study: xr.Dataset, name: str = "stiffness", x: str | None = None) -> Drawing:
    """A panel for each parameter, a mark for each point and model.

    Parameters
    ----------
    study
        Result on points that are no grid.
    name
        File name without suffix.
    x
        The only parameter to draw over; all of them when not given.
    """
    names = [x] if x else parameters(study)
    drawn = _errors(study) if _compared(study) else _stiffness(study)
    columns = min(COLUMNS, len(names))
    rows = -(-len(names) // columns)
    figure = new_figure(1.2 + 2.6 * columns if columns > 1 else 4.9, 0.9 + 2.6 * rows)
    grid = figure.subplots(rows, columns, sharey=True, squeeze=False)
    step = -(-next(iter(drawn.values())).size // MOST_POINTS)
    for axes, parameter in zip(grid.ravel(), names, strict=False):
        _panel(axes, study, parameter, drawn, step)
    for axes in grid.ravel()[len(names) :]:
        axes.set_visible(False)
    for axes in grid[:, 0]:
        axes.set_ylabel(_label(study))
    handles, labels = grid[0, 0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside upper center", ncols=max(2, columns * 2))
    return Drawing(figure, name, _caption(study, names, drawn, step), _description(study, drawn))


def _errors(study: xr.Dataset) -> dict[str, xr.DataArray]:
    """Size of each model's error."""
    reference = reference_names(study)[0]
    return {model: abs(signed_error(study, model, reference)) for model in analytic_names(study)}


def _stiffness(study: xr.Dataset) -> dict[str, xr.DataArray]:
    return {name: study["stiffness"].sel(model=name, drop=True) for name in model_names(study)}


def _compared(study: xr.Dataset) -> bool:
    return bool(reference_names(study) and analytic_names(study))


def _panel(
    axes: Axes, study: xr.Dataset, parameter: str, drawn: dict[str, xr.DataArray], step: int
) -> None:
    shape = next(iter(drawn.values()))
    place = study.coords[parameter].broadcast_like(shape).transpose(*shape.dims).values.ravel()
    along, lowest = place[::step].astype(float), SMALLEST if _compared(study) else 0.0
    finite = np.isfinite(along)
    for position, (model, values) in enumerate(drawn.items()):
        height = np.maximum(values.values.ravel()[::step], lowest)  # NaN stays NaN
        style = marker_style(model, position) | {"markersize": 2.6, "alpha": 0.55}
        style |= {"markeredgewidth": 0, "rasterized": along.size > MOST_POINTS // 3}
        axes.plot(along[finite], height[finite], label=model_name(model), **style)
    axes.set_xlabel(axis_label(study, parameter))
    if is_logarithmic(along) and not parameter.startswith("poisson"):  # it may begin near zero
        axes.set_xscale("log")
        axes.xaxis.set_minor_locator(NullLocator())
    if _compared(study):
        axes.set_yscale("log")
        axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: percent(value)))
    elif is_logarithmic(np.concatenate([values.values.ravel() for values in drawn.values()])):
        axes.set_yscale("log")


def _label(study: xr.Dataset) -> str:
    if _compared(study):
        return "error against finite elements, without sign"
    load, unit = load_name(study), unit_text(stiffness_unit(study))
    return f"{load} stiffness {mathtext(STIFFNESS_SYMBOLS.get(load, 'K_n'))} [{unit}]"


def _caption(study: xr.Dataset, names: list[str], drawn: dict[str, xr.DataArray], step: int) -> str:
    what = "Error of each model against finite elements" if _compared(study) else "Stiffness"
    points = next(iter(drawn.values())).size
    words = f"{what} over {listed(symbol(name) for name in names)}, a mark a point"
    words += f" (every {step}th of {points} points)." if step > 1 else f"; {points} points."
    others = [axis for axis in study["stiffness"].dims if axis not in ("model", SAMPLE)]
    if others:
        words += f" The samples are repeated at each {listed(symbol(str(a)) for a in others)}."
    return words


def _description(study: xr.Dataset, drawn: dict[str, xr.DataArray]) -> str:
    sentences = []
    for model, values in drawn.items():
        known = values.values[np.isfinite(values.values)]
        if not known.size:
            continue
        if _compared(study):
            middle, most = percent(float(np.median(known))), percent(float(known.max()))
            sentences.append(f"{model_name(model)}: median error {middle}, largest {most}")
        else:
            unit = stiffness_unit(study)
            span = f"{quantity(known.min(), unit)} to {quantity(known.max(), unit)}"
            sentences.append(f"{model_name(model)}: {span}, {number(known.size)} points")
    return ". ".join(sentences) + "."
