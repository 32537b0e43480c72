"""Pockets of matrix between three neighbours: what bonds do not know of each other."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.sparse import csr_array

from bondcell.cell import FloatArray
from bondcell.errors import InputError, Violation


@dataclass(frozen=True)
class Pockets:
    """Three-body springs; build them with `pockets`.

    Parameters
    ----------
    corners
        Nodes, shape (pockets, 3).
    stiffness
        K_tri [J], shape (pockets,).
    deviator
        K_dev [J], shape (pockets,).

    Notes
    -----
    With e the uniform strain of the triangle in its plane, the energy is
    ``1/2 K_tri (e_11 + e_22)^2 + 1/2 K_dev ((e_11 - e_22)^2 + (2 e_12)^2)``; the first strain is
    the relative change of area, dA/A. Matrix that is squeezed by all three bonds is stiffer than
    the three say; where one bond makes room for what another presses out, it is softer: K_dev may
    be negative.
    """

    corners: NDArray[np.int64]
    stiffness: FloatArray
    deviator: FloatArray

    @property
    def count(self) -> int:
        """Number of pockets."""
        return len(self.corners)


def pockets(corners: ArrayLike, stiffness: ArrayLike, deviator: ArrayLike = 0.0) -> Pockets:
    """Pockets between three nodes each.

    Parameters
    ----------
    corners
        Shape (pockets, 3).
    stiffness, deviator
        K_tri and K_dev [J]; single numbers hold for all.

    Raises
    ------
    InputError
        K_tri is negative, or one of them is no number.
    """
    nodes = np.asarray(corners, dtype=np.int64).reshape(-1, 3)
    arrays, violations = [], []
    for name, given, low in (("stiffness", stiffness, 0.0), ("deviator", deviator, -np.inf)):
        array = np.asarray(given, dtype=np.float64)
        if array.shape not in ((), (len(nodes),)):
            allowed = f"one number or {len(nodes)} of them"
            violations.append(Violation(f"pockets.{name}", array.shape, allowed))
        elif not (np.isfinite(array) & (array >= low)).all():
            allowed = "[0, inf) J" if low == 0 else "finite numbers, J"
            violations.append(Violation(f"pockets.{name}", array.tolist(), allowed))
        else:
            arrays.append(np.broadcast_to(array, len(nodes)).copy())
    if violations:
        raise InputError(violations)
    return Pockets(nodes, *arrays)


def triangles(pairs: NDArray[np.int64], count: int) -> NDArray[np.int64]:
    """All triples of nodes that are neighbours of each other, shape (triangles, 3), sorted.

    Examples
    --------
    >>> triangles(np.array([[0, 1], [1, 2], [0, 2], [2, 3]]), 4).tolist()
    [[0, 1, 2]]
    """
    low, high = np.sort(pairs, axis=1).T
    ones = np.ones(len(pairs), dtype=np.int32)
    upper = csr_array((ones, (low, high)), shape=(count, count))
    # A path i < k < j whose ends are neighbours as well.
    found = []
    for node in range(count):
        above = upper.indices[upper.indptr[node] : upper.indptr[node + 1]]
        for middle in above.tolist():
            beyond = upper.indices[upper.indptr[middle] : upper.indptr[middle + 1]]
            found += [(node, middle, last) for last in np.intersect1d(above, beyond).tolist()]
    return np.array(sorted(found), dtype=np.int64).reshape(-1, 3)


def triangle_strains(points: FloatArray, corners: NDArray[np.int64]) -> FloatArray:
    """Uniform strains of triangles by their corners' displacements.

    Returns
    -------
    numpy.ndarray
        Rows ``e_11 + e_22``, ``e_11 - e_22`` and ``2 e_12`` in the plane of each triangle, shape
        (triangles, 3, 3 corners, dimension).

    Notes
    -----
    The linear function that is one at corner k has the gradient ``m x (x_(k+2) - x_(k+1)) / 2A``,
    m the normal of the triangle.
    """
    where = np.zeros((*corners.shape, 3))
    where[..., : points.shape[1]] = points[corners]
    opposite = np.roll(where, -2, axis=1) - np.roll(where, -1, axis=1)
    normal = np.cross(where[:, 1] - where[:, 0], where[:, 2] - where[:, 0])
    twice = np.linalg.norm(normal, axis=1)
    normal /= twice[:, np.newaxis]
    gradient = np.cross(normal[:, np.newaxis], opposite) / twice[:, np.newaxis, np.newaxis]
    one = where[:, 1] - where[:, 0]
    one /= np.linalg.norm(one, axis=1, keepdims=True)
    two = np.cross(normal, one)
    along, across = (
        np.einsum("tki,ti->tk", gradient, axis)[..., np.newaxis] for axis in (one, two)
    )
    one, two = one[:, np.newaxis], two[:, np.newaxis]
    rows = [along * one + across * two, along * one - across * two, along * two + across * one]
    return np.stack(rows, axis=1)[..., : points.shape[1]]
