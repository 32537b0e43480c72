"""Which axis of a sweep goes where: along x, into panels, or held fixed."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from bondcell.figures.style import mathtext
from bondcell.results.accuracy import SMALL_AXIS
from bondcell.results.view import axis_unit, axis_values, swept_axes
from bondcell.wording import at, meaning, quantity, symbol, unit_text

PANELS = 3
"""Most panels beside each other."""

FAVOURITES = ("modulus_ratio", "gap_ratio", "gap")
"""Axes that are drawn along x if they are there."""


@dataclass(frozen=True)
class Panel:
    """One panel: where it stands in the sweep and what its title says."""

    index: dict[str, int]
    title: str


@dataclass(frozen=True)
class Layout:
    """What is along x, what in the panels; other axes are held at a value."""

    x: str
    y: str | None
    panels: tuple[Panel, ...]
    panel_axis: str | None
    fixed: str

    def note(self) -> str:
        """What is held fixed, as the end of a caption."""
        return f" Held fixed: {self.fixed}." if self.fixed else ""


def line_layout(study: xr.Dataset, x: str | None = None) -> Layout:
    """Layout of curves over one axis.

    Parameters
    ----------
    study
        A sweep's result with at least one axis.
    x
        The axis along x; chosen when not given.
    """
    axes = swept_axes(study)
    chosen = x or _first(axes, FAVOURITES) or max(axes, key=lambda axis: axes[axis])
    return _layout(study, chosen, None)


def map_layout(study: xr.Dataset) -> Layout | None:
    """Layout of maps over two axes of more than `SMALL_AXIS` values, or None without such two."""
    long = {axis: size for axis, size in swept_axes(study).items() if size > SMALL_AXIS}
    if len(long) < 2:
        return None
    ordered = sorted(long, key=lambda axis: (axis not in FAVOURITES, list(long).index(axis)))
    y = _first(dict.fromkeys(ordered[:2], 0), FAVOURITES) or ordered[1]
    x = next(axis for axis in ordered[:2] if axis != y)
    return _layout(study, x, y)


def is_logarithmic(values: NDArray[Any]) -> bool:
    """Whether positive values that span more than a factor of twenty should be spaced by logarithm.

    Examples
    --------
    >>> is_logarithmic(np.geomspace(1, 1e6, 7)), is_logarithmic(np.linspace(0, 0.5, 7))
    (True, False)
    """
    values = np.asarray(values, dtype=float)
    values = values[np.isfinite(values)]
    return bool(values.size and np.all(values > 0) and values.max() / values.min() > 20)


def axis_label(study: xr.Dataset, axis: str) -> str:
    """Label with meaning, symbol and unit of an axis."""
    unit = unit_text(axis_unit(study, axis))
    words, sign = meaning(axis), symbol(axis)
    label = words if words == sign else f"{words} {mathtext(sign)}"
    return f"{label} [{unit}]" if unit else label


def _layout(study: xr.Dataset, x: str, y: str | None) -> Layout:
    axes = swept_axes(study)
    others = [axis for axis in axes if axis not in (x, y)]
    panel_axis = min(others, key=lambda axis: axes[axis], default=None)
    fixed = {axis: axes[axis] // 2 for axis in others if axis != panel_axis}
    words = ", ".join(_at(study, axis, position) for axis, position in fixed.items())
    panels = tuple(_panels(study, panel_axis, fixed))
    return Layout(x, y, panels, panel_axis, words)


def _panels(study: xr.Dataset, axis: str | None, fixed: dict[str, int]) -> Iterator[Panel]:
    if axis is None:
        yield Panel(fixed, "")
        return
    size = study.sizes[axis]
    for position in np.unique(np.linspace(0, size - 1, min(size, PANELS)).round().astype(int)):
        value = axis_values(study, axis)[position]
        title = f"{mathtext(symbol(axis))} = {quantity(value, axis_unit(study, axis))}"
        yield Panel({**fixed, axis: int(position)}, title)


def _at(study: xr.Dataset, axis: str, position: int) -> str:
    value = axis_values(study, axis)[position]
    return at(axis, value, axis_unit(study, axis))


def _first(axes: dict[str, int], wanted: tuple[str, ...]) -> str | None:
    return next((axis for axis in wanted if axis in axes), None)
