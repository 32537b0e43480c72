"""Relaxation curves, complex stiffness, and the error of each model as the matrix relaxes."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, NullLocator

from bondcell.figures.layout import is_logarithmic
from bondcell.figures.style import (
    GREY,
    Drawing,
    line_style,
    marker_style,
    mathtext,
    new_figure,
)
from bondcell.results.relaxation_tables import (
    FADED,
    error_over_time,
    relaxation_axes,
    shortcut_error,
)
from bondcell.results.relaxation_view import (
    convention_words,
    middle_point,
    point_words,
    series_words,
    shown_series,
)
from bondcell.results.view import (
    REFERENCE,
    analytic_names,
    axis_unit,
    axis_values,
    load_name,
    reference_names,
    stiffness_unit,
)
from bondcell.wording import (
    STIFFNESS_SYMBOLS,
    at,
    model_name,
    number,
    percent,
    quantity,
    unit_text,
)

SHORTCUT = {"color": GREY, "linestyle": ":", "linewidth": 1.8}
"""Line of the shortcut K(0) g(t)."""

MARKS = 17
"""Most dots of the reference on a curve."""

Values = np.ndarray[Any, Any]


def relaxation_drawings(study: xr.Dataset, suffix: str = "") -> Iterator[Drawing]:
    """Everything that a result with a time dimension has to show.

    Parameters
    ----------
    study
        A result with relaxation.
    suffix
        End of the figures' names.
    """
    yield draw_relaxation(study, f"relaxation{suffix}")
    yield draw_dynamic(study, f"complex_stiffness{suffix}")
    if REFERENCE in study["model"].values and analytic_names(study):
        yield draw_errors(study, f"error_over_time{suffix}")


def draw_relaxation(study: xr.Dataset, name: str = "relaxation") -> Drawing:
    """K(t) by each model, a panel for each series, under the first convention.

    Parameters
    ----------
    study
        A result with relaxation.
    name
        File name without suffix.
    """
    here, where, convention = _shown(study)
    names = shown_series(study)
    figure, grid = _panels(len(names), 3.9)
    time = here["time"].values[1:]
    sentences = []
    for axes, series in zip(grid, names, strict=True):
        curves = here["relaxation"].sel(series=series).isel(time=slice(1, None))
        for position, model in enumerate(analytic_names(study)):
            style = line_style(model, position)
            axes.plot(time, curves.sel(model=model).values, label=model_name(model), **style)
        for model in reference_names(study):
            _dots(axes, time, curves.sel(model=model).values, model)
        if REFERENCE in study["model"].values:
            start = here["relaxation"].sel(series=series, model=REFERENCE).isel(time=0)
            guess = float(start) * here["shear_share"].sel(series=series).values[1:]
            axes.plot(time, guess, label="shortcut $K(0)\\,g(t)$", **SHORTCUT)
        _decades(axes, "time since the step", "s")
        axes.set_yscale("log")
        axes.set_ylim(bottom=_floor(curves.values))
        axes.set_title(series_words(series))
        shown = [*reference_names(study), *analytic_names(study)][0]
        ends = here["relaxation"].sel(series=series, model=shown).values[[0, -1]]
        unit = stiffness_unit(study)
        span = f"from {quantity(ends[0], unit)} to {quantity(ends[1], unit)}"
        sentences.append(f"{series_words(series)}: {model_name(shown)} {span}")
    grid[0].set_ylabel(_label(study, "(t)"))
    _legend(figure, grid[0])
    caption = f"Stiffness of the bond after a step, {convention}{where}. Dots: finite elements."
    return Drawing(figure, name, caption, ". ".join(sentences) + ".")


def draw_dynamic(study: xr.Dataset, name: str = "complex_stiffness") -> Drawing:
    """Storage and loss stiffness over frequency, the loss factor below.

    Parameters
    ----------
    study, name
        As in `draw_relaxation`.
    """
    here, where, convention = _shown(study)
    names = shown_series(study)
    figure, grid = _panels(len(names), 5.6, rows=2)
    frequency = here["frequency"].values
    models = [*reference_names(study)[:1], *analytic_names(study)]
    sentences = []
    for column, series in enumerate(names):
        upper, lower = grid[0][column], grid[1][column]
        for position, model in enumerate(models):
            storage, loss = (
                here[part].sel(series=series, model=model).values for part in ("storage", "loss")
            )
            ratio = np.divide(loss, storage, out=np.full(loss.shape, np.nan), where=storage > 0)
            if model == REFERENCE:
                _dots(upper, frequency, storage, model)
                _dots(upper, frequency, loss, model, hollow=True)
                _dots(lower, frequency, ratio, model)
                top = int(np.nanargmax(ratio))
                words = f"largest loss factor {number(ratio[top], 3)}"
                speed = f"{number(frequency[top], 2)} rad/s"
                sentences.append(f"{series_words(series)}: {words} at {speed}")
            else:
                style = line_style(model, position)
                upper.plot(frequency, storage, label=model_name(model), **style)
                upper.plot(frequency, loss, alpha=0.45, **style)
                lower.plot(frequency, ratio, **style)
        upper.set_yscale("log")
        upper.set_title(series_words(series))
        _decades(upper, "", "")
        _decades(lower, "angular frequency", "rad/s")
        if is_logarithmic(np.concatenate([line.get_ydata() for line in lower.lines])):
            lower.set_yscale("log")
    grid[0][0].set_ylabel(_label(study, "'", "''"))
    grid[1][0].set_ylabel("loss factor")
    _legend(figure, grid[0][0])
    caption = (
        f"Storage (full lines and dots) and loss stiffness (pale lines, rings), {convention}"
        f"{where}; below the loss factor."
    )
    return Drawing(figure, name, caption, (". ".join(sentences) or "No finite elements") + ".")


def draw_errors(study: xr.Dataset, name: str = "error_over_time") -> Drawing:
    """Error of each model against finite elements over time; Poisson's ratio below.

    Parameters
    ----------
    study, name
        As in `draw_relaxation`.
    """
    first = study.isel(convention=0, drop=True)
    series = shown_series(study)[0]
    here = first.sel(series=series)
    axis, panels = _error_panels(study)
    figure, grid = _panels(len(panels), 5.6, rows=2)
    time = here["time"].values[1:]
    sentences, top = [], [0.0]
    for column, (index, title) in enumerate(panels):
        upper, lower = grid[0][column], grid[1][column]
        upper.axhline(0, color="#9a9a9a", linewidth=0.8, zorder=1)
        for position, model in enumerate(analytic_names(study)):
            error = error_over_time(first, model).sel(series=series).isel(index).values
            upper.plot(time, error[1:], label=model_name(model), **line_style(model, position))
            top.append(float(np.nanmax(error, initial=0)))
            span = f"{percent(error[0], sign=True)} to {percent(error[-1], sign=True)}"
            sentences.append(f"{title or 'the cell'}, {model_name(model)}: {span}")
        wrong = shortcut_error(first).sel(series=series).isel(index).values
        upper.plot(time, wrong[1:], label="shortcut $K(0)\\,g(t)$", **SHORTCUT)
        lower.plot(time, here["poisson_t"].isel(index).values[1:], color="#1a1a1a")
        upper.set_title(_math(title))
        upper.set_yscale("symlog", linthresh=0.01, linscale=0.6)
        upper.set_yticks([-1, -0.1, -0.01, 0, 0.01, 0.1, 1])
        upper.set_ylim(-1.2, max(0.02, 1.3 * float(np.nanmax(top, initial=0))))
        upper.yaxis.set_minor_locator(NullLocator())
        upper.yaxis.set_major_formatter(FuncFormatter(lambda v, _: percent(v, sign=True)))
        _decades(upper, "", "")
        _decades(lower, "time since the step", "s")
    grid[0][0].set_ylabel("error against FE")
    grid[1][0].set_ylabel(f"Poisson's ratio {mathtext('ν_m')}(t)")
    _legend(figure, grid[0][0])
    by = f", a column for each {axis}" if axis else ""
    caption = (
        f"Error of each model as the matrix relaxes ({series_words(series)}, "
        f"{convention_words(str(study['convention'].values[0]))}){by}; below the Poisson's ratio "
        "that the matrix has by then."
    )
    return Drawing(figure, name, caption, ". ".join(sentences) + ".")


def _shown(study: xr.Dataset) -> tuple[xr.Dataset, str, str]:
    index = middle_point(study)
    where = point_words(study, index)
    convention = str(study["convention"].values[0])
    here = study.isel(index).sel(convention=convention)
    return here, f", {where}" if where else "", convention_words(convention)


def _error_panels(study: xr.Dataset) -> tuple[str, list[tuple[dict[str, int], str]]]:
    """Points shown beside each other: along the first axis of several values."""
    middle = middle_point(study)
    axes = [axis for axis in relaxation_axes(study) if study.sizes[axis] > 1]
    if not axes:
        return "", [(middle, "")]
    axis = axes[0]
    size = study.sizes[axis]
    positions = np.unique(np.linspace(0, size - 1, min(size, 3)).round().astype(int))
    values = axis_values(study, axis)
    return axis.replace("_", " "), [
        ({**middle, axis: int(i)}, at(axis, values[i], axis_unit(study, axis))) for i in positions
    ]


def _panels(columns: int, height: float, rows: int = 1) -> tuple[Figure, Any]:
    figure = new_figure(5.4 if columns == 1 else 3.5 * columns, height)
    grid = figure.subplots(rows, columns, sharex=True, sharey="row", squeeze=False)
    return figure, grid[0] if rows == 1 else grid


def _floor(values: Values) -> float:
    """Where a logarithmic axis ends: bonds that are gone would stretch it without end."""
    known = values[np.isfinite(values) & (values > 0)]
    return max(0.5 * float(known.min()), FADED * float(known.max())) if known.size else 1e-9


def _dots(axes: Axes, x: Values, y: Values, model: str, *, hollow: bool = False) -> None:
    every = max(1, x.size // MARKS)
    style = marker_style(model) | {"zorder": 4}
    if hollow:
        style |= {"markerfacecolor": "none"}
    axes.plot(x[::every], y[::every], label=None if hollow else model_name(model), **style)


def _decades(axes: Axes, words: str, unit: str) -> None:
    axes.set_xscale("log")
    axes.xaxis.set_major_locator(LogLocator(numticks=7))
    axes.xaxis.set_minor_locator(NullLocator())
    if words:
        axes.set_xlabel(f"{words} [{unit}]")


def _label(study: xr.Dataset, *marks: str) -> str:
    sign = mathtext(STIFFNESS_SYMBOLS.get(load_name(study), "K_n"))
    signs = ", ".join(f"{sign}{mark}" for mark in marks)
    return f"{load_name(study)} stiffness {signs} [{unit_text(stiffness_unit(study))}]"


def _math(title: str) -> str:
    sign, equals, value = title.partition(" = ")
    return f"{mathtext(sign)}{equals}{value}"


def _legend(figure: Figure, axes: Axes) -> None:
    handles, labels = axes.get_legend_handles_labels()
    width = figure.get_size_inches()[0]
    figure.legend(handles, labels, loc="outside upper center", ncols=max(2, int(width / 1.55)))
