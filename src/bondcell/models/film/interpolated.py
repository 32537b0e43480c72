"""Many geometries of a few materials: the model solved on a grid of shapes and interpolated.

A packing has thousands of different bonds but few materials. For one set of materials ``ln K`` is a
smooth function of the shape, so a Chebyshev grid of some hundred cells stands for all of them. The
grid grows until solves at some of the points themselves agree.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import product

import numpy as np
from numpy.typing import NDArray

from bondcell.cell import Cell, FloatArray
from bondcell.models.model import Springs
from bondcell.models.surrogate_axes import chebyshev_points
from bondcell.models.tucker import Tucker

TOLERANCE = 1e-4
"""Estimated relative error that is accepted; it is part of the model's error estimate."""

MARGIN = 2.0
"""The estimate is the largest error found at the checks, times this, or all last coefficients."""

TRUNCATION = 5e-3
"""What the squeezed interpolant may drop, in units of `TOLERANCE`."""

CHECKS = 24
"""Points of a family that are solved to check its interpolant, for each axis."""

GAIN = 3
"""A family has at least this many points for each cell that is solved for it."""

FIRST, LARGEST = 9, 33
"""Nodes of an axis to begin with, and at most; n nodes are among the next ``2 n - 1``."""

FEW = 6
"""Radius ratios or cylinders up to this number are families of their own."""

ROUND_OFF = 1e-9
"""Extent of an axis below which all points have the same coordinate."""

Law = Callable[[Cell], Springs]
Index = NDArray[np.int64]


def by_families(
    cell: Cell, law: Law, smooth: NDArray[np.bool_], power: int, swaps: bool
) -> tuple[FloatArray, FloatArray]:
    """Stiffness and error estimate of cells, interpolated where many share their materials.

    Parameters
    ----------
    cell
        Flat cells.
    law
        The model, any cells.
    smooth
        Which of the cells are in a range where the stiffness is a smooth function of the shape.
    power
        The stiffness is this power of the length times ``E_m``.
    swaps
        Whether exchanging the particles leaves the stiffness as it is.
    """
    value, error = np.empty(cell.gap.shape), np.empty(cell.gap.shape)
    left = np.ones(cell.gap.shape, dtype=bool)
    families = [family for family in _families(cell, smooth, swaps) if family.pays()]
    pending = families
    while pending:
        wanted = [family.wanted() for family in pending]
        springs = law(_joined(wanted))
        ends = np.cumsum([part.gap.size for part in wanted])[:-1]
        errors = np.broadcast_to(springs.relative_error, springs.stiffness.shape)
        for family, found, own in zip(
            pending, np.split(springs.stiffness, ends), np.split(errors, ends), strict=True
        ):
            family.receive(found, own)
        pending = [family for family in pending if not family.done and family.pays()]
    for family in families:
        if family.done:
            members = cell.take(family.points)
            scale = members.young_m * np.maximum(members.radius_i, members.radius_j) ** power
            value[family.points] = family.values() * scale
            error[family.points] = family.error
            left[family.points] = False
    if left.any():
        springs = law(cell.take(left))
        value[left], error[left] = springs.stiffness, springs.relative_error
    return value, error


class Family:
    """Cells that differ in their shape alone.

    Parameters
    ----------
    points
        Where the cells are among all that were given.
    coordinates
        Of the cells, see `_coordinates`, shape (3, cells).
    materials
        Moduli over ``E_m`` and Poisson's ratios, particle i being the larger one.
    turned
        Whether particle j is the larger one in truth.
    """

    def __init__(
        self, points: Index, coordinates: FloatArray, materials: dict[str, float], turned: bool
    ) -> None:
        self.points, self.coordinates = points, coordinates
        self.materials, self.turned = materials, turned
        self.low, self.high = coordinates.min(axis=1), coordinates.max(axis=1)
        self.axes = np.flatnonzero(self.high - self.low > ROUND_OFF)
        self.sizes = np.full(self.axes.size, FIRST)
        _, different = np.unique(np.round(coordinates, 9), axis=1, return_index=True)
        self.different = different.size
        self.checks = np.random.default_rng(0).permutation(different)[: CHECKS * self.axes.size]
        self.checked: FloatArray = np.empty(0)
        self.known: dict[tuple[float, ...], float] = {}
        self.own_error, self.error, self.done = 0.0, np.inf, False

    def pays(self) -> bool:
        """Whether the next grid is small against the number of points, and within bounds."""
        cells = int(np.prod(self.sizes)) + self.checks.size
        return GAIN * cells <= self.different and bool(np.all(self.sizes <= LARGEST))

    def wanted(self) -> Cell:
        """Cells to be solved next, the larger radius and ``E_m`` being one."""
        self.asked = [node for node in self._nodes() if node not in self.known]
        places = np.array(self.asked)
        at = np.repeat(self.low[:, None], len(self.asked), axis=1)
        at[self.axes] += (self.high - self.low)[self.axes, None] * (places.T + 1) / 2
        if not self.checked.size:
            at = np.concatenate([at, self.coordinates[:, self.checks]], axis=1)
        gap, angle, outer = at
        ratio = np.cos(angle)
        cell = Cell.from_values(
            radius_i=np.ones(ratio.size),
            radius_j=ratio,
            gap=np.exp(gap) * 2 * ratio / (1 + ratio),
            cylinder_radius=np.maximum(np.exp(outer), 1.0),
            young_m=1.0,
            **self.materials,
        )
        return (cell.swapped() if self.turned else cell).ravel()

    def receive(self, stiffness: FloatArray, error: FloatArray) -> None:
        """Take the solved cells, judge the interpolant, and choose the axis to refine."""
        count = len(self.asked)
        self.known.update(zip(self.asked, np.log(stiffness[:count]), strict=True))
        if stiffness.size > count:
            self.checked = stiffness[count:]
        self.own_error = max(self.own_error, float(error.max()))
        values = np.array([self.known[node] for node in self._nodes()]).reshape(self.sizes)
        self.tensor = Tucker.fit(values, TOLERANCE * TRUNCATION)
        off = np.abs(self._interpolated(self.checks) / self.checked - 1).max()
        tails = [_tail(values, axis) for axis in range(self.axes.size)]
        estimate = max(MARGIN * float(off), sum(tails))
        self.error, self.done = self.own_error + estimate, estimate <= TOLERANCE
        if not self.done:
            axis = int(np.argmax(tails))
            self.sizes[axis] = 2 * self.sizes[axis] - 1

    def values(self) -> FloatArray:
        """The interpolated stiffness of all points, in units of the larger radius and ``E_m``."""
        return self._interpolated(np.arange(self.points.size))

    def _interpolated(self, some: Index) -> FloatArray:
        span = (self.high - self.low)[self.axes, None]
        at = (self.coordinates[self.axes][:, some] - self.low[self.axes, None]) / span
        return np.exp(self.tensor(list(2 * at - 1)))

    def _nodes(self) -> Iterator[tuple[float, ...]]:
        # Rounded: the same node of a finer grid has to be found again.
        return product(*(np.round(chebyshev_points(n), 12).tolist() for n in self.sizes))


