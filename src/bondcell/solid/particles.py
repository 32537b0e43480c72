"""What a particle does as a whole: its mean motion, and rigid motions of its nodes."""

from __future__ import annotations

import numpy as np

from bondcell.cell import FloatArray
from bondcell.fem.blocks import IndexArray
from bondcell.lattice.packing import Packing
from bondcell.solid.elements import QUADRATURE, jacobians, quadrature, shape_gradients, shape_values
from bondcell.solid.tets import Tets

MOTIONS = ("x", "y", "rotation")
"""Motions in the plane of the specimen: displacements of the centre, rotation about z."""


def rigid_motions(mesh: Tets, packing: Packing, particles: IndexArray) -> FloatArray:
    """Unit motions of rigid particles, shape (3 nodes, 3 particles).

    Column ``3 k + m`` is motion m of `MOTIONS` of the k-th of ``particles``, on the nodes in or on
    its sphere.
    """
    result = np.zeros((len(mesh.points), 3, particles.size, 3))
    for k, particle in enumerate(particles.tolist()):
        nodes = _nodes_in(mesh, packing, particle)
        arm = mesh.points[nodes] - packing.centres[particle]
        result[nodes, 0, k, 0] = result[nodes, 1, k, 1] = 1.0
        result[nodes, 0, k, 2], result[nodes, 1, k, 2] = -arm[:, 1], arm[:, 0]
    return result.reshape(3 * len(mesh.points), -1)


def in_particles(mesh: Tets, packing: Packing) -> IndexArray:
    """Number of the particle in or on which a node lies, -1 for none, shape (nodes,)."""
    result = np.full(len(mesh.points), -1)
    for particle in range(packing.count):
        result[_nodes_in(mesh, packing, particle)] = particle
    return result


def _nodes_in(mesh: Tets, packing: Packing, particle: int) -> IndexArray:
    arm = mesh.points - packing.centres[particle]
    return np.flatnonzero((arm**2).sum(axis=1) <= (packing.radii[particle] * (1 + 1e-6)) ** 2)


def mean_motions(mesh: Tets, packing: Packing) -> FloatArray:
    """Functionals that give each particle's motion, shape (3 nodes, particles, 3).

    Notes
    -----
    The rigid motion next to the displacements, in the mean square over the particle's volume:
    with x the place from the centroid,
    ``rotation = integral of (x u_y - y u_x) / integral of (x^2 + y^2)``, and the displacement of
    the sphere's centre is the mean one, brought there from the centroid by that rotation.
    """
    order = mesh.order
    points, weights = quadrature(QUADRATURE[order][1])
    values, reference = shape_values(points, order), shape_gradients(points, order)
    result = np.zeros((len(mesh.points), 3, packing.count, 3))
    for particle in range(packing.count):
        nodes = mesh.nodes[mesh.material == particle]
        corners = mesh.points[nodes]
        volumes = np.abs(np.linalg.det(jacobians(corners, reference))) * weights
        where = np.einsum("qa,eai->eqi", values, corners)
        total = volumes.sum()
        middle = np.einsum("eq,eqi->i", volumes, where) / total
        arm = where - middle
        inertia = float((volumes * (arm[..., 0] ** 2 + arm[..., 1] ** 2)).sum())
        mean = np.zeros((len(mesh.points), 3))
        for c, density in enumerate((1 / total + 0 * volumes, arm[..., 0], arm[..., 1])):
            share = np.einsum("eq,qa->ea", volumes * density, values)
            np.add.at(mean[:, c], nodes, share)
        turn = np.zeros((len(mesh.points), 3))
        turn[:, 1], turn[:, 0] = mean[:, 1] / inertia, -mean[:, 2] / inertia
        offset = packing.centres[particle] - middle
        result[:, :, particle, 2] = turn
        result[:, 0, particle, 0] = mean[:, 0]
        result[:, 1, particle, 1] = mean[:, 0]
        # The centre moves by the mean displacement plus rotation x offset.
        result[:, :, particle, 0] -= offset[1] * turn
        result[:, :, particle, 1] += offset[0] * turn
    return result.reshape(3 * len(mesh.points), packing.count, 3)
