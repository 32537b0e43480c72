"""Elements of a hemisphere: an O-grid whose outer blocks shrink toward tip and foot."""

from __future__ import annotations

import numpy as np

from bondcell.fem.half_cell import MIDDLE_ANGLE, HalfCell, Key
from bondcell.fem.patch import UNIT_SQUARE, Patch, Point, corner_rings


def add_particle(half: HalfCell) -> None:
    """Add the hemisphere's elements and boundary names to ``half``."""
    radius = half.radius
    on_axis, on_plane = (0.0, -0.55 * radius), (0.45 * radius, -radius)
    inner = (0.4 * radius, -0.6 * radius)
    _add_block(half, "tip", half.tip, (0.0, MIDDLE_ANGLE), (on_axis, inner))
    _add_block(half, "foot", half.foot, (np.pi / 2, MIDDLE_ANGLE), (on_plane, inner))
    centre = (half.side, "centre")
    keys = (
        centre,
        _vertex(half, "foot", 0, len(half.foot) - 1),
        (half.side, "inner"),
        _vertex(half, "tip", 0, len(half.tip) - 1),
    )
    patch = Patch(radius, None, ((0.0, -radius), on_plane), (on_axis, inner), UNIT_SQUARE)
    half.add(keys, patch, is_matrix=False)
    half.label(centre, "axis")
    half.label(centre, "end")
    for m in range(len(half.tip)):
        half.label(_vertex(half, "tip", 0, m), "axis")
    for m in range(len(half.foot)):
        half.label(_vertex(half, "foot", 0, m), "end")


def _vertex(half: HalfCell, block: str, k: int, m: int) -> Key:
    """Vertex at break ``k`` along the arc and break ``m`` in depth."""
    last = len(half.tip if block == "tip" else half.foot) - 1
    if m == 0:
        return half.arc(block, k)
    if k == m == last:
        return (half.side, "inner")
    return (half.side, block, k, m)


def _add_block(
    half: HalfCell, block: str, breaks: list[float], angles: Point, top: tuple[Point, Point]
) -> None:
    for ring in corner_rings(breaks):
        keys = tuple(_vertex(half, block, k, m) for k, m in ring)
        corners = np.array([[breaks[k], breaks[m]] for k, m in ring])
        half.add(keys, Patch(half.radius, angles, None, top, corners), is_matrix=False)
