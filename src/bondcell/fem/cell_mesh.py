"""The structured mesh of a bond cell: both halves glued at mid-gap, or one half of a symmetric pair."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from skfem import MeshQuad

from bondcell.cell import FloatArray
from bondcell.fem.curved_mapping import CurvedMapping, lobatto_points
from bondcell.fem.half_cell import (
    MATRIX,
    MIDDLE_ANGLE,
    PARTICLE_I,
    PARTICLE_J,
    HalfCell,
    Key,
    Patch,
    graded_breaks,
    side_radius,
)
from bondcell.fem.orientation import orient


@dataclass(frozen=True)
class Geometry:
    """Dimensions of one cell [m]."""

    radius_i: float
    radius_j: float
    gap: float
    cylinder_radius: float

    @property
    def is_mirrored(self) -> bool:
        """Whether both particles are of one size, so that mid-gap can be a symmetry plane."""
        return self.radius_i == self.radius_j


@dataclass(frozen=True)
class Grading:
    """How the mesh shrinks toward the film and the foot.

    Parameters
    ----------
    growth
        Ratio of neighbouring element sizes.
    foot
        Where the cusp between sphere and lateral surface is cut, in radii (or where grading toward
        the foot stops when the cylinder is wider than the sphere).
    foot_growth
        Ratio of neighbouring sizes toward the foot.
    """

    growth: float = 3.0
    foot: float = 1e-3
    foot_growth: float = 3.0


@dataclass(frozen=True)
class CellMesh:
    """Curved quadrilaterals with their regions and boundaries.

    The axial coordinate is measured from mid-gap: end plane i lies at ``-(R_i + L_g/2)``.

    Parameters
    ----------
    topology
        Vertices and elements; edges are directed alike in both owners.
    patches, flips
        Geometry of each element, and +1 or -1 for the direction of its local axis.
    offset
        Half the gap [m].
    region
        `MATRIX`, `PARTICLE_I` or `PARTICLE_J` of each element.
    labels
        Names of boundaries -> vertices on them: ``axis``, ``end_i``, ``end_j``, ``lateral``,
        ``middle`` (only where the mesh ends there).
    """

    topology: MeshQuad
    patches: tuple[Patch, ...]
    flips: FloatArray
    offset: float
    region: NDArray[np.int8]
    labels: dict[str, NDArray[np.int64]]

    def mapping(self, order: int) -> CurvedMapping:
        """Geometry interpolated at order ``order``."""
        points = lobatto_points(order)
        along, across = points[:, None], points[None, :]
        nodes = np.empty((2, len(self.patches), order + 1, order + 1))
        for row, (patch, flip) in enumerate(zip(self.patches, self.flips, strict=True)):
            r, y = patch.points(along, across)
            nodes[:, row] = r, flip * (self.offset - y)
        return CurvedMapping(self.topology, nodes)

    @cached_property
    def boundary(self) -> dict[str, NDArray[np.int64]]:
        """Boundary edges by name."""
        facets = self.topology.boundary_facets()
        ends = self.topology.facets[:, facets]
        return {
            name: facets[np.isin(ends, vertices).all(axis=0)]
            for name, vertices in self.labels.items()
        }


def build_cell_mesh(geometry: Geometry, grading: Grading, half: bool) -> CellMesh:
    """Mesh the meridional section.

    Parameters
    ----------
    geometry
        Dimensions of the cell.
    grading
        How the mesh shrinks toward film and foot.
    half
        Only particle i's half up to mid-gap: for a symmetric pair.
    """
    radii = [geometry.radius_i] if half else [geometry.radius_i, geometry.radius_j]
    sides = [side_radius(radius, geometry.cylinder_radius) for radius in radii]
    if max(sides) <= 1.25 * min(sides):
        sides = [max(sides)] * len(sides)
    halves = [
        _half_cell(name, radius, side, geometry, grading)
        for name, radius, side in zip("ij", radii, sides, strict=False)
    ]
    columns = _columns(halves, [0.0, *sides, geometry.cylinder_radius])
    for part in halves:
        part.build(columns)
    return _glue(halves, geometry.gap / 2)


def _half_cell(
    side: str, radius: float, side_end: float, geometry: Geometry, grading: Grading
) -> HalfCell:
    curvature = 1 / geometry.radius_i + 1 / geometry.radius_j
    film = np.sqrt(2 * geometry.gap / curvature) / radius
    annulus = geometry.cylinder_radius - radius
    cut = annulus == 0
    # Narrow annuli need grading like the film; below the cut they are resolved no further.
    foot = max(grading.foot, np.sqrt(2 * annulus / radius))
    return HalfCell(
        side=side,
        radius=radius,
        reach=geometry.gap / 2,
        side_radius=side_end,
        cylinder_radius=geometry.cylinder_radius,
        tip_breaks=graded_breaks(float(film) / MIDDLE_ANGLE, grading.growth),
        foot_breaks=graded_breaks(float(foot) / (np.pi / 2 - MIDDLE_ANGLE), grading.foot_growth),
        cut=cut,
        growth=grading.growth,
    )


def _columns(halves: list[HalfCell], needed: list[float]) -> list[float]:
    """Radii of the columns at mid-gap: the needed ones, and wanted ones that crowd no other."""
    columns = sorted(set(needed))
    for r in sorted(radius for part in halves for radius in part.wanted_columns()):
        place = int(np.searchsorted(columns, r))
        left, right = columns[place - 1], columns[place]
        # The nearest wider column decides what is crowded: sizes grow away from the axis.
        if right - r > 0.2 * (r - left) and r - left > 0.4 * left:
            columns.insert(place, r)
    return columns


def _glue(halves: list[HalfCell], offset: float) -> CellMesh:
    number: dict[Key, int] = {}
    quads, patches, flips, regions = [], [], [], []
    for part in halves:
        for keys, patch, region in part.elements:
            quads.append([number.setdefault(key, len(number)) for key in keys])
            patches.append(patch)
            flips.append(-1.0 if part.side == "i" else 1.0)
            regions.append(region)
    given = np.array(quads)
    oriented = orient(given)
    turned = tuple(
        _reordered(patch, before, after)
        for patch, before, after in zip(patches, given, oriented, strict=True)
    )
    positions = np.empty((2, len(number)))
    for quad, patch, flip in zip(oriented, turned, flips, strict=True):
        r, y = patch.points(np.array([0.0, 1, 1, 0]), np.array([0.0, 0, 1, 1]))
        positions[:, quad] = r, flip * (offset - y)
    topology = MeshQuad(positions, np.ascontiguousarray(oriented.T), sort_t=False)
    labels: dict[str, list[int]] = {}
    for part in halves:
        for key, names in part.labels.items():
            for name in names:
                name = f"end_{part.side}" if name == "end" else name
                labels.setdefault(name, []).append(number[key])
    return CellMesh(
        topology=topology,
        patches=turned,
        flips=np.array(flips),
        offset=offset,
        region=np.array(regions, dtype=np.int8),
        labels={name: np.unique(vertices) for name, vertices in labels.items()},
    )


def _reordered(patch: Patch, before: NDArray[np.int64], after: NDArray[np.int64]) -> Patch:
    position = [int(np.flatnonzero(before == vertex)[0]) for vertex in after]
    return Patch(patch.radius, patch.angles, patch.base, patch.top, patch.corners[position])
