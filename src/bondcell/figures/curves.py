"""Stiffness of all models over one axis with the reference as dots, and their errors below."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, NullLocator

from bondcell.figures.layout import Layout, Panel, axis_label, is_logarithmic, line_layout
from bondcell.figures.style import PARTS, Drawing, line_style, marker_style, mathtext, new_figure
from bondcell.results.accuracy import signed_error
from bondcell.results.view import (
    analytic_names,
    axis_values,
    load_name,
    reference_names,
    stiffness_unit,
)
from bondcell.wording import (
    STIFFNESS_SYMBOLS,
    listed,
    meaning,
    model_name,
    percent,
    quantity,
    symbol,
    unit_text,
)

GOOD = 0.01
"""Half-width of the band of good agreement in the error panels."""

FEW = 6
"""Up to this many values the lines carry markers, for what lies between them is no data."""

Values = np.ndarray[Any, Any]

TICKS = (-10, -1, -0.1, -0.01, 0, 0.01, 0.1, 1, 10, 100, 1000)


def draw_curves(study: xr.Dataset, name: str = "stiffness", x: str | None = None) -> Drawing:
    """Curves of every model over one axis of a sweep.

    Parameters
    ----------
    study
        A sweep's result with at least one axis.
    name
        File name without suffix.
    x
        The axis along x; chosen when not given.
    """
    layout = line_layout(study, x)
    with_errors = bool(reference_names(study)) and bool(analytic_names(study))
    columns = len(layout.panels)
    figure = new_figure(4.9 if columns == 1 else 3.5 * columns, 6.0 if with_errors else 4.2)
    axes = figure.subplots(
        2 if with_errors else 1,
        columns,
        sharex=True,
        sharey="row",
        squeeze=False,
        height_ratios=(3, 2) if with_errors else None,
    )
    drawn = []
    for column, panel in enumerate(layout.panels):
        drawn.append(_stiffness_panel(axes[0, column], study, layout, panel))
        if with_errors:
            _error_panel(axes[1, column], study, layout, panel)
        axes[-1, column].set_xlabel(axis_label(study, layout.x))
    axes[0, 0].set_ylabel(_stiffness_label(study))
    if is_logarithmic(np.concatenate(drawn)):
        axes[0, 0].set_yscale("log")
    if with_errors:
        axes[1, 0].set_ylabel(f"error against {_short(reference_names(study)[0])}")
    _legend(figure, axes[0, 0])
    return Drawing(figure, name, _caption(study, layout, with_errors), _description(study, layout))


def _stiffness_panel(axes: Axes, study: xr.Dataset, layout: Layout, panel: Panel) -> Values:
    """Draw the models, their contributions and the dots; the values that were drawn."""
    x = axis_values(study, layout.x)
    here = study.isel(panel.index)
    drawn = []
    for part, style in PARTS.items():
        if part in study and layout.x in study[part].dims:
            axes.plot(x, here[part].values, label=mathtext(part), zorder=1.5, **style)
    for position, model in enumerate(analytic_names(study)):
        value = _line(here, model)
        drawn.append(value)
        axes.plot(x, value, label=model_name(model), **_style(model, position, x))
    for model in reference_names(study):
        value = _line(here, model)
        drawn.append(value)
        style = marker_style(model) | {"markersize": 4, "zorder": 4}
        axes.plot(x, value, label=model_name(model), **style)
    axes.set_title(panel.title)
    if is_logarithmic(x):
        axes.set_xscale("log")
        axes.xaxis.set_minor_locator(NullLocator())
    return np.concatenate([*drawn, np.empty(0)])


def _error_panel(axes: Axes, study: xr.Dataset, layout: Layout, panel: Panel) -> None:
    x = axis_values(study, layout.x)
    reference = reference_names(study)[0]
    axes.axhspan(-GOOD, GOOD, color="#e8e8e8", zorder=0, linewidth=0)
    axes.axhline(0, color="#9a9a9a", linewidth=0.8, zorder=1)
    largest = GOOD
    for position, model in enumerate(analytic_names(study)):
        error = signed_error(study, model, reference).isel(panel.index).values
        axes.plot(x, error, **_style(model, position, x))
        largest = max(largest, float(np.nanmax(np.abs(error), initial=0)))
    axes.set_yscale("symlog", linthresh=GOOD, linscale=0.6)
    axes.yaxis.set_minor_locator(NullLocator())
    axes.set_yticks([tick for tick in TICKS if -1 <= tick <= max(largest * 1.5, 0.1)])
    axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: percent(value, sign=True)))


def _legend(figure: Figure, axes: Axes) -> None:
    handles, labels = axes.get_legend_handles_labels()
    parts = len(handles) - sum(label.startswith("$") for label in labels)
    handles, labels = (items[-parts:] + items[:-parts] for items in (handles, labels))
    width = figure.get_size_inches()[0]
    figure.legend(handles, labels, loc="outside upper center", ncols=max(2, int(width / 1.55)))


def _style(model: str, position: int, x: Values) -> dict[str, Any]:
    style = line_style(model, position)
    if len(x) <= FEW:
        style |= {"marker": marker_style(model, position)["marker"], "markersize": 4.5}
    return style


def _line(here: xr.Dataset, model: str) -> Values:
    return np.asarray(here["stiffness"].sel(model=model).values, dtype=float)


def _stiffness_label(study: xr.Dataset) -> str:
    load, unit = load_name(study), unit_text(stiffness_unit(study))
    return f"{load} stiffness {mathtext(STIFFNESS_SYMBOLS.get(load, 'K_n'))} [{unit}]"


def _short(reference: str) -> str:
    return "FE" if reference == "fe" else f"FE, {reference.removeprefix('fe_')}"


def _caption(study: xr.Dataset, layout: Layout, with_errors: bool) -> str:
    words = f"Stiffness of the bond over the {meaning(layout.x)} {symbol(layout.x)}"
    if layout.panel_axis:
        words += f", a column for each value of the {meaning(layout.panel_axis)}"
    lines = [model_name(model) for model in analytic_names(study)]
    words += f". Lines: {listed(lines)}." if lines else "."
    parts = [part for part in PARTS if part in study]
    if parts:
        words += f" Thin lines: the contributions {listed(parts)} of the series model."
    references = [model_name(name) for name in reference_names(study)]
    if references:
        words += f" Dots: {listed(references)}."
    if with_errors:
        words += " Below: error of each model against the dots; the grey band is ±1 %."
    return words + layout.note()


def _description(study: xr.Dataset, layout: Layout) -> str:
    """What is seen: ends of the first curve or reference, range of each model's error."""
    shown = [*reference_names(study), *analytic_names(study)][:1]
    sentences = []
    unit = stiffness_unit(study)
    for panel in layout.panels:
        where = panel.title.replace("$", "").replace(r"\nu", "ν")
        here = study.isel(panel.index)
        for model in shown:
            value = _line(here, model)
            ends = f"from {quantity(value[0], unit)} to {quantity(value[-1], unit)}"
            sentences.append(f"{where + ': ' if where else ''}{model_name(model)} {ends}")
        for reference in reference_names(study)[:1]:
            for model in analytic_names(study):
                error = signed_error(study, model, reference).isel(panel.index).values
                if np.isfinite(error).any():
                    low, high = np.nanmin(error), np.nanmax(error)
                    span = f"{percent(low, sign=True)} to {percent(high, sign=True)}"
                    sentences.append(f"Error of {model_name(model)} {span}")
    return ". ".join(sentences) + "."
