"""Elements of the matrix around one hemisphere: film, rows beside the foot, straight blocks."""

from __future__ import annotations

import numpy as np

from bondcell.fem.half_cell import FOOT_ANGLE, MIDDLE_ANGLE, HalfCell, Key
from bondcell.fem.patch import UNIT_SQUARE, Patch, corner_rings


def add_matrix(half: HalfCell) -> None:
    """Add the matrix elements and boundary names to ``half``."""
    _add_film(half)
    heights = _add_rows(half)
    _add_outer_blocks(half, heights)
    _add_layers(half)


def _add_film(half: HalfCell) -> None:
    tip, columns = half.tip, half.inner_columns
    for k in range(len(tip) - 1):
        angles = (tip[k] * MIDDLE_ANGLE, tip[k + 1] * MIDDLE_ANGLE)
        top = ((columns[k], half.level), (columns[k + 1], half.level))
        keys = (
            half.arc("tip", k),
            half.arc("tip", k + 1),
            half.row_vertex(0, k + 1),
            half.row_vertex(0, k),
        )
        half.add(keys, Patch(half.radius, angles, None, top, UNIT_SQUARE), is_matrix=True)


def _add_rows(half: HalfCell) -> list[float]:
    """Rows from the foot block to the side; returns the heights of their side vertices."""
    starts = half.row_starts
    angles = [np.pi / 2 - half.foot[k] * FOOT_ANGLE for k in starts]
    heights = [-half.radius, *(half.side_height(a) for a in angles[1:-1]), half.level]
    first = len(half.elements)
    for row in range(1 if half.cut else 0, len(starts) - 1):
        if row == len(starts) - 2:
            half.beside_foot.update(range(first, len(half.elements)))
        top = ((half.side_radius, heights[row]), (half.side_radius, heights[row + 1]))
        if row == 0 and half.corner_breaks:
            _add_foot_rings(half, (angles[0], angles[1]), top)
            continue
        keys = (
            half.arc("foot", starts[row]),
            half.arc("foot", starts[row + 1]),
            half.side_vertex(0, row + 1),
            half.side_vertex(0, row),
        )
        patch = Patch(half.radius, (angles[row], angles[row + 1]), None, top, UNIT_SQUARE)
        half.add(keys, patch, is_matrix=True)
    if not half.cut:
        half.label(half.side_vertex(0, 0), "end")
    return heights


def _add_foot_rings(
    half: HalfCell,
    angles: tuple[float, float],
    top: tuple[tuple[float, float], tuple[float, float]],
) -> None:
    """The first row, refined toward the foot with the particle's own breaks."""
    breaks = [0.0, *half.corner_breaks, 1.0]
    last = len(breaks) - 1

    def vertex(k: int, m: int) -> Key:
        if m == 0:
            return half.arc("foot", k)
        if m == last:
            return half.side_vertex(0, 1 if k == last else 0)
        return (half.side, "foot ring", k, m)

    for ring in corner_rings(breaks):
        corners = np.array([[breaks[k], breaks[m]] for k, m in ring])
        patch = Patch(half.radius, angles, None, top, corners)
        half.add(tuple(vertex(k, m) for k, m in ring), patch, is_matrix=True)
    for m in range(1, last):
        half.label(vertex(0, m), "end")


def _add_outer_blocks(half: HalfCell, heights: list[float]) -> None:
    radii = [half.side_radius, *half.outer_columns]
    last = len(radii) - 2
    for column in range(last + 1):
        for row in range(len(heights) - 1):
            low, high = heights[row], heights[row + 1]
            base = ((radii[column], low), (radii[column + 1], low))
            top = ((radii[column], high), (radii[column + 1], high))
            if (column, row) == (last, 0) and half.corner_breaks:
                _add_lateral_rings(half, column, base, top)
                continue
            keys = (
                half.side_vertex(column, row),
                half.side_vertex(column + 1, row),
                half.side_vertex(column + 1, row + 1),
                half.side_vertex(column, row + 1),
            )
            half.add(keys, Patch(half.radius, None, base, top, UNIT_SQUARE), is_matrix=True)
        half.label(half.side_vertex(column + 1, 0), "end")
    for row in range(1 if half.cut else 0, len(heights)):
        half.label(half.side_vertex(len(radii) - 1, row), "lateral")


def _add_lateral_rings(
    half: HalfCell,
    column: int,
    base: tuple[tuple[float, float], tuple[float, float]],
    top: tuple[tuple[float, float], tuple[float, float]],
) -> None:
    """The last block of the first row, refined toward the rim of the end plane."""
    breaks = [0.0, *half.corner_breaks, 1.0]
    last = len(breaks) - 1

    def vertex(k: int, m: int) -> Key:
        if last in (k, m):
            return half.side_vertex(column + (k != last), int(m == last))
        if (k, m) == (0, 0):
            return half.side_vertex(column + 1, 0)
        return (half.side, "rim ring", k, m)

    for ring in corner_rings(breaks):
        corners = np.array([[1 - breaks[k], breaks[m]] for k, m in ring])
        patch = Patch(half.radius, None, base, top, corners)
        half.add(tuple(vertex(k, m) for k, m in ring), patch, is_matrix=True)
    for k in range(1, last):
        half.label(vertex(k, 0), "end")
        half.label(vertex(0, k), "lateral")


def _add_layers(half: HalfCell) -> None:
    """Straight layers between the level plane and mid-gap."""
    radii = half.inner_columns + half.outer_columns
    heights = half.heights
    last = len(radii) - 1
    for layer in range(len(heights) - 1):
        low, high = heights[layer], heights[layer + 1]
        for column in range(last):
            base = ((radii[column], low), (radii[column + 1], low))
            top = ((radii[column], high), (radii[column + 1], high))
            keys = (
                half.row_vertex(layer, column),
                half.row_vertex(layer, column + 1),
                half.row_vertex(layer + 1, column + 1),
                half.row_vertex(layer + 1, column),
            )
            half.add(keys, Patch(half.radius, None, base, top, UNIT_SQUARE), is_matrix=True)
    for layer in range(len(heights)):
        half.label(half.row_vertex(layer, 0), "axis")
        half.label(half.row_vertex(layer, last), "lateral")
    for column in range(last + 1):
        half.label(half.row_vertex(len(heights) - 1, column), "middle")
