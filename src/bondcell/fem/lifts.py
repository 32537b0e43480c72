"""Rigid motions as coefficients, and the displacements a solution starts from."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from skfem.element import ElementQuadP

from bondcell.cell import FloatArray
from bondcell.fem.cell_mesh import CellMesh
from bondcell.fem.curved_mapping import lobatto_points
from bondcell.fem.half_cell import PARTICLE_I
from bondcell.fem.numbering import Numbering
from bondcell.fem.supports import Motion, Supports


def rigid_motions(
    mesh: CellMesh, numbering: Numbering, order: int, supports: Supports
) -> FloatArray:
    """Coefficients of the unit motions of the whole cell, shape (unknowns, motions)."""
    return np.stack(
        [_interpolate(mesh, numbering, order, motion) for motion in supports.motions], axis=1
    )


def lifts(
    mesh: CellMesh,
    numbering: Numbering,
    supports: Supports,
    held: NDArray[np.bool_],
    rigid: FloatArray,
) -> FloatArray:
    """Motions that the displacement starts from: the stiff lifts, then the soft ones.

    Both follow the rigid motion on particle j, in the thin elements beside its foot, and in the
    prescribed components of the moved boundaries. The stiff lift vanishes elsewhere; the soft one
    goes on through the matrix up to what is prescribed to be at rest.
    """
    moved = {name: supports.held[name] for name in supports.moved if name in mesh.boundary}
    prescribed = numbering.marked(moved) & held
    stiff = prescribed | (numbering.on_elements(mesh.carried) & ~(held & ~prescribed))
    soft = stiff | (numbering.on_elements(mesh.region != PARTICLE_I) & ~held)
    return np.concatenate([np.where(lift[:, None], rigid, 0.0) for lift in (stiff, soft)], axis=1)


def _interpolate(mesh: CellMesh, numbering: Numbering, order: int, motion: Motion) -> FloatArray:
    """Coefficients of a motion, which the isoparametric space contains exactly."""
    r, z = mesh.mapping(order).nodes.reshape(2, mesh.topology.nelements, -1)
    nodal = motion(r, z - mesh.end_height)
    coefficients = nodal @ _coefficients_of_nodes(order)
    result = np.zeros((numbering.components, numbering.count))
    result[:, numbering.scalar_dofs] = coefficients
    return result.ravel()


@lru_cache(maxsize=32)
def _coefficients_of_nodes(order: int) -> FloatArray:
    """Values at the Gauss-Lobatto nodes -> coefficients, shape (nodes, shapes)."""
    points = lobatto_points(order)
    tensor = np.array([np.repeat(points, order + 1), np.tile(points, order + 1)])
    element = ElementQuadP(order)
    shapes = np.array([element.lbasis(tensor, k)[0] for k in range(tensor.shape[1])])
    return np.asarray(np.linalg.inv(shapes))
