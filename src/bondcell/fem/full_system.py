"""The whole finite element system of one cell, nothing condensed: what time stepping works on."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from bondcell.cell import Cell, FloatArray
from bondcell.fem.cell_basis import cell_basis
from bondcell.fem.cell_mesh import CellMesh, build_cell_mesh
from bondcell.fem.element_matrices import ElementMatrices, element_matrices
from bondcell.fem.half_cell import MATRIX, PARTICLE_I
from bondcell.fem.lifts import lifts, rigid_motions
from bondcell.fem.materials import Constants, Materials
from bondcell.fem.numbering import Numbering
from bondcell.fem.structured import Load, find_load, geometry_of
from bondcell.fem.supports import Supports

LARGEST_BULK = 1e8
"""Bulk over shear modulus that stands for an incompressible particle."""


@dataclass(frozen=True)
class FullSystem:
    """Sparse operators on all displacements, and the prescribed motion.

    Parameters
    ----------
    shear
        Of the matrix at unit shear modulus, shape (unknowns, unknowns).
    bulk_root
        ``R`` with ``R^T R`` the same of its bulk modulus, shape (pressures, unknowns).
    particles
        Of both particles with their own moduli; rigid ones are held instead.
    lift
        A displacement with the prescribed motion, particle j rigid, shape (unknowns,).
    free
        Unknowns that are not prescribed, bool.
    factor
        What this system's stiffness counts in the cell's: half for half of a symmetric pair.
    """

    shear: csr_array
    bulk_root: csr_array
    particles: csr_array
    lift: FloatArray
    free: NDArray[np.bool_]
    factor: float

    @cached_property
    def bulk(self) -> csr_array:
        """Of the matrix at unit bulk modulus, shape (unknowns, unknowns)."""
        return csr_array(self.bulk_root.T @ self.bulk_root)


def full_systems(
    cell: Cell, order: int, load: str = "normal", bc: str = "roller"
) -> tuple[FullSystem, ...]:
    """Assemble one cell; its stiffness is the sum of the systems' times their factors.

    Parameters
    ----------
    cell
        One raveled cell; its matrix moduli do not matter.
    order
        Polynomial order.
    load, bc
        See `structured.LOADS`. Bending of a symmetric pair has two systems, the others one.
    """
    geometry, materials = geometry_of(cell), Materials.of(cell)
    half = bool(geometry.is_mirrored and materials.is_mirrored[0])
    entry, constants = find_load(load, bc), materials.constants(0)
    mesh = build_cell_mesh(geometry, entry.grading, half)
    if not half:
        return (_assemble(mesh, order, entry.whole, entry.index, constants, 1.0),)
    length = geometry.radius_i + geometry.radius_j + geometry.gap
    return tuple(
        _assemble(mesh, order, supports, 0, constants, 0.5 * _share(entry, k, length))
        for k, supports in enumerate(entry.halves)
    )


def _share(entry: Load, k: int, length: float) -> float:
    """What the response of half ``k`` counts in the load's own stiffness: joining is linear."""
    units = [np.full((1, 1, 1), float(other == k)) for other in range(len(entry.halves))]
    joined = entry.join(units, length)[0]
    index = min(entry.index, len(joined) - 1)
    return float(joined[index, index])


def _assemble(
    mesh: CellMesh, order: int, supports: Supports, motion: int, constants: Constants, factor: float
) -> FullSystem:
    basis = cell_basis(mesh.topology, mesh.mapping(order), order)
    numbering = Numbering(mesh, basis, len(supports.mode.components))
    held = numbering.marked(supports.held)
    rigid = rigid_motions(mesh, numbering, order, supports)
    lift = lifts(mesh, numbering, supports, held, rigid)[:, motion]
    matrices = element_matrices(basis.points, supports.mode, projected=True)
    dofs = _element_dofs(numbering)
    own = np.zeros_like(matrices.shear)
    for region in np.unique(mesh.region[mesh.region != MATRIX]):
        k = 0 if region == PARTICLE_I else 1
        rows = mesh.region == region
        if np.isinf(constants.shear[k]):
            held = held | numbering.on_elements(rows)
        else:
            own[rows] = _solid(matrices.of(rows), constants.shear[k], constants.poisson[k])
    is_matrix = (mesh.region == MATRIX)[:, None, None]
    return FullSystem(
        shear=_assembled(np.where(is_matrix, matrices.shear, 0.0), dofs, dofs, held.size),
        bulk_root=_roots(
            matrices.bulk_root[mesh.region == MATRIX], dofs[mesh.region == MATRIX], held.size
        ),
        particles=_assembled(own, dofs, dofs, held.size),
        lift=lift,
        free=~held,
        factor=factor,
    )


def _solid(matrices: ElementMatrices, shear: float, poisson: float) -> FloatArray:
    """Element matrices of a particle."""
    root = matrices.bulk_root
    bulk = shear * min(LARGEST_BULK, 2 * (1 + poisson) / max(3 * (1 - 2 * poisson), 1e-99))
    return np.asarray(shear * matrices.shear + bulk * (root.transpose(0, 2, 1) @ root))


def _element_dofs(numbering: Numbering) -> NDArray[np.int64]:
    """Global unknowns of each element in the order of the element matrices, inside first."""
    shapes = numbering.scalar_dofs.shape[1]
    local = np.concatenate((numbering.inner, numbering.outer))
    return numbering.scalar_dofs[:, local % shapes] + numbering.count * (local // shapes)


def _roots(local: FloatArray, dofs: NDArray[np.int64], size: int) -> csr_array:
    """Roots of the bulk matrices, every element with pressures of its own."""
    elements, pressures, _ = local.shape
    rows = np.arange(elements * pressures).reshape(elements, pressures)
    return _assembled(local, rows, dofs, size, elements * pressures)


def _assembled(
    local: FloatArray,
    rows: NDArray[np.int64],
    columns: NDArray[np.int64],
    size: int,
    height: int | None = None,
) -> csr_array:
    """Sum of element matrices at global rows and columns, shape (height or size, size)."""
    row = np.repeat(rows, columns.shape[1], axis=1).ravel()
    column = np.tile(columns, (1, rows.shape[1])).ravel()
    used = local.ravel() != 0
    entries = (local.ravel()[used], (row[used], column[used]))
    return csr_array(entries, shape=(size if height is None else height, size))
