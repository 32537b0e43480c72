"""The same mesh with functions of a higher order, curved as exactly as they allow."""

from __future__ import annotations

import numpy as np
from scipy.sparse import csr_array

from bondcell.cell import FloatArray
from bondcell.errors import InputError, Violation
from bondcell.fem.blocks import IndexArray
from bondcell.lattice.packing import Packing
from bondcell.solid.elements import EDGES, FACES, ORDERS, lattice_of, reference_nodes, shape_values
from bondcell.solid.tets import MATRIX, Tets, check_orientation


def raise_order(mesh: Tets, order: int, packing: Packing) -> Tets:
    """Third or fourth-order tetrahedra in the place of second-order ones.

    Parameters
    ----------
    mesh
        Second-order tetrahedra.
    order
        One of `bondcell.solid.elements.ORDERS`.
    packing
        Its spheres.

    Raises
    ------
    InputError
        The order is not offered.
    BondcellError
        An element is turned inside out.

    Notes
    -----
    Inside, nodes lie where the second-order element puts them; those between a particle and the
    matrix are moved onto the sphere. With the corners of each element in rising order, two elements
    count the nodes on their common edge or face alike.
    """
    if order not in ORDERS:
        raise InputError([Violation("order", order, f"one of {ORDERS}")])
    if order == mesh.order:
        return mesh
    own = _sorted_corners(mesh)
    nodes = _numbered(own[:, :4], mesh.corners, order)
    points = np.empty((int(nodes.max()) + 1, 3))
    points[nodes] = shape_values(reference_nodes(order)) @ mesh.points[own]
    linear = _linear(nodes, mesh.corners, len(points), order)
    raised = Tets(
        _on_spheres(points, nodes, mesh, packing), nodes, mesh.material, mesh.corners, linear
    )
    check_orientation(raised)
    return raised


def second_order_part(mesh: Tets, field: FloatArray) -> tuple[Tets, FloatArray]:
    """The second-order tetrahedra at whose nodes a field of any order is looked at.

    Parameters
    ----------
    mesh
        Tetrahedra of any order.
    field
        Values at their nodes, shape (nodes, ...).
    """
    if mesh.order == 2:
        return mesh, field
    values = shape_values(reference_nodes(2), mesh.order)
    nodes = _numbered(mesh.nodes[:, :4], mesh.corners, 2)
    points = np.empty((int(nodes.max()) + 1, 3))
    points[nodes] = values @ mesh.points[mesh.nodes]
    result = np.empty((len(points), *field.shape[1:]))
    result[nodes] = np.einsum("an,en...->ea...", values, field[mesh.nodes])
    linear = _linear(nodes, mesh.corners, len(points), 2)
    return Tets(points, nodes, mesh.material, mesh.corners, linear), result


def _sorted_corners(mesh: Tets) -> IndexArray:
    """Nodes of the second-order elements with their corners in rising order."""
    corners = mesh.nodes[:, :4]
    place = np.argsort(corners, axis=1)
    edge = np.zeros((4, 4), dtype=np.int64)
    edge[EDGES[:, 0], EDGES[:, 1]] = edge[EDGES[:, 1], EDGES[:, 0]] = np.arange(6)
    middles = 4 + edge[place[:, EDGES[:, 0]], place[:, EDGES[:, 1]]]
    return np.take_along_axis(mesh.nodes, np.concatenate([place, middles], axis=1), axis=1)


def _numbered(corners: IndexArray, count: int, order: int) -> IndexArray:
    """Numbers of all nodes: corners, then those of edges, of faces, of the inside."""
    parts, start, elements = [corners], count, len(corners)
    for groups in (EDGES, FACES, np.arange(4)[np.newaxis]):
        used = (lattice_of(order) > 0).sum(axis=1) == groups.shape[1]
        each = int(used.sum()) // len(groups)
        own = corners[:, groups].reshape(-1, groups.shape[1])
        _, number = np.unique(own, axis=0, return_inverse=True)
        first = start + each * number.reshape(elements, -1, 1)
        parts.append((first + np.arange(each)).reshape(elements, -1))
        start += each * (int(number.max()) + 1)
    return np.concatenate(parts, axis=1)


def _linear(nodes: IndexArray, corners: int, count: int, order: int) -> csr_array:
    """Values of the first-order functions at the nodes that are no corners."""
    first = np.full(count, -1)
    first[nodes.ravel()[::-1]] = np.arange(nodes.size)[::-1]
    element, local = np.divmod(first[corners:], nodes.shape[1])
    shares = lattice_of(order)[local] / order
    row, corner = np.nonzero(shares)
    at = (row, nodes[element[row], corner])
    return csr_array((shares[row, corner], at), shape=(count - corners, corners))


def _on_spheres(points: FloatArray, nodes: IndexArray, mesh: Tets, packing: Packing) -> FloatArray:
    """Move what a particle shares with the matrix onto its sphere."""
    outside = np.zeros(len(points), dtype=bool)
    outside[nodes[mesh.material == MATRIX]] = True
    for particle in range(packing.count):
        own = np.unique(nodes[mesh.material == particle])
        shared = own[outside[own]]
        arm = points[shared] - packing.centres[particle]
        arm *= packing.radii[particle] / np.linalg.norm(arm, axis=1, keepdims=True)
        points[shared] = packing.centres[particle] + arm
    return points
