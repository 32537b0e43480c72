"""The pocket of matrix between three neighbours, from a cell of its own."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bondcell.cell import FloatArray
from bondcell.lattice.packing import packing
from bondcell.solid.particles import in_particles
from bondcell.solid.prescribed import solve_prescribed
from bondcell.solid.sphere_mesh import sphere_mesh
from bondcell.solid.stiffness import Elastic

PER_GAP = 0.33
"""Element size relative to the gap: a few per mille of the energies."""


@dataclass(frozen=True)
class TriangleEnergies:
    """Energy of one triangle of neighbours in an endless triangular layer.

    Parameters
    ----------
    dilation
        ``2 U`` for the strain (1, 1): all distances grow alike [J].
    deviator
        ``2 U`` for the strain (1, -1) [J].
    length
        Distance of the centres [m].
    dof
        Unknowns.
    """

    dilation: float
    deviator: float
    length: float
    dof: int


def triangle_energies(
    radius: float, gap: float, depth: float, matrix: Elastic, per_gap: float = PER_GAP
) -> TriangleEnergies:
    """Strain a triangular layer of rigid spheres in a plate.

    Parameters
    ----------
    radius, gap
        Of the spheres [m].
    depth
        Thickness of the plate, whose faces are free [m].
    matrix
        The matrix material.
    per_gap
        Element size relative to the gap.

    Notes
    -----
    The planes through rows of centres and across them are mirrors of the layer, also under strains
    along the axes: the cell between such planes, ``L/2`` by ``sqrt(3) L/2`` and half as deep as the
    plate, holds two quarter spheres in opposite corners and is one triangle's share.
    """
    length = 2 * radius + gap
    far = np.array([length / 2, np.sqrt(3) * length / 2, 0.0])
    cell = packing([[0.0, 0.0, 0.0], far], radius, [[0, far[0]], [0, far[1]], [0, depth / 2]])
    mesh = sphere_mesh(cell, per_gap)
    strains = np.array([[1.0, 1.0], [1.0, -1.0]])
    held = np.zeros((len(mesh.points), 3), dtype=bool)
    values = np.zeros((len(mesh.points), 3, 2))
    for axis in (0, 1):
        for wall in cell.box[axis].tolist():
            on = mesh.on_plane(axis, wall)
            held[on, axis] = True
            values[on, axis] = strains[:, axis] * wall
    held[mesh.on_plane(2, 0.0), 2] = True
    owner = in_particles(mesh, cell)
    held[owner >= 0] = True
    moved: FloatArray = np.where((owner == 1)[:, np.newaxis], strains[:, 0] * far[0], 0.0)
    values[owner >= 0, 0] = moved[owner >= 0]
    moved = np.where((owner == 1)[:, np.newaxis], strains[:, 1] * far[1], 0.0)
    values[owner >= 0, 1] = moved[owner >= 0]
    found = solve_prescribed(mesh, matrix, held, values)
    # The other half of the plate's depth doubles the energies.
    dilation, deviator = (2 * np.diag(found.energy)).tolist()
    return TriangleEnergies(dilation, deviator, length, found.dof)
