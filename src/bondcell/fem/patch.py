"""A curved quadrilateral: part of a ruled surface between an arc (or a segment) and a segment."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bondcell.cell import FloatArray

Point = tuple[float, float]


@dataclass(frozen=True)
class Patch:
    """A sub-quadrilateral of a ruled surface between a base line and a top segment.

    The base is the arc of ``radius`` from polar angle ``angles[0]`` to ``angles[1]`` (measured
    from the tip), or the segment ``base`` if ``angles`` is None. ``corners`` are the sub-
    quadrilateral's vertices in the ruled surface's own unit square.
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


def corner_rings(breaks: list[float]) -> list[list[tuple[int, int]]]:
    """Quadrilaterals that shrink toward the corner (0, 0) of a square, as break indices.

    One square at the corner, then two trapezia a ring; ``breaks`` start at 0 and end at 1. The two
    edges away from the corner stay undivided, so what lies beyond needs no refinement.
    """
    rings = [[(0, 0), (1, 0), (1, 1), (0, 1)]]
    for k in range(1, len(breaks) - 1):
        rings.append([(k, 0), (k + 1, 0), (k + 1, k + 1), (k, k)])
        rings.append([(0, k), (k, k), (k + 1, k + 1), (0, k + 1)])
    return rings
