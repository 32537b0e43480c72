"""A curved quadrilateral: part of a ruled surface between an arc (or a segment) and a segment."""

from __future__ import annotations

from collections.abc import Sequence
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


def patch_points(patches: Sequence[Patch], along: FloatArray, across: FloatArray) -> FloatArray:
    """Positions (2, patches, ...) [m] at coordinates of each sub-quadrilateral's unit square."""
    shape = (-1, *np.ones(np.ndim(along + across), dtype=int))

    def column(values: list[float]) -> FloatArray:
        return np.reshape(values, shape)

    weights = (1 - along) * (1 - across), along * (1 - across), along * across, (1 - along) * across
    s, t = (
        sum(
            column([patch.corners[m, k] for patch in patches]) * weight
            for m, weight in enumerate(weights)
        )
        for k in (0, 1)
    )
    top = [[column([p.top[m][k] for p in patches]) for k in (0, 1)] for m in (0, 1)]
    ends = [p.base or ((0.0, 0.0), (0.0, 0.0)) for p in patches]
    base = [[column([end[m][k] for end in ends]) for k in (0, 1)] for m in (0, 1)]
    angles = [column([(p.angles or (0.0, 0.0))[m] for p in patches]) for m in (0, 1)]
    # Of an arc and a segment, the one that a patch does not have is a point at the origin.
    radius = column([0.0 if p.angles is None else p.radius for p in patches])
    angle = angles[0] + s * (angles[1] - angles[0])
    arc = radius * np.sin(angle), -2 * radius * np.sin(angle / 2) ** 2
    result = []
    for k in (0, 1):
        bottom = arc[k] + base[0][k] + s * (base[1][k] - base[0][k])
        result.append(bottom + t * (top[0][k] + s * (top[1][k] - top[0][k]) - bottom))
    return np.array(result)


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
