"""Curved tetrahedra that follow spheres."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from bondcell.cell import FloatArray
from bondcell.errors import BondcellError
from bondcell.fem.blocks import IndexArray
from bondcell.lattice.packing import Packing
from bondcell.solid.elements import (
    EDGES,
    FACES,
    jacobians,
    order_of,
    reference_nodes,
    shape_gradients,
)

MATRIX = -1
"""Material of the elements that are in no particle; others carry the particle's number."""

_ON_SPHERE = 1e-6
_STRAIGHT = 1e-13

SMALLEST_JACOBIAN = 1e-3
"""Least Jacobian determinant of a curved tetrahedron at a node, over the straight one's."""


@dataclass(frozen=True)
class Tets:
    """Tetrahedra of one order; the corners of all are the first nodes.

    Parameters
    ----------
    points
        Nodes [m], shape (nodes, 3).
    nodes
        Nodes of each element as in `bondcell.solid.elements.lattice_of`, shape (elements, nodes of
        an element).
    material
        `MATRIX` or number of the particle, shape (elements,).
    corners
        How many of the nodes are corners.
    linear
        Values of the first-order functions at all other nodes, shape (nodes - corners, corners).
    """

    points: FloatArray
    nodes: IndexArray
    material: IndexArray
    corners: int
    linear: csr_array

    @property
    def order(self) -> int:
        """Order of the functions that carry both the shape and the displacements."""
        return order_of(self.nodes.shape[1])

    @cached_property
    def is_curved(self) -> NDArray[np.bool_]:
        """Elements whose nodes are not where they were on straight edges, shape (elements,)."""
        straight = self.linear @ self.points[: self.corners]
        size = float(np.ptp(self.points, axis=0).max())
        bent = (np.abs(self.points[self.corners :] - straight) > _STRAIGHT * size).any(axis=1)
        return np.asarray(bent[self.nodes[:, 4:] - self.corners].any(axis=1))

    def nodes_of(self, material: int) -> IndexArray:
        """Nodes of the closed region of one material."""
        return np.unique(self.nodes[self.material == material])

    def part(self, chosen: NDArray[np.bool_]) -> tuple[Tets, IndexArray]:
        """Mesh of some of the elements, and the numbers of its nodes in this one."""
        used = np.unique(self.nodes[chosen])
        number = np.full(len(self.points), -1)
        number[used] = np.arange(used.size)
        corners = int(np.searchsorted(used, self.corners))
        linear = csr_array(self.linear[used[corners:] - self.corners][:, used[:corners]])
        nodes = number[self.nodes[chosen]]
        return Tets(self.points[used], nodes, self.material[chosen], corners, linear), used

    def on_plane(self, axis: int, position: float) -> NDArray[np.bool_]:
        """Nodes on a plane across an axis, shape (nodes,)."""
        extent = float(np.ptp(self.points[:, axis]))
        return np.asarray(np.abs(self.points[:, axis] - position) <= 1e-9 * extent)


def second_order(
    points: FloatArray, corners: IndexArray, material: IndexArray, packing: Packing
) -> Tets:
    """Add mid-nodes, on the spheres where an edge lies in their surface.

    Parameters
    ----------
    points, corners
        Straight tetrahedra: shapes (corners, 3) and (elements, 4).
    material
        `MATRIX` or number of the particle, shape (elements,).
    packing
        The spheres.

    Raises
    ------
    BondcellError
        An element is turned inside out.
    """
    material = _without_dents(points, corners, material, packing)
    mesh = _curved(points, corners, material, packing)
    check_orientation(mesh)
    return mesh


def check_orientation(mesh: Tets) -> None:
    """Refuse elements that their curved sides turn inside out.

    Raises
    ------
    BondcellError
        At a node of an element the Jacobian is below `SMALLEST_JACOBIAN` of the straight one's.
    """
    worst = float(_orientation(mesh).min())
    if worst <= SMALLEST_JACOBIAN:
        raise BondcellError(
            "a tetrahedron is turned inside out by the curvature of a sphere (smallest relative "
            f"Jacobian {worst:.2g}): reduce the size"
        )


