"""Unknowns of a displacement whose components share one scalar basis."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray
from skfem import Basis

from bondcell.fem.cell_mesh import CellMesh


class Numbering:
    """Global unknowns, component by component, and their place in the elements.

    Parameters
    ----------
    mesh, basis
        The mesh and the scalar basis of one component on it.
    components
        Number of the displacement's components.
    """

    def __init__(self, mesh: CellMesh, basis: Basis, components: int) -> None:
        self.mesh, self.basis, self.components = mesh, basis, components
        self.count = int(basis.N)
        scalar = np.asarray(basis.element_dofs, dtype=np.int64).T
        self.scalar_dofs = scalar
        self.outer_dofs = self.boundary_dofs(basis.elem.p)
        self.inner, self.outer = local_unknowns(basis.elem.p, components)

    def boundary_dofs(self, order: int) -> NDArray[np.int64]:
        """Global unknowns on each element's boundary, of functions up to an order.

        Shape (elements, components * 4 * order), by component; vertices come first, then edge by
        edge the functions of rising order, so that a lower order is a part of a higher one.
        """
        own = self.basis.elem.p
        edges = 4 + np.arange(4)[:, None] * (own - 1) + np.arange(order - 1)
        chosen = self.scalar_dofs[:, np.concatenate((np.arange(4), edges.ravel()))]
        return np.concatenate([chosen + c * self.count for c in range(self.components)], axis=1)

    def marked(self, where: Mapping[str, tuple[int, ...]]) -> NDArray[np.bool_]:
        """Unknowns of the given components on the given boundaries."""
        dofs = self.basis.dofs
        marked = np.zeros(self.components * self.count, dtype=bool)
        for name, chosen in where.items():
            facets = self.mesh.boundary.get(name, np.empty(0, dtype=int))
            vertices = self.mesh.topology.facets[:, facets]
            for c in chosen:
                marked[dofs.nodal_dofs[:, vertices] + c * self.count] = True
                marked[dofs.facet_dofs[:, facets] + c * self.count] = True
        return marked

    def on_elements(self, chosen: NDArray[np.bool_]) -> NDArray[np.bool_]:
        """Unknowns of all components on the chosen elements, their boundaries included."""
        scalar = self.scalar_dofs[chosen]
        marked = np.zeros(self.components * self.count, dtype=bool)
        for c in range(self.components):
            marked[scalar + c * self.count] = True
        return marked


def local_unknowns(order: int, components: int) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Local unknowns inside an element and on its boundary, by component."""
    shapes, boundary = (order + 1) ** 2, 4 * order
    local = np.arange(components)[:, None] * shapes + np.arange(shapes)
    return local[:, boundary:].ravel(), local[:, :boundary].ravel()
