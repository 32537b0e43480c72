"""Second-order triangles of a bond cell's meridional section, whoever made them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bondcell.cell import FloatArray

IntArray = NDArray[np.int64]

PARTICLE_I, PARTICLE_J, MATRIX = 1, 2, 3
"""Material numbers of the triangles."""

_TOLERANCE = 1e-3


@dataclass(frozen=True)
class TriangleMesh:
    """Second-order triangles.

    Parameters
    ----------
    points
        Coordinates (r, z) of all nodes, shape (2, nodes).
    triangles
        Node numbers of each triangle, shape (6, elements): the corners, then the mid-nodes of the
        sides (0, 1), (1, 2), (2, 0).
    material
        `PARTICLE_I`, `PARTICLE_J` or `MATRIX` of each triangle, shape (elements,).
    lines
        Nodes of the closed lines ``axis``, ``bottom``, ``top`` (the mid-plane of a half section),
        ``lateral``, ``arc_i`` and ``arc_j``.
    """

    points: FloatArray
    triangles: IntArray
    material: IntArray
    lines: dict[str, IntArray]

    def nodes_of(self, material: int) -> IntArray:
        """Nodes of the closed region of one material."""
        return np.unique(self.triangles[:, self.material == material])

    def is_inverted(self) -> bool:
        """Whether a Jacobian determinant at a node has not the sign of the straight triangle's.

        It is zero at the tip of the triangle that closes a zero-angle end, hence the tolerance.
        """
        jacobian = np.einsum("cae,nap->encp", self.points[:, self.triangles], gradients_at_nodes())
        corners = self.points[:, self.triangles[:3]]
        straight = np.linalg.det((corners[:, 1:] - corners[:, :1]).transpose(2, 0, 1))
        ratio = np.linalg.det(jacobian) / straight[:, np.newaxis]
        return bool(ratio.min() < -_TOLERANCE)


def gradients_at_nodes() -> FloatArray:
    """Gradients of the shape functions at the nodes, shape (node, function, coordinate)."""
    corners = np.eye(3)
    nodes = np.vstack([corners, (corners + np.roll(corners, -1, axis=0)) / 2])
    slope = np.array([[-1.0, -1.0], [1.0, 0.0], [0.0, 1.0]])
    after = np.roll(np.arange(3), -1)
    at_corners = (4 * nodes - 1)[:, :, np.newaxis] * slope
    at_sides = 4 * (nodes[:, :, np.newaxis] * slope[after] + nodes[:, after, np.newaxis] * slope)
    return np.concatenate([at_corners, at_sides], axis=1)
