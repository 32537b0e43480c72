"""Rigid particles: the matrix condensed to their motions, every load case at once."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray

from bondcell.cell import FloatArray
from bondcell.fem.blocks import IndexArray, product
from bondcell.fem.krylov import TOLERANCE, conjugate_gradients
from bondcell.lattice.packing import Packing
from bondcell.solid.multigrid import PMultigrid
from bondcell.solid.particles import in_particles, rigid_motions
from bondcell.solid.stiffness import Elastic, assemble
from bondcell.solid.tets import MATRIX, Tets

CASES_AT_ONCE = 11
"""Right-hand sides solved together: bounds the memory of the vectors."""


@dataclass(frozen=True)
class Condensed:
    """Stiffness of a solid with rigid particles.

    Parameters
    ----------
    stiffness
        Forces [N] and moments [N m] by motions [m, rad], shape (3 particles, 3 particles); three
        motions a moving particle, as in `particles.MOTIONS`.
    moving
        The particles that move, shape (particles,).
    dof
        Unknowns of the matrix.
    iterations
        Of the slowest right-hand side.
    fields
        Displacements of all nodes for unit motions [m], shape (3 nodes, 3 particles), if kept.
    nodes
        Mesh nodes of those fields.
    """

    stiffness: FloatArray
    moving: IndexArray
    dof: int
    iterations: int
    fields: FloatArray | None
    nodes: IndexArray

    def solve(
        self, loaded: IndexArray, displacement: FloatArray
    ) -> tuple[FloatArray, FloatArray, float]:
        """Displace some particles, whose rotation is free, and leave the others free.

        Parameters
        ----------
        loaded
            Numbers of those particles.
        displacement
            Their displacement (x, y) [m].

        Returns
        -------
        tuple
            Motions of the moving particles, shape (particles, 3), the forces on them, same shape,
            and the energy [J].
        """
        count = self.moving.size
        held = np.zeros((count, 3), dtype=bool)
        held[np.isin(self.moving, loaded), :2] = True
        motion = np.where(held, np.append(displacement, 0.0), 0.0).ravel()
        free = ~held.ravel()
        inner = self.stiffness[free][:, free]
        motion[free] = -np.linalg.solve(inner, self.stiffness[free] @ motion)
        forces = self.stiffness @ motion
        energy = float(motion @ forces / 2)
        return motion.reshape(count, 3), forces.reshape(count, 3), energy


def condense(
    mesh: Tets,
    packing: Packing,
    matrix: Elastic,
    held: NDArray[np.bool_],
    keep_fields: bool = False,
    tolerance: float = TOLERANCE,
) -> Condensed:
    """Condense the matrix material to the motions of rigid particles.

    Parameters
    ----------
    mesh, packing
        The mesh and its spheres.
    matrix
        The matrix material.
    held
        Displacements that are zero, shape (nodes, 3). A particle with a node held in its plane is
        fixed; all others move in the plane.
    keep_fields
        Whether to return the displacements of all nodes as well.
    tolerance
        Error of each solution in the energy norm; the stiffness' error is its square.

    Notes
    -----
    With R the rigid motions and W the answer of the free nodes, ``K = (R + W)^T A (R + W)``: an
    error of W counts by its square, and K is never too soft.
    """
    part, nodes = mesh.part(mesh.material == MATRIX)
    owner = in_particles(part, packing)
    fixed = np.unique(owner[held[nodes, 0] & (owner >= 0)])
    moving = np.setdiff1d(np.arange(packing.count), fixed)
    stiffness = assemble(part, matrix, None)
    solver = PMultigrid(part, stiffness, held[nodes] | (owner >= 0)[:, np.newaxis], many=True)
    free = solver.free[:, np.newaxis]
    motions = rigid_motions(part, packing, moving)
    motions[held[nodes].ravel()] = 0.0
    pulls = stiffness.fine @ motions
    most, answer = 0, np.empty_like(motions)
    for start in range(0, motions.shape[1], CASES_AT_ONCE):
        cases = slice(start, start + CASES_AT_ONCE)
        answer[:, cases], iterations = conjugate_gradients(
            partial(product, solver.matrix), solver, -pulls[:, cases] * free, tolerance
        )
        most = max(most, iterations)
    rest = pulls + product(stiffness.fine, answer)
    answer += motions
    result = answer.T @ rest
    dof = int(solver.free.sum())
    kept = answer if keep_fields else None
    return Condensed((result + result.T) / 2, moving, dof, most, kept, nodes)
