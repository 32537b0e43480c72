"""Curves of several models over any axis of a grid, the other axes set by sliders and menus."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import altair as alt

from bondcell.report.interactive.controls import ENCODING, Control, Option, logarithmic
from bondcell.report.interactive.figure import ONE, ROWS, SHOWN, Axis, Chart, Switch
from bondcell.report.interactive.look import (
    MARKER,
    POWERS,
    colours,
    dashes,
    decades,
    look_of,
    shapes,
)

ALONG = "along"
"""Parameter: the axis along x."""

HEIGHT = 340


@dataclass(frozen=True)
class Way:
    """An axis that can lie along x.

    Parameters
    ----------
    axis
        Its name.
    title
        Label with symbol and unit, plain text.
    bounds
        Least and largest value.
    logarithmic
        Whether its values are spaced by logarithm; one with zero or negative values cannot be.
    can_be_logarithmic
        Whether all its values are positive.
    end
        Position of a value that stands for infinity, and what it is called.
    """

    axis: str
    title: str
    bounds: tuple[float, float]
    logarithmic: bool
    can_be_logarithmic: bool
    end: tuple[float, str] | None = None


@dataclass(frozen=True)
class Quantity:
    """What can be drawn upwards.

    Parameters
    ----------
    field
        Column of the data.
    label, title
        In the menu, and at the axis.
    domain
        Range of the axis.
    ticks
        Vega expression of the label of a tick.
    mark
        A value to compare with, drawn as a line.
    """

    field: str
    label: str
    title: str
    domain: tuple[float, float]
    ticks: str
    mark: float | None = None


def explorer_chart(
    names: Sequence[str],
    axes: Sequence[Axis],
    ways: Sequence[Way],
    tooltip: Sequence[alt.Tooltip],
    derived: Mapping[str, str],
    *,
    with_lines: bool = True,
) -> Chart:
    """The specification: what is drawn follows the parameters, see `explorer_controls`.

    Parameters
    ----------
    names
        Models in order.
    axes
        Axes that a control sets.
    ways
        Those of them that may lie along x instead.
    tooltip
        What is said of a point.
    derived
        Field -> Vega expression that gives it from a row.
    with_lines
        Whether neighbours along x belong together.
    """
    along = {way.axis for way in ways}
    conditions = [f"indexof({SHOWN}, datum.name) >= 0"]
    for axis in axes:
        free = f"{ALONG} == '{axis.name}' || " if axis.name in along else ""
        conditions.append(f"({free}datum.{axis.name}_at == at_{axis.name})")
    base = alt.Chart(alt.NamedData(ROWS)).transform_filter(" && ".join(conditions))
    base = base.transform_calculate(**derived)
    still = alt.Chart(alt.NamedData(ONE)).mark_rule().encode(y=alt.YDatum(1))
    points = base.mark_point(size=MARKER, strokeWidth=1.6).encode(
        shape=shapes(names),
        stroke=alt.Stroke(**colours(names)),
        fill=alt.condition("isValid(datum.flag)", alt.value("#fff"), alt.Fill(**colours(names))),
        tooltip=list(tooltip),
    )
    layers = [points]
    if with_lines:
        unlined = [name for name in names if look_of(name)["linestyle"] == "none"]
        line = base.transform_filter(f"indexof({unlined}, datum.name) < 0").mark_line(strokeWidth=2)
        colour = alt.Color(**colours(names))
        layers.insert(0, line.encode(color=colour, strokeDash=dashes(names)))
    parameters = [
        alt.param(name=SHOWN, value=list(names)),
        alt.param(name=ALONG, value=ways[0].axis if ways else ""),
        *(alt.param(name=f"at_{axis.name}", value=0) for axis in axes),
    ]
    data = alt.layer(*layers).encode(x=alt.X("x:Q"), y=alt.Y("y:Q"))
    return alt.layer(still, data).add_params(*parameters).properties(height=HEIGHT)


def explorer_controls(
    axes: Sequence[tuple[Axis, str, int]],
    ways: Sequence[Way],
    quantities: Sequence[Quantity],
    menus: Sequence[Control] = (),
) -> list[Control]:
    """Menus of what lies along x and y, a slider for each axis, boxes for logarithms.

    Parameters
    ----------
    axes
        Each axis that a slider sets, with its label and its first position.
    ways, quantities
        Choices along x and y, the first ones first.
    menus
        Other controls, which come first.
    """
    controls = [*menus]
    upward = tuple(Option(q.label, patches=_upward(q)) for q in quantities)
    controls.append(Control("menu", "upward", "Show", upward))
    across = tuple(_across(way) for way in ways)
    controls.append(Control("menu", "across", "Along x", across))
    for axis, label, start in axes:
        options = tuple(
            Option(text, signals={f"at_{axis.name}": place})
            for place, text in enumerate(axis.texts)
        )
        controls.append(Control("slider", axis.name, label, options, start))
    controls.append(logarithmic("x", "log x", start=ways[0].logarithmic))
    controls.append(logarithmic("y", "log y"))
    return controls


def chosen(kind: str, axis: Axis, label: str, start: int = 0) -> Control:
    """A slider or a menu that sets the position on an axis."""
    signal = f"at_{axis.name}"
    options = tuple(Option(text, {signal: place}) for place, text in enumerate(axis.texts))
    return Control(kind, axis.name, label, options, start)


def _upward(quantity: Quantity) -> dict[str, Any]:
    scale = {"type": "log", "domain": list(quantity.domain), "clamp": True}
    values = decades(*quantity.domain)
    axis: dict[str, Any] = {"title": quantity.title, "labelExpr": quantity.ticks}
    axis |= {"values": values} if values else {"tickCount": 7}
    encoding = {"field": quantity.field, "type": "quantitative", "scale": scale, "axis": axis}
    line = {"type": "rule", "color": "#666", "strokeDash": [2, 3]}
    return {
        f"{ENCODING}/y": encoding,
        "/layer/0/encoding/y": {"datum": quantity.mark if quantity.mark is not None else 1},
        "/layer/0/mark": line if quantity.mark is not None else {"type": "rule", "opacity": 0},
    }


def _across(way: Way) -> Option:
    axis: dict[str, Any] = {"title": way.title, "labelExpr": POWERS}
    values = decades(*way.bounds) if way.logarithmic else None
    axis |= {"values": values} if values else {"tickCount": 7}
    if way.end:
        place, word = way.end
        axis["labelExpr"] = f"datum.value > {0.9 * place} ? '{word}' : ({POWERS})"
    scale: dict[str, Any] = {"type": "linear"}
    if way.logarithmic:
        scale = {"type": "log"}
    scale |= {"domain": list(way.bounds), "nice": False}
    encoding = {"field": way.axis, "type": "quantitative", "scale": scale, "axis": axis}
    disables = (way.axis,) if way.can_be_logarithmic else (way.axis, "log_x")
    return Option(
        way.title, signals={ALONG: way.axis}, patches={f"{ENCODING}/x": encoding}, disables=disables
    )


def switches(names: Sequence[str], labels: Sequence[str], off: Sequence[str] = ()) -> list[Switch]:
    """One for each name."""
    return [Switch(name, label, name not in off) for name, label in zip(names, labels, strict=True)]
