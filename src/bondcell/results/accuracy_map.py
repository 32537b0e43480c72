"""The atlas in a small file: what error each model has near a cell, and what it costs.

Built from the scene ``atlas`` by `bondcell.results.accuracy_map_build` and shipped with the package, so
that advice needs no study. The map is about equal pairs in a cylinder of their radius; at each of
its points it holds the largest error over the particles' Poisson's ratios.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from importlib.resources import files
from itertools import product
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bondcell.cell import Cell, FloatArray

AXES = ("gap_ratio", "modulus_ratio", "poisson_m")
"""Axes of the map."""

SMALLEST, STEP, LEVELS = 1e-6, 1.05, 400
"""Errors are stored as powers of `STEP` times `SMALLEST`, rounded up; beyond them as infinite."""

NO_VALUE = -1000
"""Code of a point where a model has no value."""

ROUNDING = 1e-9
"""A cell on the border of the map is inside in spite of round-off."""

Codes = NDArray[np.int16]


def encode(error: FloatArray) -> Codes:
    """Signed relative errors as codes, sizes rounded up.

    Examples
    --------
    >>> encode(np.array([-0.5, 0.0, np.nan])).tolist()
    [-269, 0, -1000]
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        level = np.ceil(np.log(np.abs(error) / SMALLEST) / np.log(STEP) - ROUNDING)
    level = np.where(np.isnan(error), 0, np.clip(level, 0, LEVELS + 1))
    code = np.copysign(level, np.where(np.isnan(error), 1.0, error))
    return np.where(np.isnan(error), NO_VALUE, code).astype(np.int16)


def decode(code: Codes) -> FloatArray:
    """Signed relative errors of codes, `SMALLEST` at least: finer than the reference is unknown.

    NaN stands for no value, infinity for an error beyond the last level.

    Examples
    --------
    >>> decode(np.array([-269, 0, -1000], dtype=np.int16)).tolist()  # doctest: +ELLIPSIS
    [-0.5010..., 1e-06, nan]
    """
    level = np.abs(code.astype(float))
    size = np.where(level > LEVELS, np.inf, SMALLEST * STEP**level)
    return np.where(code == NO_VALUE, np.nan, np.copysign(size, code.astype(float)))


@dataclass(frozen=True)
class Expected:
    """Error of a model to expect, shape (cells,).

    Parameters
    ----------
    error
        Largest size of the relative error among the neighbouring points of the map, times the
        model's margin; NaN where it has no value at one of them or the cell is not on the map.
    low, high
        The smallest and the largest signed error among them, without margin, neither rounded up.
    """

    error: FloatArray
    low: FloatArray
    high: FloatArray


@dataclass(frozen=True)
class AccuracyMap:
    """Errors of all models over the atlas.

    Parameters
    ----------
    axes
        Axis -> its values, ascending, the last modulus ratio infinite.
    codes
        Load -> model -> codes of its errors, shape of the axes.
    about
        Provenance, times, margins and ranges, as they were written.
    """

    axes: Mapping[str, FloatArray]
    codes: Mapping[str, Mapping[str, Codes]]
    about: Mapping[str, Any]

    def contains(self, cell: Cell) -> NDArray[np.bool_]:
        """Which cells are on the map, shape of the cell."""
        return np.asarray([not reason for reason in self.why_outside(cell)]).reshape(cell.shape)

    def why_outside(self, cell: Cell) -> list[str]:
        """Why each cell is off the map, empty for one that is on it."""
        flat = cell.ravel()
        low, high = self.about["poisson_particle"]
        same = (flat.radius_i == flat.radius_j) & (flat.young_i == flat.young_j)
        same &= flat.poisson_i == flat.poisson_j
        gap, ratio, poisson = self.coordinates(flat)
        checks = {
            "the particles are not equal": ~same,
            "the cylinder is wider than the particles": flat.cylinder_radius != flat.radius_i,
            "the gap is outside 1e-4 to 3 radii": _off(gap, self.axes["gap_ratio"]),
            "the particles are softer than the matrix": _off(ratio, self.axes["modulus_ratio"]),
            "the matrix's Poisson's ratio is negative": _off(poisson, self.axes["poisson_m"]),
            f"the particles' Poisson's ratio is outside {low:g} to {high:g}": ~(
                (flat.poisson_i >= low) & (flat.poisson_i <= high)
            ),
        }
        reasons = [""] * gap.size
        for words, wrong in reversed(checks.items()):
            for k in np.flatnonzero(wrong):
                reasons[k] = words
        return reasons

    def coordinates(self, flat: Cell) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Gap over radius, modulus ratio and Poisson's ratio of the matrix of a raveled cell."""
        return flat.gap / flat.radius_i, flat.young_i / flat.young_m, flat.poisson_m

    def expected(self, load: str, model: str, cell: Cell) -> Expected:
        """Error to expect of a model.

        Parameters
        ----------
        load, model
            Names; the model has the load.
        cell
            Any number of cells.
        """
        corners = self.corners(cell)
        error = decode(self.codes[load][model])
        found = np.stack([error[corner] for corner in corners])
        inside = self.contains(cell).ravel()
        found = np.where(inside, found, np.nan)
        margin = self.about["margins"][load][model]
        middle = found / np.sqrt(STEP)
        return Expected(np.abs(found).max(axis=0) * margin, middle.min(axis=0), middle.max(axis=0))

    def corners(self, cell: Cell) -> list[tuple[NDArray[np.int64], ...]]:
        """The up to eight neighbouring points of each cell, each as indices along the axes."""
        sides = []
        for axis, value in zip(AXES, self.coordinates(cell.ravel()), strict=True):
            nodes = self.axes[axis]
            below = np.searchsorted(nodes, value * (1 + ROUNDING), side="right") - 1
            above = np.searchsorted(nodes, value * (1 - ROUNDING), side="left")
            last = nodes.size - 1
            sides.append((np.clip(below, 0, last), np.clip(above, 0, last)))
        return list(product(*sides))

    def seconds(self, load: str, model: str, cells: int) -> float:
        """Time a cell [s] on the machine that built the map, of a call with that many cells.

        A call has a fixed cost, which its cells share; their geometries differ.
        """
        times = self.about["seconds"][load][model]
        each = min(times["many"], times["one"])
        return float(each + (times["one"] - each) / cells)


def _off(value: FloatArray, nodes: FloatArray) -> NDArray[np.bool_]:
    return ~((value >= nodes[0] * (1 - ROUNDING)) & (value <= nodes[-1] * (1 + ROUNDING)))


@lru_cache(maxsize=1)
def shipped_map() -> AccuracyMap:
    """The map that comes with the package."""
    source = files("bondcell.models").joinpath("data/accuracy_map.npz")
    with source.open("rb") as stream, np.load(stream, allow_pickle=False) as data:
        return from_arrays(data)


def from_arrays(data: Mapping[str, Any]) -> AccuracyMap:
    """The map of a file's arrays."""
    codes: dict[str, dict[str, Codes]] = {}
    for name in data:
        load, _, model = name.partition("_")
        if model and load in LOADS:
            codes.setdefault(load, {})[model] = undelta(data[name])
    return AccuracyMap({axis: data[axis] for axis in AXES}, codes, json.loads(str(data["about"])))


LOADS = ("normal", "shear", "torsion", "bending")
"""Loads of the map."""


def delta(codes: Codes) -> Codes:
    """Differences along the last axis: they compress better."""
    return np.diff(codes, axis=-1, prepend=np.int16(0))


def undelta(steps: Codes) -> Codes:
    """The codes of `delta`."""
    return np.cumsum(steps, axis=-1, dtype=np.int16)
