"""One half of the bond cell's meridional section, from end plane to mid-gap.

Local coordinates of a half: ``r`` from the axis, ``y`` from the sphere's tip toward the gap, so
that thin films keep full relative precision. The sphere's end plane is ``y = -R``.

The section is filled with curved quadrilaterals. The particle is an O-grid of three blocks: a
centre and two blocks that shrink geometrically, one toward the tip (where the film's pressure
acts) and one toward the foot (where sphere, end plane and lateral surface meet). The matrix
follows with one ruled element per arc segment: vertical ones from the tip block to the level
plane, horizontal ones (rows) from the foot block to the lateral surface. Straight blocks fill
what is farther away. This file holds dimensions, names and elements of a half; `half_particle`
and `half_matrix` make the elements.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from scipy.optimize import brentq

from bondcell.fem.breaks import stretch
from bondcell.fem.patch import Patch

Key = tuple[object, ...]

MATRIX, PARTICLE_I, PARTICLE_J = 0, 1, 2

MIDDLE_ANGLE = 0.68
"""Where the arc is split between tip block and foot block, measured from the tip [rad]."""

FOOT_ANGLE = np.pi / 2 - MIDDLE_ANGLE
"""Angle of the foot block [rad]."""

NEAR_FIELD = 0.6
"""How far the ruled elements reach beyond the sphere, in radii; straight blocks follow."""


@dataclass
class HalfCell:
    """Geometry and elements of one half.

    Parameters
    ----------
    side
        ``"i"`` or ``"j"``.
    radius, reach, side_radius, cylinder_radius
        Sphere radius, distance from the tip to mid-gap, where the ruled elements end sideways,
        radius of the cylinder [m].
    tip_breaks, foot_breaks
        Break points of the two arc halves, as fractions of their angle, ascending, the last one 1.
    corner_breaks
        Break points in (0, 1) that refine the first row toward its corners; none if they are
        smooth.
    cut
        Whether the matrix ends at the first foot break instead of running into the cusp.
    growth
        Ratio of neighbouring sizes of the straight blocks.
    """

    side: str
    radius: float
    reach: float
    side_radius: float
    cylinder_radius: float
    tip_breaks: list[float]
    foot_breaks: list[float]
    corner_breaks: list[float]
    cut: bool
    growth: float
    elements: list[tuple[tuple[Key, ...], Patch, int]] = field(default_factory=list)
    beside_foot: set[int] = field(default_factory=set)
    labels: dict[Key, set[str]] = field(default_factory=dict)

    def __post_init__(self) -> None:
        near = NEAR_FIELD * self.radius
        self.level = self.reach if self.reach <= 1.5 * near else near
        self.heights = [self.level, *stretch(self.level, self.reach, near, self.growth)]
        first = self.foot_breaks[0]
        self.foot = [0.0, *(first * c for c in self.corner_breaks), *self.foot_breaks]

    def wanted_columns(self) -> list[float]:
        """Radii where this half would like columns, besides axis, side and lateral surface [m]."""
        inner = [self.plane_radius(b * MIDDLE_ANGLE) for b in self.tip_breaks[:-1]]
        step = NEAR_FIELD * self.radius
        return [*inner, *stretch(self.side_radius, self.cylinder_radius, step, self.growth)[:-1]]

    def set_columns(self, columns: list[float]) -> None:
        """Take over the radii of both halves' columns at mid-gap [m]."""
        inner = [r for r in columns if 0 < r < self.side_radius * (1 - 1e-9)]
        self.tip = [0.0, *(self._angle_of(r) / MIDDLE_ANGLE for r in inner), 1.0]
        self.inner_columns = [0.0, *inner, self.side_radius]
        self.outer_columns = [r for r in columns if r > self.side_radius * (1 + 1e-9)]

    def plane_radius(self, angle: float) -> float:
        """Radius on the level plane facing the arc at ``angle``; vertical lines near the axis."""
        lean = ((1 - np.cos(angle)) / (1 - np.cos(MIDDLE_ANGLE))) ** 2
        offset = self.side_radius - self.radius * np.sin(MIDDLE_ANGLE)
        return float(self.radius * np.sin(angle) + offset * lean)

    def side_height(self, angle: float) -> float:
        """Height ``y`` on the side facing the arc at ``angle``; horizontal lines near the foot."""
        lean = ((1 - np.sin(angle)) / (1 - np.sin(MIDDLE_ANGLE))) ** 2
        offset = self.level + 2 * self.radius * np.sin(MIDDLE_ANGLE / 2) ** 2
        return float(-2 * self.radius * np.sin(angle / 2) ** 2 + offset * lean)

    def _angle_of(self, r: float) -> float:
        return float(brentq(lambda a: self.plane_radius(a) - r, 0.0, MIDDLE_ANGLE, xtol=1e-15))

    @property
    def row_starts(self) -> list[int]:
        """Foot breaks where rows begin, and the last one: the first row spans the corner breaks."""
        first = len(self.corner_breaks) + 1
        return [0, *range(first, len(self.foot))]

    def arc(self, block: str, k: int) -> Key:
        """Vertex ``k`` on the arc, counted from the block's corner; both blocks meet at M."""
        last = len(self.tip if block == "tip" else self.foot) - 1
        return (self.side, "M") if k == last else (self.side, block, "arc", k)

    def row_vertex(self, layer: int, column: int) -> Key:
        """Vertex on the level plane (layer 0) or farther up; the last layer is mid-gap."""
        if layer == len(self.heights) - 1:
            return ("mid-gap", column)
        return (self.side, "layer", layer, column)

    def side_vertex(self, column: int, row: int) -> Key:
        """Vertex on the side (column 0) or farther out, at the start of ``row``."""
        if row == len(self.row_starts) - 1:
            return self.row_vertex(0, len(self.tip) - 1 + column)
        return (self.side, "side", column, row)

    def add(self, keys: tuple[Key, ...], patch: Patch, is_matrix: bool) -> None:
        """Append one element."""
        own = PARTICLE_I if self.side == "i" else PARTICLE_J
        self.elements.append((keys, patch, MATRIX if is_matrix else own))

    def label(self, key: Key, name: str) -> None:
        """Put a vertex on a named boundary."""
        self.labels.setdefault(key, set()).add(name)