def _tail(values: FloatArray, axis: int) -> float:
    """How large the last coefficients along an axis are."""
    points = chebyshev_points(values.shape[axis])
    vandermonde = np.polynomial.chebyshev.chebvander(points, points.size - 1)
    coefficients = np.linalg.solve(
        vandermonde, np.moveaxis(values, axis, 0).reshape(points.size, -1)
    )
    return float(np.abs(coefficients[-2:]).max())


def _coordinates(
    gap: FloatArray, large: FloatArray, small: FloatArray, outer: FloatArray
) -> FloatArray:
    """``ln(L_g/R*)``, the angle whose cosine is the ratio of the radii, ``ln(R_c/R_large)``.

    The rim of the larger sphere beside the smaller one, ``sqrt(R_i^2 - R_j^2)``, is the sine of
    that angle, and the stiffness is a smooth function of it, not of the ratio.
    """
    rim = np.sqrt((large - small) * (large + small))
    over_mean = gap * (large + small) / (2 * large * small)
    return np.stack([np.log(over_mean), np.arctan2(rim, small), np.log(outer / large)])


def _families(cell: Cell, smooth: NDArray[np.bool_], swaps: bool) -> Iterator[Family]:
    """Points that share materials and, unless the particles may swap, the order of the radii."""
    points = np.flatnonzero(smooth)
    if points.size < GAIN * FIRST:
        return
    own = cell.take(points)
    turned = own.radius_j > own.radius_i

    def ordered(i: FloatArray, j: FloatArray) -> tuple[FloatArray, FloatArray]:
        return np.where(turned, j, i), np.where(turned, i, j)

    large, small = ordered(own.radius_i, own.radius_j)
    young = ordered(own.young_i / own.young_m, own.young_j / own.young_m)
    poisson = ordered(own.poisson_i, own.poisson_j)
    materials = np.stack([*young, *poisson, own.poisson_m])
    coordinates = _coordinates(own.gap, large, small, own.cylinder_radius)
    key = np.concatenate([materials, turned[None] & (not swaps), _few(coordinates[1:])])
    for members in _alike(key):
        names = ("young_i", "young_j", "poisson_i", "poisson_j", "poisson_m")
        shared = dict(zip(names, materials[:, members[0]].tolist(), strict=True))
        order = bool(turned[members[0]]) and not swaps
        yield Family(points[members], coordinates[:, members], shared, order)


def _few(coordinates: FloatArray) -> FloatArray:
    """Coordinates that take few values, which then tell families apart; zeros for the others."""
    rounded = np.round(coordinates, 9)
    few = [np.unique(row).size <= FEW for row in rounded]
    return np.where(np.array(few)[:, None], rounded, 0.0)


def _alike(key: FloatArray) -> Iterator[Index]:
    """Positions of equal columns."""
    _, place = np.unique(key, axis=1, return_inverse=True)
    order = np.argsort(place.reshape(-1), kind="stable")
    yield from np.split(order, np.flatnonzero(np.diff(place.reshape(-1)[order])) + 1)


def _joined(cells: list[Cell]) -> Cell:
    """Flat cells one after the other."""
    parts = [cell.as_dict() for cell in cells]
    return Cell(**{name: np.concatenate([part[name] for part in parts]) for name in parts[0]})
