"""How a model looks in interactive figures: the colours, dashes and markers of the static ones."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from typing import Any

import altair as alt
from markupsafe import Markup

from bondcell.figures import convergence, relaxation_checks, specimen_style
from bondcell.figures.style import BLACK, GREY, LINES, REFERENCES

LOOKS: dict[str, dict[str, Any]] = {
    **LINES,
    **{name: {"linestyle": "none", **look} for name, look in REFERENCES.items()},
    **convergence.LADDERS,
    **relaxation_checks.STYLES,
    **{name: {"linestyle": "none", **look} for name, look in specimen_style.METHODS.items()},
}
"""Colour, line and marker of all that a figure may show."""

UNKNOWN = {"color": BLACK, "linestyle": "--", "marker": "s"}
"""Of a model that has no style yet."""

SHAPES = {
    "o": "circle",
    "s": "square",
    "^": "triangle-up",
    "v": "triangle-down",
    "D": "diamond",
    "d": "M0,-1L0.6,0L0,1L-0.6,0Z",
    "P": "cross",
    "X": "M-1,-0.5L-0.5,-1L0,-0.5L0.5,-1L1,-0.5L0.5,0L1,0.5L0.5,1L0,0.5L-0.5,1L-1,0.5L-0.5,0Z",
    "x": "M-1,-0.7L-0.7,-1L0,-0.3L0.7,-1L1,-0.7L0.3,0L1,0.7L0.7,1L0,0.3L-0.7,1L-1,0.7L-0.3,0Z",
    "*": "M0,-1L0.26,-0.36L0.95,-0.31L0.42,0.14L0.59,0.81L0,0.44L-0.59,0.81L-0.42,0.14"
    "L-0.95,-0.31L-0.26,-0.36Z",
}
"""Marker of matplotlib -> shape of Vega."""

DASHES: dict[str, list[float]] = {
    "-": [1, 0],
    "--": [6, 3],
    "-.": [8, 3, 2, 3],
    ":": [1.5, 2.5],
    "none": [1, 0],
}
"""Line style of matplotlib -> dashes [px]."""

CONFIG: dict[str, Any] = {
    "font": "system-ui, sans-serif",
    "background": "transparent",
    "view": {"stroke": None},
    "aria": False,
    "axis": {
        "labelFontSize": 12,
        "titleFontSize": 13,
        "titleFontWeight": "normal",
        "gridColor": "#e3e3e3",
        "domainColor": GREY,
        "tickColor": GREY,
        "labelColor": "#333",
        "titleColor": "#1d2329",
        "labelOverlap": "greedy",
        "labelSeparation": 4,
    },
}
"""What all interactive figures share; the page itself names them to screen readers."""

_UP = "⁰¹²³⁴⁵⁶⁷⁸⁹"
_EXPONENTS = ["".join(_UP[int(c)] if c != "-" else "⁻" for c in str(k)) for k in range(-30, 31)]

POWERS = (
    "datum.value > 0 && (datum.value < 0.009 || datum.value > 9999) "
    "&& abs(log(datum.value) / LN10 - round(log(datum.value) / LN10)) < 1e-6 "
    f"? '10' + {_EXPONENTS}[round(log(datum.value) / LN10) + 30] : format(datum.value, '~g')"
)
"""Label of a tick: powers of ten as such."""

PERCENT = "format(100 * datum.value, '~g') + ' %'"
"""Label of a tick: a fraction in per cent."""

_LOWERED = str.maketrans("ijmnst", "ᵢⱼₘₙₛₜ")


def plain(text: str) -> str:
    """A text with subscripts as far as plain characters go, for axes and menus.

    Examples
    --------
    >>> plain("modulus ratio E_i/E_m"), plain("L_g/R_i")
    ('modulus ratio Eᵢ/Eₘ', 'Lg/Rᵢ')
    """
    lowered = re.sub(r"_([ijmnst])\b", lambda match: match[1].translate(_LOWERED), text)
    return re.sub(r"_([a-zA-Z]+)\b", r"\1", lowered)


def unit_label(unit: str) -> str:
    """Label of a tick: a number with prefix and unit, as 10 ms."""
    return f"format(datum.value, '~s') + '{unit}'"


def decades(low: float, high: float, most: int = 9) -> list[float] | None:
    """Powers of ten between two bounds, at most so many; None where there are too few.

    Examples
    --------
    >>> decades(2e-7, 0.3), decades(1, 20)
    ([1e-06, 1e-05, 0.0001, 0.001, 0.01, 0.1], None)
    """
    first, last = math.ceil(math.log10(low) - 1e-9), math.floor(math.log10(high) + 1e-9)
    if last - first < 2:
        return None
    step = -(-(last - first + 1) // most)
    return [float(f"1e{power}") for power in range(first, last + 1, step)]


MARKER = 80.0
"""Size of a marker [px^2]."""


def look_of(name: str) -> dict[str, Any]:
    """Colour, line and marker of a model, a discretisation or a method."""
    return LOOKS.get(name, UNKNOWN)


def dash_of(name: str) -> list[float]:
    """Dashes [px] of a model's line."""
    style = look_of(name)["linestyle"]
    return DASHES[style] if isinstance(style, str) else [1.7 * float(part) for part in style[1]]


