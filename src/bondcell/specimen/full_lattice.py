"""The specimen's fullest lattice: pockets inside, other bonds along the border."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from bondcell.cell import FloatArray
from bondcell.fem.blocks import IndexArray
from bondcell.lattice import specimen_geometry as given
from bondcell.lattice.bonds import Bonds
from bondcell.lattice.packing import packing
from bondcell.lattice.pockets import Pockets, pockets, triangles
from bondcell.lattice.walls import Wall, wall
from bondcell.solid.layer_cells import (
    BorderEnergies,
    Layer,
    TriangleEnergies,
    border_energies,
    triangle_energies,
)
from bondcell.solid.layer_springs import PairSprings, border_bond, pocket_springs
from bondcell.solid.stiffness import Elastic
from bondcell.solid.wall_margin import wall_stiffness
from bondcell.specimen.bonds import Material

FARTHEST = 2.5 * given.RADIUS
"""A border farther from a row than this is taken to be here [m]: half a per cent of a bond."""

LENGTH = 2 * given.RADIUS + given.GAP
"""Distance of neighbours' centres [m]."""


FINEST_MARGIN = 1.5
"""Element size relative to the gap in the margin beside a wall, where no gap is looked into."""

RIGHT, BOTTOM = 1, 2
"""Sides of the box, counted as in ``box.ravel()``."""

MIRRORED = {4: 0, 10: 5}
"""Spheres next to the right side and their images next to the left one."""


@dataclass(frozen=True)
class LayerEnergies:
    """Energies of the cells of the specimen's layer of spheres.

    Parameters
    ----------
    triangle
        Of a triangle of neighbours.
    borders
        Of a last row, by the distance from it to the border [m].
    material, per_gap
        Elastic constants and element size of the cells.
    """

    triangle: TriangleEnergies
    borders: Mapping[float, BorderEnergies]
    material: Material
    per_gap: float

    @cached_property
    def walls(self) -> tuple[Wall, Wall]:
        """What a held side does to the spheres next to it, right and left."""
        packed, whole = given.specimen_packing(), np.array(given.BOX)
        near = np.array([4, 10, 16, 17])
        box = np.array([[packed.centres[4, 0], whole[0, 1]], whole[1], [0.0, whole[2, 1]]])
        part = packing(packed.centres[near], packed.radii[near], box)
        matrix = Elastic(self.material.young_matrix, self.material.poisson_matrix)
        size = max(self.per_gap, FINEST_MARGIN)
        stiffness, moving = wall_stiffness(part, matrix, RIGHT, [BOTTOM], size)
        mirrored = np.tile([-1.0, 1.0, -1.0], moving.size)
        right, left = near[moving], np.array([MIRRORED[k] for k in near[moving].tolist()])
        return wall(right, stiffness), wall(left, stiffness * mirrored * mirrored[:, np.newaxis])


def layer_energies(material: Material, per_gap: float) -> LayerEnergies:
    """Solve the cells on one mesh each."""
    matrix = Elastic(material.young_matrix, material.poisson_matrix)
    depth = given.BOX[2][1] - given.BOX[2][0]
    layer = Layer(given.RADIUS, given.GAP, depth, matrix)
    packed = given.specimen_packing()
    pairs = packed.neighbours(2 * given.GAP)
    _, _, covers = borders(packed.centres[:, :2], pairs)
    return LayerEnergies(
        triangle_energies(layer, per_gap),
        {cover: border_energies(layer, cover, per_gap=per_gap) for cover in set(covers.tolist())},
        material,
        per_gap,
    )


def borders(points: FloatArray, pairs: IndexArray) -> tuple[IndexArray, FloatArray, FloatArray]:
    """Bonds with matrix and then a free border on one side.

    Parameters
    ----------
    points, pairs
        Centres (x, y) [m] and bonds.

    Returns
    -------
    tuple
        Numbers of these bonds; 1 where that side is to the left of the bond, -1 to the right; the
        distance to the border, across the bond from its middle, at most `FARTHEST` [m].
    """
    corners = triangles(pairs, len(points))
    found = []
    for number, (i, j) in enumerate(pairs.tolist()):
        beside = corners[((corners == i) | (corners == j)).sum(axis=1) == 2]
        if len(beside) != 1:
            continue
        third = points[np.setdiff1d(beside[0], [i, j])[0]]
        across = np.array([points[i, 1] - points[j, 1], points[j, 0] - points[i, 0]]) / LENGTH
        side = -np.sign((third - points[i]) @ across)
        cover = _distance((points[i] + points[j]) / 2, side * across)
        # A border nearer than the spheres' surface is the wall that they are cut by.
        if cover > given.RADIUS:
            found.append((number, side, round(min(cover, FARTHEST), 9)))
    numbers, sides, covers = (np.array(column) for column in zip(*found, strict=True))
    return numbers, sides, covers


def _distance(start: FloatArray, way: FloatArray) -> float:
    """From a point in the box to its sides along a direction [m]."""
    sides = np.array(given.BOX[:2])
    with np.errstate(divide="ignore"):
        reach = (np.where(way > 0, sides[:, 1], sides[:, 0]) - start) / way
    return float(np.where(np.abs(way) > 1e-12, reach, np.inf).min())


def full_springs(
    own: Bonds, points: FloatArray, springs: Mapping[str, float], layer: LayerEnergies
) -> tuple[Bonds, Pockets]:
    """Bonds and pockets of the fullest lattice.

    Parameters
    ----------
    own
        Bonds as the bond cell gives them, all alike.
    points
        Centres (x, y) [m].
    springs
        Of one of those bonds.
    layer
        The cells' energies.
    """
    pairs = np.stack([own.first, own.second], axis=1)
    bond = PairSprings(springs["normal"], springs["shear"], springs["bending"])
    pocket = pocket_springs(layer.triangle, bond, LENGTH)
    names = ("normal", "shear", "bending", "offset")
    values = {name: getattr(own, name).copy() for name in names}
    for number, side, cover in zip(*borders(points, pairs), strict=True):
        at_border = border_bond(layer.borders[float(cover)], bond, pocket, LENGTH)
        for name in names:
            values[name][int(number)] = getattr(at_border, name) * (side if name == "offset" else 1)
    return replace(own, **values), pockets(triangles(pairs, len(points)), **pocket)
