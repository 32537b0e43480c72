"""The structured mesh of a bond cell: two halves glued at mid-gap, or half of a symmetric pair."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from skfem import MeshQuad

from bondcell.cell import FloatArray
from bondcell.fem.breaks import graded_breaks
from bondcell.fem.curved_mapping import CurvedMapping, lobatto_points
from bondcell.fem.half_cell import FOOT_ANGLE, MATRIX, MIDDLE_ANGLE, NEAR_FIELD, HalfCell, Key
from bondcell.fem.half_matrix import add_matrix
from bondcell.fem.half_particle import add_particle
from bondcell.fem.orientation import orient
from bondcell.fem.patch import Patch, patch_points

TIP = 1.3
"""First arc segment from the tip, over the radius where the film is twice as thick as its gap."""


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
    largest
        Largest angle of an element along the arc [rad].
    foot
        Where the cusp between sphere and lateral surface is cut, in radii (or where grading toward
        the foot stops when the cylinder is wider than the sphere).
    foot_growth
        Ratio of neighbouring sizes toward the foot.
    corner
        Where refinement toward singular corners of held end planes stops, in radii; 0 for none.
    corner_growth
        Ratio of neighbouring sizes toward such corners.
    tallest
        Height of the block at a refined rim, over its width at most.
    """

    growth: float = 4.0
    largest: float = 0.4
    foot: float = 2e-3
    foot_growth: float = 6.0
    corner: float = 0.0
    corner_growth: float = 6.0
    tallest: float = 2.0


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
    end_height
        Axial coordinate of end plane j [m].
    region
        `half_cell.MATRIX`, `PARTICLE_I` or `PARTICLE_J` of each element, ascending.
    carried
        Particle j and the thin elements beside its foot, which hardly strain when j moves.
    labels
        Names of boundaries -> vertices on them: ``axis``, ``end_i``, ``end_j``, ``lateral``,
        ``middle`` (only where the mesh ends there).
    """

    topology: MeshQuad
    patches: tuple[Patch, ...]
    flips: FloatArray
    offset: float
    end_height: float
    region: NDArray[np.int8]
    carried: NDArray[np.bool_]
    labels: dict[str, NDArray[np.int64]]

    def elements(self, region: int) -> slice:
        """The elements of a region, which follow each other."""
        first, last = np.searchsorted(self.region, [region, region + 1])
        return slice(int(first), int(last))

    def mapping(self, order: int) -> CurvedMapping:
        """Geometry interpolated at order ``order``."""
        if order not in self._mappings:
            points = lobatto_points(order)
            nodes = patch_points(self.patches, points[:, None], points[None, :])
            nodes[1] = self.flips[:, None, None] * (self.offset - nodes[1])
            self._mappings[order] = CurvedMapping(self.topology, nodes)
        return self._mappings[order]

    @cached_property
    def _mappings(self) -> dict[int, CurvedMapping]:
        return {}

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
    sides = _side_radii(radii, geometry.cylinder_radius, grading)
    halves = [
        _half_cell(name, radius, side, geometry.cylinder_radius - max(sides), geometry, grading)
        for name, radius, side in zip("ij", radii, sides, strict=False)
    ]
    rim = _rim_columns(sides, geometry.cylinder_radius, grading)
    columns = _columns(halves, [0.0, *sides, *rim, geometry.cylinder_radius])
    for part in halves:
        part.set_columns(columns)
        add_particle(part)
        add_matrix(part)
    return _glue(halves, geometry)


def _side_radii(radii: list[float], cylinder_radius: float, grading: Grading) -> list[float]:
    """Where the ruled elements beside each sphere end: at the lateral surface unless it is far.

    A refined rim needs a block of its own. Two sides that nearly coincide become one.
    """
    sides = []
    for radius in radii:
        annulus = cylinder_radius - radius
        near = NEAR_FIELD * radius
        if annulus > 1.5 * near:
            sides.append(radius + near)
        elif grading.corner and annulus > 0.02 * radius:
            sides.append(radius + annulus / 2)
        else:
            sides.append(cylinder_radius)
    if cylinder_radius not in sides and max(sides) <= 1.25 * min(sides):
        sides = [max(sides)] * len(sides)
    return sides


def _rim_columns(sides: list[float], cylinder_radius: float, grading: Grading) -> list[float]:
    """Columns whose distance from a refined rim grows, where blocks stand beside a sphere's own.

    What the rim's corner disturbs reaches as far as the matrix is thick there, not only as far as
    its own narrow block.
    """
    width = cylinder_radius - max(sides)
    if not grading.corner or width <= 0:
        return []
    room = (cylinder_radius - min(sides)) / (1.5 * width)
    count = int(np.log(room) / np.log(grading.corner_growth)) if room > 1 else 0
    return [cylinder_radius - width * grading.corner_growth**k for k in range(1, count + 1)]


def _half_cell(
    name: str,
    radius: float,
    side_radius: float,
    rim: float,
    geometry: Geometry,
    grading: Grading,
) -> HalfCell:
    curvature = 1 / geometry.radius_i + 1 / geometry.radius_j
    film = float(np.sqrt(2 * geometry.gap / curvature)) / radius
    annulus = geometry.cylinder_radius - radius
    # Narrow annuli need grading like the film; below the cut they are resolved no further.
    foot = max(grading.foot, float(np.sqrt(2 * annulus / radius)))
    if grading.corner and rim > 0:
        # The block at the refined rim is that wide; what ends there dies out as far from it.
        foot = min(foot, grading.tallest * rim / radius)
    foot_breaks = graded_breaks(foot, FOOT_ANGLE, grading.foot_growth, grading.largest)
    tip_breaks = graded_breaks(TIP * film, MIDDLE_ANGLE, grading.growth, grading.largest)
    corner_breaks: list[float] = []
    if grading.corner:
        scale = grading.corner / foot_breaks[0]
        corner_breaks = graded_breaks(scale, 1.0, grading.corner_growth)[:-1]
    return HalfCell(
        side=name,
        radius=radius,
        reach=geometry.gap / 2,
        side_radius=side_radius,
        cylinder_radius=geometry.cylinder_radius,
        tip_breaks=[angle / MIDDLE_ANGLE for angle in tip_breaks],
        foot_breaks=[angle / FOOT_ANGLE for angle in foot_breaks],
        corner_breaks=corner_breaks,
        cut=annulus == 0,
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


def _glue(halves: list[HalfCell], geometry: Geometry) -> CellMesh:
    offset = geometry.gap / 2
    number: dict[Key, int] = {}
    quads, patches, flips, regions, carried = [], [], [], [], []
    placed = [(part, *element) for part in halves for element in enumerate(part.elements)]
    for part, place, (keys, patch, region) in sorted(placed, key=lambda entry: entry[2][2]):
        beside = place in part.beside_foot
        carried.append(part.side == "j" and (beside or region != MATRIX))
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
    r, y = patch_points(turned, np.array([0.0, 1, 1, 0]), np.array([0.0, 0, 1, 1]))
    positions[:, oriented] = r, np.array(flips)[:, None] * (offset - y)
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
        end_height=offset + geometry.radius_j,
        region=np.array(regions, dtype=np.int8),
        carried=np.array(carried),
        labels={name: np.unique(vertices) for name, vertices in labels.items()},
    )


def _reordered(patch: Patch, before: NDArray[np.int64], after: NDArray[np.int64]) -> Patch:
    position = [int(np.flatnonzero(before == vertex)[0]) for vertex in after]
    return Patch(patch.radius, patch.angles, patch.base, patch.top, patch.corners[position])
