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
        shapes, boundary = scalar.shape[1], 4 * basis.elem.p
        local = np.arange(components)[:, None] * shapes + np.arange(shapes)
        self.inner, self.outer = local[:, boundary:].ravel(), local[:, :boundary].ravel()
        self.outer_dofs = np.concatenate(
            [scalar[:, :boundary] + c * self.count for c in range(components)], axis=1
        )

    def marked(self, where: Mapping[str, tuple[int, ...]]) -> NDArray[np.bool_]:
        """Unknowns of the given components on the given boundaries."""
        marked = np.zeros(self.components * self.count, dtype=bool)
        for name, chosen in where.items():
            facets = self.mesh.boundary.get(name, np.empty(0))
            if facets.size:
                scalar = self.basis.get_dofs(facets=facets).all()
                for c in chosen:
                    marked[scalar + c * self.count] = True
        return marked

    def on_elements(self, chosen: NDArray[np.bool_]) -> NDArray[np.bool_]:
        """Unknowns of all components on the chosen elements, their boundaries included."""
        scalar = np.unique(self.scalar_dofs[chosen])
        marked = np.zeros(self.components * self.count, dtype=bool)
        for c in range(self.components):
            marked[scalar + c * self.count] = True
        return marked
