"""A cell of matrix between mirrors of a layer of spheres: what its motions cost."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bondcell.cell import FloatArray
from bondcell.fem.blocks import IndexArray
from bondcell.lattice.packing import Packing, packing
from bondcell.solid.particles import in_particles
from bondcell.solid.prescribed import solve_prescribed
from bondcell.solid.raise_order import raise_order
from bondcell.solid.sphere_mesh import sphere_mesh
from bondcell.solid.stiffness import Elastic
from bondcell.solid.tets import Tets

ORDER = 3
"""Order of the displacements in cells: 0.4 % of the energy at an element a gap."""

EVEN, ODD, FREE = "even", "odd", "free"
"""What a side of a cell is.

A mirror of the motion (its normal displacement is given), one that turns its sign (the tangential
displacements are given), or a free surface.
"""


@dataclass(frozen=True)
class MirrorCell:
    """Spheres in the corners of a box that is half as deep as its layer; see `mirror_cell`.

    Parameters
    ----------
    spheres
        Their centres on the plane z = 0, in corners or on edges of the box.
    mesh
        The mesh.
    matrix
        The matrix material.
    """

    spheres: Packing
    mesh: Tets
    matrix: Elastic

    def energies(
        self, sides: Sequence[str], motions: FloatArray, strains: FloatArray | None = None
    ) -> FloatArray:
        """Energies of pairs of motions in the whole depth [J]; ``2 U`` of each on the diagonal.

        Parameters
        ----------
        sides
            What x lower, x upper, y lower and y upper are.
        motions
            Displacements (x, y) [m] and rotation [rad] of the spheres, shape (cases, spheres, 3).
        strains
            Uniform strains of the layer that come besides, shape (cases, 2, 2).
        """
        points, cases = self.mesh.points, len(motions)
        held = np.zeros(points.shape, dtype=bool)
        values = np.zeros((*points.shape, cases))
        affine = np.zeros((len(points), 2, cases))
        if strains is not None:
            affine = np.einsum("cij,nj->nic", strains, points[:, :2])
        for wall, side in enumerate(sides):
            axis, end = divmod(wall, 2)
            given = {EVEN: [axis], ODD: [1 - axis, 2], FREE: []}[side]
            on = np.flatnonzero(self.mesh.on_plane(axis, self.spheres.box[axis, end]))
            for component in given:
                held[on, component] = True
                if component < 2:
                    values[on, component] = affine[on, component]
        held[self.mesh.on_plane(2, 0.0), 2] = True
        self._move_spheres(held, values, motions, strains)
        return 2 * solve_prescribed(self.mesh, self.matrix, held, values).energy

    def _move_spheres(
        self,
        held: NDArray[np.bool_],
        values: FloatArray,
        motions: FloatArray,
        strains: FloatArray | None,
    ) -> None:
        owner = in_particles(self.mesh, self.spheres)
        for k, centre in enumerate(self.spheres.centres):
            own: IndexArray = np.flatnonzero(owner == k)
            arm = self.mesh.points[own] - centre
            shift = motions[:, k, :2].copy()
            if strains is not None:
                shift += strains @ centre[:2]
            turn = motions[:, k, 2]
            held[own] = True
            values[own, 0] = shift[:, 0] - arm[:, 1:2] * turn
            values[own, 1] = shift[:, 1] + arm[:, 0:1] * turn
            values[own, 2] = 0.0


def mirror_cell(
    centres: FloatArray, radius: float, box: FloatArray, matrix: Elastic, per_gap: float
) -> MirrorCell:
    """Mesh a cell.

    Parameters
    ----------
    centres
        Centres (x, y) of the spheres [m], shape (spheres, 2).
    radius
        Of the spheres [m].
    box
        Sides of x and y, and half the depth as those of z [m], shape (3, 2).
    matrix
        The matrix material.
    per_gap
        Element size relative to the gap.
    """
    spheres = packing(np.column_stack([centres, np.zeros(len(centres))]), radius, box)
    mesh = raise_order(sphere_mesh(spheres, per_gap), ORDER, spheres)
    return MirrorCell(spheres, mesh, matrix)