def _without_dents(
    points: FloatArray, corners: IndexArray, material: IndexArray, packing: Packing
) -> IndexArray:
    """Give flat tetrahedra of the matrix with all corners on one sphere to its particle.

    Where the surface's triangles dent the ball, such a tetrahedron fills the dent: the sphere
    itself passes outside of it.
    """
    result = material.copy()
    for particle in range(packing.count):
        distance = np.linalg.norm(points - packing.centres[particle], axis=1)
        on = np.abs(distance / packing.radii[particle] - 1) < _ON_SPHERE
        result[(material == MATRIX) & on[corners].all(axis=1)] = particle
    return result


def _curved(
    points: FloatArray, corners: IndexArray, material: IndexArray, packing: Packing
) -> Tets:
    """Second-order tetrahedra, whatever their orientation."""
    volume = _volumes(points, corners)
    corners = np.where((volume < 0)[:, np.newaxis], corners[:, [1, 0, 2, 3]], corners)
    edges = np.sort(corners[:, EDGES], axis=2).reshape(-1, 2)
    keys, number = np.unique(edges[:, 0] * len(points) + edges[:, 1], return_inverse=True)
    ends = np.stack(np.divmod(keys, len(points)), axis=1)
    middle = points[ends].mean(axis=1)
    surface = _surface_edges(corners, material, number.reshape(-1, 6), len(points))
    for particle in np.unique(surface[:, 1]).tolist():
        own = surface[surface[:, 1] == particle, 0]
        centre, radius = packing.centres[particle], packing.radii[particle]
        arm = middle[own] - centre
        middle[own] = centre + radius * arm / np.linalg.norm(arm, axis=1, keepdims=True)
    nodes = np.concatenate([corners, len(points) + number.reshape(-1, 6)], axis=1)
    halves = np.full(ends.size, 0.5)
    starts = np.arange(0, ends.size + 1, 2)
    linear = csr_array((halves, ends.ravel(), starts), shape=(len(ends), len(points)))
    return Tets(np.concatenate([points, middle]), nodes, material, len(points), linear)


def _volumes(points: FloatArray, corners: IndexArray) -> FloatArray:
    a, b, c, d = points[corners].transpose(1, 0, 2)
    return np.asarray(np.einsum("ei,ei->e", np.cross(b - a, c - a), d - a) / 6)


def _surface_edges(
    corners: IndexArray, material: IndexArray, edges: IndexArray, count: int
) -> IndexArray:
    """Edges (and their particle) of the faces between a particle and the matrix."""
    face_edges = np.array([[0, 1, 2], [0, 4, 3], [2, 5, 3], [1, 5, 4]])
    all_faces = np.sort(corners[:, FACES], axis=2).reshape(-1, 3)
    key = (all_faces[:, 0] * count + all_faces[:, 1]) * count + all_faces[:, 2]
    if count**3 > 2**62:
        key = np.unique(all_faces, axis=0, return_inverse=True)[1].ravel()
    order = np.argsort(key, kind="stable")
    twins = np.flatnonzero(key[order[1:]] == key[order[:-1]])
    one, other = order[twins], order[twins + 1]
    own, across = material[one // 4], material[other // 4]
    between = np.flatnonzero((own == MATRIX) != (across == MATRIX))
    face = one[between]
    particle = np.maximum(own[between], across[between])
    found = edges[face // 4][np.arange(face.size)[:, None], face_edges[face % 4]]
    pairs = np.stack([found.ravel(), np.repeat(particle, 3)], axis=1)
    return np.unique(pairs, axis=0)


def _orientation(mesh: Tets) -> FloatArray:
    """Smallest Jacobian determinant at a node over the straight one's, shape (elements,)."""
    straight = 6 * _volumes(mesh.points, mesh.nodes[:, :4])
    result = np.where(straight != 0, 1.0, -1.0)
    curved = np.flatnonzero(mesh.is_curved & (straight != 0))
    gradients = shape_gradients(reference_nodes(mesh.order), mesh.order)
    determinant = np.linalg.det(jacobians(mesh.points[mesh.nodes[curved]], gradients))
    result[curved] = (determinant / straight[curved, np.newaxis]).min(axis=1)
    return result
