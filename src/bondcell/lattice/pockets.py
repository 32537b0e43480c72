"""Pockets of matrix between three neighbours: they resist a change of the triangle's area."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.sparse import csr_array

from bondcell.cell import FloatArray
from bondcell.errors import InputError, Violation


@dataclass(frozen=True)
class Pockets:
    """Three-body springs with the energy ``1/2 K_tri (dA/A)^2``; build them with `pockets`.

    Parameters
    ----------
    corners
        Nodes, shape (pockets, 3).
    stiffness
        K_tri [J], shape (pockets,).
    """

    corners: NDArray[np.int64]
    stiffness: FloatArray

    @property
    def count(self) -> int:
        """Number of pockets."""
        return len(self.corners)


def pockets(corners: ArrayLike, stiffness: ArrayLike) -> Pockets:
    """Pockets between three nodes each.

    Parameters
    ----------
    corners
        Shape (pockets, 3).
    stiffness
        K_tri [J]; a single number holds for all.

    Raises
    ------
    InputError
        A stiffness is negative or no number.
    """
    nodes = np.asarray(corners, dtype=np.int64).reshape(-1, 3)
    given = np.asarray(stiffness, dtype=np.float64)
    violations = []
    if given.shape not in ((), (len(nodes),)):
        allowed = f"one number or {len(nodes)} of them"
        violations.append(Violation("pockets.stiffness", given.shape, allowed))
    elif not (np.isfinite(given) & (given >= 0)).all():
        violations.append(Violation("pockets.stiffness", given.tolist(), "[0, inf) J"))
    if violations:
        raise InputError(violations)
    return Pockets(nodes, np.broadcast_to(given, len(nodes)).copy())


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


def area_strains(points: FloatArray, corners: NDArray[np.int64]) -> FloatArray:
    """Relative change of area by the corners' displacements, shape (triangles, 3, dimension).

    Notes
    -----
    ``dA/dx_k = m x (x_(k+2) - x_(k+1)) / 2`` with m the normal of the triangle.
    """
    where = np.zeros((*corners.shape, 3))
    where[..., : points.shape[1]] = points[corners]
    opposite = np.roll(where, -2, axis=1) - np.roll(where, -1, axis=1)
    normal = np.cross(where[:, 1] - where[:, 0], where[:, 2] - where[:, 0])
    twice = np.linalg.norm(normal, axis=1)
    normal /= twice[:, np.newaxis]
    change = np.cross(normal[:, np.newaxis], opposite) / twice[:, np.newaxis, np.newaxis]
    return np.asarray(change[..., : points.shape[1]])
