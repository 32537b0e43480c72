"""Element sizes of a box with spheres: short in the gaps, and what the mesh will cost."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bondcell.cell import FloatArray
from bondcell.lattice.packing import Packing

WALL = 1.0
"""Elements between a sphere and a wall are at most this many times as long as it is far."""

POINTS = 4_000_000
"""Most points of the grid that carries the size field."""

_GRID_PER_GAP = 2.5
_TETRAHEDRON = 0.118
"""Volume of a regular tetrahedron of unit edge: gmsh's are about as large as that."""

_SPREAD = 0.9


@dataclass(frozen=True)
class SizeField:
    """Wanted element size on a regular grid.

    Parameters
    ----------
    origin, spacing
        First point and steps of the grid [m], shape (3,).
    sizes
        Shape (nx, ny, nz) [m].
    elements
        Tetrahedra to be expected.
    """

    origin: FloatArray
    spacing: FloatArray
    sizes: FloatArray
    elements: int


def size_field(packing: Packing, per_gap: float, largest: float) -> SizeField:
    """Choose element sizes for all of a packing's box.

    Parameters
    ----------
    packing
        Spheres in a bounded box.
    per_gap
        Element size relative to the local gap.
    largest
        Largest element [m].

    Notes
    -----
    ``h = min(largest, per_gap (d_1 + d_2), WALL (d_1 + d_w))`` with ``d_1 <= d_2`` the distances to
    the two nearest surfaces of spheres: in a gap their sum is its width. ``d_w`` is the distance to
    a wall that does not cut the sphere.
    """
    box = packing.box
    extent = box[:, 1] - box[:, 0]
    pairs = packing.neighbours(float(2 * packing.radii.max()))
    narrow = float(packing.gaps(pairs).min()) if len(pairs) else float(extent.min())
    step = max(narrow / _GRID_PER_GAP, float((extent.prod() / POINTS) ** (1 / 3)))
    counts = np.maximum(2, np.ceil(extent / step).astype(int) + 1)
    axes = [
        np.linspace(low, high, int(count))
        for (low, high), count in zip(box.tolist(), counts, strict=True)
    ]
    sizes = _sizes(packing, axes, per_gap, largest)
    spacing = extent / (counts - 1)
    ends = [np.r_[0.5, np.ones(count - 2), 0.5] for count in counts]
    weight = np.einsum("x,y,z->xyz", *ends)
    volume = float((weight / sizes**3).sum() * spacing.prod())
    return SizeField(box[:, 0].copy(), spacing, sizes, int(_SPREAD * volume / _TETRAHEDRON))


def _sizes(packing: Packing, axes: list[FloatArray], per_gap: float, largest: float) -> FloatArray:
    """The formula of `size_field` on a grid; each sphere counts as far as it shortens elements."""
    shape = tuple(axis.size for axis in axes)
    nearest, second = np.full(shape, np.inf), np.full(shape, np.inf)
    by_wall = np.full(shape, largest)
    reach = largest / min(per_gap, WALL)
    cut = np.stack([packing.on_wall(wall) for wall in range(6)], axis=1)
    for centre, radius, own_cut in zip(packing.centres, packing.radii, cut, strict=True):
        ends = [
            np.searchsorted(axis, [x - radius - reach, x + radius + reach])
            for axis, x in zip(axes, centre, strict=True)
        ]
        window = tuple(slice(*end) for end in ends)
        x, y, z = (axis[part] for axis, part in zip(axes, window, strict=True))
        arms = [(own - c) ** 2 for own, c in zip((x, y, z), centre, strict=True)]
        square = arms[0][:, np.newaxis, np.newaxis] + arms[1][:, np.newaxis] + arms[2]
        distance = np.abs(np.sqrt(square) - radius)
        second[window] = np.minimum(second[window], np.maximum(distance, nearest[window]))
        nearest[window] = np.minimum(nearest[window], distance)
        for wall in np.flatnonzero(~own_cut).tolist():
            axis, side = divmod(wall, 2)
            gap = np.abs((x, y, z)[axis] - packing.box[axis, side])
            if gap.size and gap.min() < reach:
                shaped = gap.reshape([-1 if k == axis else 1 for k in range(3)])
                by_wall[window] = np.minimum(by_wall[window], WALL * (distance + shaped))
    return np.minimum(by_wall, per_gap * (nearest + second))
