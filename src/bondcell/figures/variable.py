"""Any variable of a result over one of its axes, a line for each combination of the others."""

from __future__ import annotations

from itertools import product
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.ticker import NullLocator
from numpy.typing import NDArray

from bondcell.errors import InputError, Violation
from bondcell.figures.layout import axis_label, is_logarithmic
from bondcell.figures.style import Drawing, line_style, marker_style, new_figure
from bondcell.results.view import axis_unit, axis_values
from bondcell.wording import at, meaning, model_name, unit_text

FEW = 12
"""Up to this many values the lines carry markers, for what lies between them is no data."""

MOST_LINES = 12
"""Lines that can still be told apart."""


def draw_variable(data: xr.Dataset, x: str, y: str) -> Drawing:
    """Draw one variable over one axis.

    Parameters
    ----------
    data
        Results.
    x
        A dimension of the variable, or a coordinate on one.
    y
        The variable.

    Raises
    ------
    InputError
        No such variable or axis, nothing numeric, or more than `MOST_LINES` lines.
    """
    values, along = _checked(data, x, y)
    figure = new_figure(6.4, 4.4)
    axes = figure.subplots()
    places = axis_values(data, along) if x == along else np.asarray(data[x].values)
    drawn = []
    others = [str(dim) for dim in values.dims if dim != along]
    for number, index in enumerate(product(*(range(values.sizes[dim]) for dim in others))):
        here = dict(zip(others, index, strict=True))
        line = np.asarray(values.isel(here).values, dtype=float)
        drawn.append(line)
        style = _style(data, here, number)
        if line.size > FEW:
            style.pop("marker")
        axes.plot(places, line, label=_label(data, here), **style)
    axes.set_xlabel(axis_label(data, x) if x in data.coords else _title(data[x]))
    axes.set_ylabel(_title(values))
    _scale_x(axes, places)
    if is_logarithmic(np.concatenate(drawn)):
        axes.set_yscale("log")
    if others:
        axes.legend(loc="best")
    caption = f"{_words(values)} over the {meaning(x)}."
    return Drawing(figure, f"{y}_over_{x}", caption, f"{len(drawn)} lines.")


def _checked(data: xr.Dataset, x: str, y: str) -> tuple[xr.DataArray, str]:
    known = [str(name) for name in data.data_vars if data[name].dtype.kind in "iuf"]
    if y not in known:
        raise InputError([Violation("--plot Y", y, f"a numeric variable: {', '.join(known)}")])
    values = data[y]
    on = [str(name) for name in data.variables if data[name].dims[:1] == data[name].dims]
    axes = [name for name in on if data[name].ndim == 1 and data[name].dims[0] in values.dims]
    axes += [str(dim) for dim in values.dims if dim not in axes]
    if x not in axes:
        allowed = f"an axis of {y}: {', '.join(axes) or 'it has none'}"
        raise InputError([Violation("--plot X", x, allowed)])
    along = str(data[x].dims[0]) if x in data.variables else x
    lines = values.size // max(values.sizes[along], 1)
    if lines > MOST_LINES:
        others = ", ".join(f"{d} ({n})" for d, n in values.sizes.items() if d != along)
        allowed = f"at most {MOST_LINES} lines: choose positions of {others} with --at AXIS=VALUE"
        raise InputError([Violation("--plot", f"{lines} lines", allowed)])
    return values, along


def _label(data: xr.Dataset, here: dict[str, int]) -> str:
    words = []
    for axis, position in here.items():
        value = axis_values(data, axis)[position]
        text = isinstance(value, str)
        if axis == "model":
            words.append(model_name(str(value)))
        else:
            words.append(str(value) if text else at(axis, value, axis_unit(data, axis)))
    return ", ".join(words)


def _style(data: xr.Dataset, here: dict[str, int], number: int) -> dict[str, Any]:
    """A model's own colour where models are all that differs, else colours in turn."""
    model = str(axis_values(data, "model")[here["model"]]) if "model" in here else ""
    if model and set(here) == {"model"}:
        return line_style(model, number) | {"marker": marker_style(model, number)["marker"]}
    line = ("-", "--", "-.", ":")[number // 10]
    return {"marker": "osv^DPX*"[number % 8], "color": f"C{number % 10}", "linestyle": line}


def _scale_x(axes: Axes, places: NDArray[Any]) -> None:
    """Logarithmic where the values span decades, also if they begin at zero."""
    if places.dtype.kind not in "iuf":
        return
    above = places[(places > 0) & np.isfinite(places)]
    if is_logarithmic(places):
        axes.set_xscale("log")
    elif places.min() == 0 and is_logarithmic(above):
        axes.set_xscale("symlog", linthresh=float(above.min()), linscale=0.5)
        axes.xaxis.set_minor_locator(NullLocator())


def _words(values: xr.DataArray) -> str:
    words = str(values.attrs.get("long_name", values.name))
    return words[:1].upper() + words[1:]


def _title(values: xr.DataArray) -> str:
    unit = unit_text(str(values.attrs.get("units", "1")))
    words = str(values.attrs.get("long_name", values.name))
    return f"{words} [{unit}]" if unit else words
