"""One half of the bond cell's meridional section as curved quadrilaterals, from end plane to mid-gap.

Local coordinates of a half: ``r`` from the axis, ``y`` from the sphere's tip toward the gap, so that
thin films keep full relative precision. The sphere's end plane is ``y = -R``.

The particle is an O-grid of three blocks: a centre and two blocks that shrink geometrically, one
toward the tip (where the film's pressure acts) and one toward the foot (where sphere, end plane and
lateral surface meet). The matrix follows with one ruled element per arc segment: vertical ones from
the tip block to the level plane, horizontal ones from the foot block to the lateral surface. Straight
blocks fill what is farther away.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from scipy.optimize import brentq

from bondcell.cell import FloatArray

Key = tuple[object, ...]
Point = tuple[float, float]

MATRIX, PARTICLE_I, PARTICLE_J = 0, 1, 2
MIDDLE_ANGLE = 0.9
"""Where the arc is split between tip block and foot block, measured from the tip [rad]."""
NEAR_FIELD = 0.6
"""How far the ruled elements reach beyond the sphere, in radii; straight blocks follow."""


@dataclass(frozen=True)
class Patch:
    """A sub-quadrilateral of a ruled surface between a base line and a top segment.

    The base is the arc of ``radius`` from polar angle ``angles[0]`` to ``angles[1]`` (measured from the
    tip), or the segment ``base`` if ``angles`` is None. ``corners`` are the sub-quadrilateral's
    vertices in the ruled surface's own unit square.
    """

    radius: float
    angles: Point | None
    base: tuple[Point, Point] | None
    top: tuple[Point, Point]
    corners: FloatArray

    def points(self, along: FloatArray, across: FloatArray) -> FloatArray:
        """Positions (2, ...) [m] at coordinates of the sub-quadrilateral's unit square."""
        c = self.corners
        s, t = (
            (1 - along) * (1 - across) * c[0, k]
            + along * (1 - across) * c[1, k]
            + along * across * c[2, k]
            + (1 - along) * across * c[3, k]
            for k in (0, 1)
        )
        (r0, y0), (r1, y1) = self.top
        top_r, top_y = r0 + s * (r1 - r0), y0 + s * (y1 - y0)
        if self.angles is not None:
            angle = self.angles[0] + s * (self.angles[1] - self.angles[0])
            base_r = self.radius * np.sin(angle)
            base_y = -2 * self.radius * np.sin(angle / 2) ** 2
        else:
            assert self.base is not None
            (q0, w0), (q1, w1) = self.base
            base_r, base_y = q0 + s * (q1 - q0), w0 + s * (w1 - w0)
        return np.array([base_r + t * (top_r - base_r), base_y + t * (top_y - base_y)])


UNIT_SQUARE = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])


def graded_breaks(scale: float, ratio: float) -> list[float]:
    """Break points in (0, 1], geometric with about ``ratio``, the first one near ``scale``."""
    if scale * 1.5 >= 1:
        return [1.0]
    count = max(1, round(np.log(1 / scale) / np.log(ratio)))
    return [float(scale ** (1 - k / count)) for k in range(count)] + [1.0]


