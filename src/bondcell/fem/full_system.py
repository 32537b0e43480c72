"""The whole finite element system of one cell, nothing condensed: what time stepping works on."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from bondcell.cell import Cell, FloatArray
from bondcell.errors import UnsupportedLoad, Violation
from bondcell.fem.cell_mesh import build_cell_mesh
from bondcell.fem.element_matrices import cell_basis, element_matrices
from bondcell.fem.half_cell import MATRIX, PARTICLE_I
from bondcell.fem.lifts import lifts, rigid_motions
from bondcell.fem.materials import Materials
from bondcell.fem.numbering import Numbering
from bondcell.fem.structured import find_load, geometry_of


@dataclass(frozen=True)
class FullSystem:
    """Sparse operators on all displacements, and the prescribed motion.

    Parameters
    ----------
    shear, bulk
        Of the matrix at unit shear and unit bulk modulus, shape (unknowns, unknowns).
    particles
        Of both particles with their own moduli.
    lift
        A displacement with the prescribed motion, particle j rigid, shape (unknowns,).
    free
        Unknowns that are not prescribed, bool.
    factor
        Stiffness of the cell over that of this system: half for half of a symmetric pair.
    """

    shear: csr_array
    bulk: csr_array
    particles: csr_array
    lift: FloatArray
    free: NDArray[np.bool_]
    factor: float

    @classmethod
    def of(cls, cell: Cell, order: int, load: str = "normal", bc: str = "roller") -> FullSystem:
        """Assemble one cell of elastic particles.

        Parameters
        ----------
        cell
            One raveled cell; its matrix moduli do not matter.
        order
            Polynomial order.
        load, bc
            ``normal`` with any boundary condition, or ``torsion``: loads of a single motion.
        """
        if load not in ("normal", "torsion"):
            raise UnsupportedLoad([Violation("load", load, "normal or torsion")])
        if not np.isfinite([cell.young_i[0], cell.young_j[0]]).all():
            raise UnsupportedLoad([Violation("young_i", np.inf, "finite: elastic particles")])
        geometry, constants = geometry_of(cell), Materials.of(cell).constants(0)
        half = bool(geometry.is_mirrored and Materials.of(cell).is_mirrored[0])
        entry = find_load(load, bc)
        supports = entry.halves[0] if half else entry.whole
        mesh = build_cell_mesh(geometry, entry.grading, half)
        basis = cell_basis(mesh.topology, mesh.mapping(order), order)
        numbering = Numbering(mesh, basis, len(supports.mode.components))
        held = numbering.marked(supports.held)
        rigid = rigid_motions(mesh, numbering, order, supports)
        matrices = element_matrices(basis, supports.mode, projected=True)
        shear = matrices.shear
        bulk = np.einsum("epi,epj->eij", matrices.bulk_root, matrices.bulk_root, optimize=True)
        dofs = _element_dofs(numbering)
        own = np.zeros_like(shear)
        for region in np.unique(mesh.region[mesh.region != MATRIX]):
            k = 0 if region == PARTICLE_I else 1
            mu, nu = constants.shear[k], constants.poisson[k]
            kappa = 2 * mu * (1 + nu) / (3 * (1 - 2 * nu))
            rows = mesh.region == region
            own[rows] = mu * shear[rows] + kappa * bulk[rows]
        is_matrix = (mesh.region == MATRIX)[:, None, None]
        return cls(
            shear=_assembled(np.where(is_matrix, shear, 0.0), dofs, held.size),
            bulk=_assembled(np.where(is_matrix, bulk, 0.0), dofs, held.size),
            particles=_assembled(own, dofs, held.size),
            lift=lifts(mesh, numbering, supports, held, rigid)[:, 0],
            free=~held,
            factor=0.5 if half else 1.0,
        )


def _element_dofs(numbering: Numbering) -> NDArray[np.int64]:
    """Global unknowns of each element in the order of the element matrices, inside first."""
    shapes = numbering.scalar_dofs.shape[1]
    local = np.concatenate((numbering.inner, numbering.outer))
    return numbering.scalar_dofs[:, local % shapes] + numbering.count * (local // shapes)


def _assembled(local: FloatArray, dofs: NDArray[np.int64], size: int) -> csr_array:
    rows = np.repeat(dofs, dofs.shape[1], axis=1).ravel()
    columns = np.tile(dofs, (1, dofs.shape[1])).ravel()
    used = local.ravel() != 0
    entries = (local.ravel()[used], (rows[used], columns[used]))
    return csr_array(entries, shape=(size, size))
