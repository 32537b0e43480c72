"""An interactive figure as the page embeds it: one block of JSON, with data written compactly."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import altair as alt
import numpy as np
from markupsafe import Markup

from bondcell.report.interactive.controls import Control
from bondcell.report.interactive.look import CONFIG, swatch
from bondcell.wording import number

Chart = alt.LayerChart | alt.FacetChart

SHOWN = "shown"
"""Parameter of every specification: the names that are switched on."""

ROWS, ONE = "rows", "one"
"""Data of every specification: the figure's rows, and a single empty row for what stands still."""


@dataclass(frozen=True)
class Axis:
    """A dimension of a figure's data.

    Parameters
    ----------
    name
        Field of the rows; ``<name>_text`` and ``<name>_at`` are the text and the position.
    texts
        Each value as it is printed.
    values
        The numbers or short names, None where the texts are all there is.
    companions
        What else is known at each position: axes of the same length.
    """

    name: str
    texts: Sequence[str]
    values: Sequence[float | str] | None = None
    companions: tuple[Axis, ...] = ()

    def for_script(self) -> dict[str, Any]:
        """As the page's script reads it."""
        given: dict[str, Any] = {"name": self.name, "texts": list(self.texts)}
        if self.values is not None:
            given["values"] = list(self.values)
        if self.companions:
            given["companions"] = [axis.for_script() for axis in self.companions]
        return given


@dataclass(frozen=True)
class Switch:
    """Something that can be hidden: a model, a discretisation."""

    name: str
    label: str
    on: bool = True

    @property
    def swatch(self) -> Markup:
        """Its line and marker as a small picture."""
        return swatch(self.name)


@dataclass(frozen=True)
class InteractiveFigure:
    """A figure with controls.

    Parameters
    ----------
    name
        Unique on the page.
    caption, description
        What is drawn, and what is seen in it for those who cannot see it.
    chart
        The specification, without data.
    axes, columns
        The data: every combination of the axes' values is a row, and the columns are these rows'
        values in the same order; see `numbers` and `texts`.
    controls, switches
        What the reader can set.
    replaces
        Names of static figures that show the same.
    """

    name: str
    caption: str
    description: str
    chart: Chart
    axes: Sequence[Axis]
    columns: dict[str, Any]
    controls: Sequence[Control]
    switches: Sequence[Switch]
    replaces: tuple[str, ...] = ()

    @property
    def choices(self) -> list[Control]:
        """Controls that leave a choice."""
        return [control for control in self.controls if len(control.options) > 1]

    @property
    def payload(self) -> Markup:
        """JSON that is safe inside a script element."""
        spec = self.chart.properties(width="container").to_dict()
        spec["config"] = CONFIG
        for control in self.controls:
            if len(control.options) == 1:
                for pointer, value in control.options[0].patches.items():
                    _put(spec, pointer, value)
        content = {
            "spec": spec,
            "axes": [axis.for_script() for axis in self.axes],
            "columns": self.columns,
            "controls": {control.name: control.for_script() for control in self.choices},
        }
        text = json.dumps(content, ensure_ascii=False, separators=(",", ":"), allow_nan=False)
        return Markup(text.replace("<", "\\u003c"))


def _put(spec: dict[str, Any], pointer: str, value: Any) -> None:
    """Set the place in a specification that a JSON pointer names."""
    place: Any = spec
    *way, last = pointer.split("/")[1:]
    for key in way:
        place = place[int(key) if isinstance(place, list) else key]
    if value is None:
        place.pop(last, None)
    else:
        place[last] = value


def numbers(values: Any, digits: int) -> str:
    """A column of numbers, commas between them; nothing where there is no value.

    Parameters
    ----------
    values
        Any shape, row after row.
    digits
        Significant digits that are kept.

    Examples
    --------
    >>> numbers([0.123456, float("nan"), 84065.1275, -1e-12, 2.0], 4)
    '0.1235,,84070,-1e-12,2'
    """
    flat = np.ravel(np.asarray(values, dtype=float))
    return ",".join(_short(value, digits) if np.isfinite(value) else "" for value in flat)


def _short(value: float, digits: int) -> str:
    text = repr(float(f"{value:.{digits}g}"))
    return text.removesuffix(".0").replace("e-0", "e-").replace("e+", "e")


def texts(values: Sequence[str]) -> dict[str, Any]:
    """A column of texts, each different one kept once; empty ones are left out.

    Examples
    --------
    >>> texts(["", "a", "b", "a"])
    {'of': ['a', 'b'], 'at': ',0,1,0'}
    """
    known = [text for text in dict.fromkeys(values) if text]
    position = {text: str(place) for place, text in enumerate(known)}
    return {"of": known, "at": ",".join(position.get(text, "") for text in values)}


def plotted(values: Sequence[float]) -> list[float]:
    """Positions of values on an axis: an infinite one stands a decade beyond the largest other.

    Examples
    --------
    >>> plotted([1.0, 1e6, float("inf")])
    [1.0, 1000000.0, 10000000.0]
    """
    finite = [value for value in values if np.isfinite(value)]
    beyond = 10 * max(finite, default=1.0)
    return [float(number(value if np.isfinite(value) else beyond, 6)) for value in values]
