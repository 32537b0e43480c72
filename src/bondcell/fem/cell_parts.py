"""The parts of a bond cell on one mesh at one order: the matrix and its particles."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from bondcell.cell import FloatArray
from bondcell.fem.cell_basis import ElementPoints, cell_basis
from bondcell.fem.cell_mesh import CellMesh
from bondcell.fem.element_matrices import ElementMatrices, element_matrices
from bondcell.fem.half_cell import MATRIX, PARTICLE_I, PARTICLE_J
from bondcell.fem.lifts import lifts, rigid_motions
from bondcell.fem.numbering import Numbering
from bondcell.fem.substructure import Substructure
from bondcell.fem.supports import Supports

LOWEST = 2
"""Least order of a particle that stays behind the matrix."""


class CellParts:
    """Element matrices, unknowns and lifts, part by part.

    Parameters
    ----------
    mesh
        Structured mesh, of the whole cell or of a symmetric pair's half.
    order
        Polynomial order of displacement and geometry in the matrix.
    supports
        Load and boundary condition.
    projected
        Mixed form or displacement form; see `element_matrices`.
    lag
        How many orders the particles stay behind; they must be stiffer than the matrix, or it is 0.

    Attributes
    ----------
    matrix, particles
        The parts; the matrix's interface is that of the particles one after the other.
    followed
        Rigid motions of the interface with particle i, shape (unknowns, motions).
    dof
        Unknowns of the whole system.

    Notes
    -----
    On the faces of particles that stay behind, the functions they lack move with the lift alone.
    """

    def __init__(
        self, mesh: CellMesh, order: int, supports: Supports, projected: bool, lag: int
    ) -> None:
        behind = min(order, max(order - lag, LOWEST))
        basis = cell_basis(mesh.topology, mesh.mapping(order), order)
        numbering = Numbering(mesh, basis, len(supports.mode.components))
        held = numbering.marked(supports.held)
        rigid = rigid_motions(mesh, numbering, order, supports)
        starts = lifts(mesh, numbering, supports, held, rigid)
        lagging = numbering.boundary_dofs(behind)
        held |= _lacking(mesh, numbering, lagging)
        both = np.tile(rigid, 2)

        def part(
            matrices: ElementMatrices,
            dofs: NDArray[np.int64],
            interface: NDArray[np.int64],
            lift: FloatArray,
        ) -> Substructure:
            return Substructure(matrices, dofs, interface, held, lift, both)

        own = mesh.elements(MATRIX)
        others = slice(own.stop, None)
        points = ElementPoints(mesh.mapping(order), own)
        of_matrix = element_matrices(points, supports.mode, projected)
        points = ElementPoints(mesh.mapping(behind), others)
        of_particles = element_matrices(points, supports.mode, projected)
        dofs = numbering.outer_dofs[own]
        beside = np.zeros_like(held)
        beside[dofs] = True
        beside &= ~held
        interfaces, self.particles = [], []
        for region in (PARTICLE_I, PARTICLE_J):
            at = mesh.elements(region)
            if at.stop > at.start:
                shared = np.zeros_like(held)
                shared[lagging[at]] = True
                interfaces.append(np.flatnonzero(shared & beside))
                matrices = of_particles.of(slice(at.start - own.stop, at.stop - own.stop))
                still = np.zeros_like(starts)
                self.particles.append(part(matrices, lagging[at], interfaces[-1], still))
        self.matrix = part(of_matrix, dofs, np.concatenate(interfaces), starts)
        self.followed = rigid[interfaces[0]]
        inside = len(supports.mode.components) * (behind - 1) ** 2
        self.dof = int((~held).sum()) + inside * int((mesh.region != MATRIX).sum())


def _lacking(mesh: CellMesh, numbering: Numbering, lagging: NDArray[np.int64]) -> NDArray[np.bool_]:
    """Unknowns of the numbering on particles that are none of their faces' own."""
    is_particle = mesh.region != MATRIX
    lacking = numbering.on_elements(is_particle)
    lacking[lagging[is_particle]] = False
    return lacking