def shape_of(name: str) -> str:
    """Vega's name or the path of a model's marker."""
    return SHAPES[look_of(name)["marker"]]


def colours(names: Sequence[str], field: str = "name") -> dict[str, Any]:
    """Arguments of a channel of colours by name, without a legend: the switches are one."""
    range_ = [look_of(name)["color"] for name in names]
    scale = alt.Scale(domain=list(names), range=range_)
    return {"shorthand": f"{field}:N", "scale": scale, "legend": None}


def shapes(names: Sequence[str], field: str = "name") -> alt.Shape:
    """Marker by name."""
    range_ = [shape_of(name) for name in names]
    return alt.Shape(f"{field}:N", scale=alt.Scale(domain=list(names), range=range_), legend=None)


def dashes(names: Sequence[str], field: str = "name") -> alt.StrokeDash:
    """Dashes by name."""
    scale = alt.Scale(domain=list(names), range=[dash_of(name) for name in names])
    return alt.StrokeDash(f"{field}:N", scale=scale, legend=None)


_PICTURES = {
    "o": '<circle cx="17" cy="7" r="3.6"/>',
    "s": '<rect x="13.6" y="3.6" width="6.8" height="6.8"/>',
    "D": '<path d="M17 2.6 21 7 17 11.4 13 7Z"/>',
    "d": '<path d="M17 2 19.8 7 17 12 14.2 7Z"/>',
    "^": '<path d="M17 2.6 21.2 10.2H12.8Z"/>',
    "v": '<path d="M17 11.4 21.2 3.8H12.8Z"/>',
    "P": '<path d="M15.6 2.6h2.8v3h3v2.8h-3v3h-2.8v-3h-3V5.6h3Z"/>',
}
"""Markers of a swatch, 34 by 14."""


def swatch(name: str) -> Markup:
    """A small picture of a model's line and marker."""
    look = look_of(name)
    path = _PICTURES.get(look["marker"])
    if path is None:
        outline = SHAPES[look["marker"]]
        path = f'<path transform="translate(17 7) scale(4.6)" d="{outline}"/>'
    line = ""
    if look["linestyle"] != "none":
        pattern = " ".join(f"{part:g}" for part in dash_of(name))
        line = (
            f'<path d="M0 7H34" fill="none" stroke="{look["color"]}" stroke-width="2" '
            f'stroke-dasharray="{pattern}"/>'
        )
    return Markup(
        f'<svg width="34" height="14" viewBox="0 0 34 14" aria-hidden="true">{line}'
        f'<g fill="{look["color"]}">{path}</g></svg>'
    )