def side_radius(radius: float, cylinder_radius: float) -> float:
    """Where the ruled elements beside a sphere end: at the lateral surface unless it is far away."""
    near = NEAR_FIELD * radius
    return cylinder_radius if cylinder_radius - radius <= 1.5 * near else radius + near


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
    cut
        Whether the matrix ends at the first foot break instead of running into the cusp.
    """

    side: str
    radius: float
    reach: float
    side_radius: float
    cylinder_radius: float
    tip_breaks: list[float]
    foot_breaks: list[float]
    cut: bool
    growth: float
    elements: list[tuple[tuple[Key, ...], Patch, int]] = field(default_factory=list)
    labels: dict[Key, set[str]] = field(default_factory=dict)

    def __post_init__(self) -> None:
        near = NEAR_FIELD * self.radius
        self.level = self.reach if self.reach <= 1.5 * near else near

    # Columns: where the lines from the tip block meet the level plane, and the ones farther out.

    def plane_radius(self, angle: float) -> float:
        """Radius on the level plane that faces the arc at ``angle``; vertical lines near the axis."""
        lean = ((1 - np.cos(angle)) / (1 - np.cos(MIDDLE_ANGLE))) ** 2
        offset = self.side_radius - self.radius * np.sin(MIDDLE_ANGLE)
        return float(self.radius * np.sin(angle) + offset * lean)

    def wanted_columns(self) -> list[float]:
        """Radii where this half would like columns, besides axis, side and lateral surface [m]."""
        inner = [self.plane_radius(b * MIDDLE_ANGLE) for b in self.tip_breaks[:-1]]
        step = NEAR_FIELD * self.radius
        return [*inner, *stretch(self.side_radius, self.cylinder_radius, step, self.growth)[:-1]]

    def build(self, columns: list[float]) -> None:
        """Make the elements; ``columns`` are radii that the mid-gap plane must contain [m]."""
        inner = [r for r in columns if 0 < r < self.side_radius * (1 - 1e-9)]
        tip = [0.0, *(self._angle_of(r) / MIDDLE_ANGLE for r in inner), 1.0]
        foot = [0.0, *self.foot_breaks]
        outer = [r for r in columns if r > self.side_radius * (1 + 1e-9)]
        self.tip_count, self.foot_count = len(tip) - 1, len(foot) - 1
        self._particle(tip, foot)
        plane = [0.0, *inner, self.side_radius]
        self._film_above_tip(tip, plane)
        sides = self._film_beside_foot(foot)
        self._outer_blocks(sides, outer)
        self._far_layers(plane + outer)

    def _angle_of(self, r: float) -> float:
        return float(brentq(lambda a: self.plane_radius(a) - r, 0.0, MIDDLE_ANGLE, xtol=1e-15))

    # Vertex names. The tip and foot blocks count from their corner; both end at "M" on the arc.

    def _arc(self, block: str, k: int) -> Key:
        last = self.tip_count if block == "tip" else self.foot_count
        return (self.side, "M") if k == last else (self.side, block, "arc", k)

    def _block_vertex(self, block: str, k: int, m: int) -> Key:
        last = self.tip_count if block == "tip" else self.foot_count
        if m == 0:
            return self._arc(block, k)
        if k == m == last:
            return (self.side, "C")
        return (self.side, block, k, m)

    def _row(self, layer: int, column: int) -> Key:
        if layer == self.layers:
            return ("mid", column)
        return (self.side, "row", layer, column)

    def _lateral(self, column: int, k: int) -> Key:
        if k == self.foot_count:
            return self._row(0, self.tip_count + column)
        return (self.side, "lateral", column, k)

    @property
    def layers(self) -> int:
        """Straight layers between the level plane and mid-gap."""
        return len(self._layer_heights()) - 1

    def _layer_heights(self) -> list[float]:
        steps = stretch(self.level, self.reach, NEAR_FIELD * self.radius, self.growth)
        return [self.level, *steps]

    def _add(self, keys: tuple[Key, ...], patch: Patch, matrix: bool = True) -> None:
        own = PARTICLE_I if self.side == "i" else PARTICLE_J
        self.elements.append((keys, patch, MATRIX if matrix else own))

    def _label(self, key: Key, *names: str) -> None:
        self.labels.setdefault(key, set()).update(names)

    def _particle(self, tip: list[float], foot: list[float]) -> None:
        radius = self.radius
        axis_point, plane_point = (0.0, -0.55 * radius), (0.45 * radius, -radius)
        inner = (0.4 * radius, -0.6 * radius)
        self._corner_block("tip", tip, (0.0, MIDDLE_ANGLE), (axis_point, inner))
        self._corner_block("foot", foot, (np.pi / 2, MIDDLE_ANGLE), (plane_point, inner))
        keys: tuple[Key, ...] = (
            (self.side, "O"),
            self._block_vertex("foot", 0, self.foot_count),
            (self.side, "C"),
            self._block_vertex("tip", 0, self.tip_count),
        )
        centre = Patch(
            radius, None, ((0.0, -radius), plane_point), (axis_point, inner), UNIT_SQUARE
        )
        self._add(keys, centre, matrix=False)
        self._label((self.side, "O"), "axis", "end")
        for m in range(self.tip_count + 1):
            self._label(self._block_vertex("tip", 0, m), "axis")
        for m in range(self.foot_count + 1):
            self._label(self._block_vertex("foot", 0, m), "end")

    def _corner_block(
        self, block: str, breaks: list[float], angles: Point, top: tuple[Point, Point]
    ) -> None:
        """Geometric rings around the block's corner: one square, then two trapezia a ring."""
        name = self._block_vertex

        def add(corners: list[tuple[int, int]]) -> None:
            square = np.array([[breaks[k], breaks[m]] for k, m in corners])
            keys = tuple(name(block, k, m) for k, m in corners)
            self._add(keys, Patch(self.radius, angles, None, top, square), matrix=False)

        add([(0, 0), (1, 0), (1, 1), (0, 1)])
        for k in range(1, len(breaks) - 1):
            add([(k, 0), (k + 1, 0), (k + 1, k + 1), (k, k)])
            add([(0, k), (k, k), (k + 1, k + 1), (0, k + 1)])

    def _film_above_tip(self, tip: list[float], plane: list[float]) -> None:
        for k in range(self.tip_count):
            angles = (tip[k] * MIDDLE_ANGLE, tip[k + 1] * MIDDLE_ANGLE)
            top = ((plane[k], self.level), (plane[k + 1], self.level))
            keys = (
                self._arc("tip", k),
                self._arc("tip", k + 1),
                self._row(0, k + 1),
                self._row(0, k),
            )
            self._add(keys, Patch(self.radius, angles, None, top, UNIT_SQUARE))
        self._label(self._row(0, 0), "axis")

    def _side_height(self, angle: float) -> float:
        """Height ``y`` on the side that faces the arc at ``angle``; horizontal lines near the foot."""
        lean = ((1 - np.sin(angle)) / (1 - np.sin(MIDDLE_ANGLE))) ** 2
        offset = self.level + 2 * self.radius * np.sin(MIDDLE_ANGLE / 2) ** 2
        return float(-2 * self.radius * np.sin(angle / 2) ** 2 + offset * lean)

    def _film_beside_foot(self, foot: list[float]) -> list[float]:
        angles = [np.pi / 2 - b * (np.pi / 2 - MIDDLE_ANGLE) for b in foot]
        heights = [-self.radius, *(self._side_height(a) for a in angles[1:-1]), self.level]
        for k in range(1 if self.cut else 0, self.foot_count):
            top = ((self.side_radius, heights[k]), (self.side_radius, heights[k + 1]))
            keys = (
                self._arc("foot", k),
                self._arc("foot", k + 1),
                self._lateral(0, k + 1),
                self._lateral(0, k),
            )
            patch = Patch(self.radius, (angles[k], angles[k + 1]), None, top, UNIT_SQUARE)
            self._add(keys, patch)
        if not self.cut:
            self._label(self._lateral(0, 0), "end")
        return heights

    def _outer_blocks(self, heights: list[float], outer: list[float]) -> None:
        radii = [self.side_radius, *outer]
        for column in range(len(outer)):
            for k in range(self.foot_count):
                base = ((radii[column], heights[k]), (radii[column + 1], heights[k]))
                top = ((radii[column], heights[k + 1]), (radii[column + 1], heights[k + 1]))
                keys = (
                    self._lateral(column, k),
                    self._lateral(column + 1, k),
                    self._lateral(column + 1, k + 1),
                    self._lateral(column, k + 1),
                )
                self._add(keys, Patch(self.radius, None, base, top, UNIT_SQUARE))
            self._label(self._lateral(column + 1, 0), "end")
        for k in range(1 if self.cut else 0, self.foot_count + 1):
            self._label(self._lateral(len(outer), k), "lateral")

    def _far_layers(self, radii: list[float]) -> None:
        heights = self._layer_heights()
        last = len(radii) - 1
        for layer in range(self.layers):
            for column in range(last):
                base = ((radii[column], heights[layer]), (radii[column + 1], heights[layer]))
                top = ((radii[column], heights[layer + 1]), (radii[column + 1], heights[layer + 1]))
                keys = (
                    self._row(layer, column),
                    self._row(layer, column + 1),
                    self._row(layer + 1, column + 1),
                    self._row(layer + 1, column),
                )
                self._add(keys, Patch(self.radius, None, base, top, UNIT_SQUARE))
        for layer in range(self.layers + 1):
            self._label(self._row(layer, 0), "axis")
            self._label(self._row(layer, last), "lateral")
        for column in range(last + 1):
            self._label(self._row(self.layers, column), "middle")


def stretch(start: float, stop: float, step: float, growth: float) -> list[float]:
    """Points after ``start`` up to ``stop`` with steps that grow geometrically from ``step``."""
    if stop <= start:
        return []
    sizes = [step]
    while sum(sizes) < stop - start:
        sizes.append(sizes[-1] * growth)
    scale = (stop - start) / sum(sizes)
    return [*(start + scale * float(c) for c in np.cumsum(sizes[:-1])), stop]
