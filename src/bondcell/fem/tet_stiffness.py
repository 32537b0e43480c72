"""Stiffness of second-order tetrahedra, material by material."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array, csr_array, eye_array, kron, vstack
from skfem import Basis, ElementTetP2, MeshTet2
from skfem.helpers import ddot, div, sym_grad

from bondcell.cell import FloatArray
from bondcell.fem.tet_mesh import MATRIX, TetMesh

QUADRATURE_ORDER = 5
"""Straight P2 tetrahedra need 2, curved ones more; orders 3 and 4 have negative weights."""


@dataclass(frozen=True)
class GlobalStiffness:
    """Global matrices; unknown ``3 n + c`` is component c of node n.

    Parameters
    ----------
    matrix
        The part of the matrix material.
    total
        All of the cell.
    embedding
        The P1 functions in terms of the P2 ones: corners come first, then mid-nodes of edges.
    """

    matrix: csr_array
    total: csr_array
    embedding: csr_array


def strain_energy(u: Any, v: Any, w: Any) -> Any:
    """``lambda div u div v + 2 mu e(u) : e(v)``, to be integrated over the solid.

    What `element_matrices` computes by batched products, as scikit-fem's form.
    """
    return w["lam"] * div(u) * div(v) + 2 * w["mu"] * ddot(sym_grad(u), sym_grad(v))


def element_matrices(
    grid: MeshTet2, elements: NDArray[np.int64], lam: float, mu: float
) -> FloatArray:
    """Element matrices of one material, shape (elements, 30, 30), node by node.

    Notes
    -----
    With ``H_(ai)(bj)`` the integral of ``phi_a,i phi_b,j``,
    ``K_(ai)(bj) = lambda H_(ai)(bj) + mu H_(aj)(bi) + mu delta_ij H_(ak)(bk)``.
    """
    basis = Basis(grid, ElementTetP2(), elements=elements, intorder=QUADRATURE_ORDER)
    gradient = np.stack([shape[0].grad for shape in basis.basis]) * np.sqrt(basis.dx)
    nodes, axes, count, points = gradient.shape
    rows = gradient.transpose(2, 0, 1, 3).reshape(count, nodes * axes, points)
    products = (rows @ rows.transpose(0, 2, 1)).reshape(count, nodes, axes, nodes, axes)
    result = lam * products + mu * products.transpose(0, 1, 4, 3, 2)
    trace = np.einsum("eakbk->eab", products)
    for i in range(axes):
        result[:, :, i, :, i] += mu * trace
    return np.asarray(result.reshape(count, nodes * axes, nodes * axes))


def assemble(mesh: TetMesh, moduli: Mapping[int, tuple[float, float]]) -> GlobalStiffness:
    """Assemble the global matrices.

    Parameters
    ----------
    mesh
        The mesh.
    moduli
        Young's modulus and Poisson's ratio by material. Rigid ones have no stiffness of their own.
    """
    nodes = mesh.grid.dofs.element_dofs.astype(np.int64)
    size = 3 * mesh.points.shape[1]
    parts = {}
    for material, (young, poisson) in moduli.items():
        if np.isinf(young):
            continue
        elements = np.flatnonzero(mesh.material == material)
        lam = young * poisson / ((1 + poisson) * (1 - 2 * poisson))
        local = element_matrices(mesh.grid, elements, lam, young / (2 * (1 + poisson)))
        dofs = (3 * nodes[:, elements].T[:, :, np.newaxis] + np.arange(3)).reshape(-1, 30)
        at = np.broadcast_arrays(dofs[:, :, np.newaxis], dofs[:, np.newaxis])
        entries = (local.ravel(), (at[0].ravel(), at[1].ravel()))
        parts[material] = csr_array(coo_array(entries, shape=(size, size)))
    total = csr_array(sum(parts.values()))
    return GlobalStiffness(parts[MATRIX], total, _embedding(mesh.grid))


def _embedding(grid: MeshTet2) -> csr_array:
    """A mid-node's value is the mean of its edge's ends."""
    corners, edges = grid.nvertices, grid.edges
    middle = (np.full(edges.size, 0.5), (np.tile(np.arange(edges.shape[1]), 2), edges.ravel()))
    ends = csr_array(middle, shape=(edges.shape[1], corners))
    return csr_array(kron(vstack([eye_array(corners), ends]), eye_array(3)))
