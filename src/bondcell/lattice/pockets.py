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
    turning
        K_turn [J], shape (pockets,).
    twist
        K_twist [J], shape (pockets,).

    Notes
    -----
    With e the uniform strain of the triangle in its plane, w its rotation about its normal, th_k
    the rotations of its corners about the same and t their mean, the energy is
    ``1/2 K_tri (e_11 + e_22)^2 + 1/2 K_dev ((e_11 - e_22)^2 + (2 e_12)^2) + 1/2 K_turn (t - w)^2
    + 1/2 K_twist sum of (th_k - t)^2``; the first strain is the relative change of area, dA/A.
    Matrix that is squeezed by all three bonds is stiffer than the three say. Where one bond makes
    room for what another presses out, or where bonds would count the same matrix twice, it is
    softer: all but K_tri may be negative.
    """

    corners: NDArray[np.int64]
    stiffness: FloatArray
    deviator: FloatArray
    turning: FloatArray
    twist: FloatArray

    @property
    def count(self) -> int:
        """Number of pockets."""
        return len(self.corners)

    @property
    def turns(self) -> bool:
        """Whether a pocket resists rotations of its corners."""
        return bool(self.turning.any() or self.twist.any())

    def constants(self) -> FloatArray:
        """Stiffness of each strain of `pocket_strains` [J], shape (pockets, 7)."""
        columns = [self.stiffness, self.deviator, self.deviator, self.turning]
        return np.stack([*columns, self.twist, self.twist, self.twist], axis=1)


def pockets(
    corners: ArrayLike,
    stiffness: ArrayLike,
    deviator: ArrayLike = 0.0,
    turning: ArrayLike = 0.0,
    twist: ArrayLike = 0.0,
) -> Pockets:
    """Pockets between three nodes each.

    Parameters
    ----------
    corners
        Shape (pockets, 3).
    stiffness, deviator, turning, twist
        K_tri, K_dev, K_turn and K_twist [J]; single numbers hold for all.

    Raises
    ------
    InputError
        K_tri is negative, or one of them is no number.
    """
    nodes = np.asarray(corners, dtype=np.int64).reshape(-1, 3)
    arrays, violations = [], []
    given_constants = {
        "stiffness": stiffness, "deviator": deviator, "turning": turning, "twist": twist
    }  # fmt: skip
    for name, given in given_constants.items():
        low = 0.0 if name == "stiffness" else -np.inf
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


def pocket_strains(points: FloatArray, corners: NDArray[np.int64], width: int) -> FloatArray:
    """What nodal motions do to pockets, shape (pockets, 7, 3 width).

    Parameters
    ----------
    points
        Nodes [m], shape (nodes, 2) or (nodes, 3).
    corners
        Shape (pockets, 3).
    width
        Unknowns of a node; without rotations the last four rows are zero.

    Notes
    -----
    Rows: ``e_11 + e_22``, ``e_11 - e_22``, ``2 e_12``, ``t - w`` and ``th_k - t`` of the three
    corners, see `Pockets`.
    """
    count, dimension = len(corners), points.shape[1]
    shifts, normal = triangle_strains(points, corners)
    full = np.zeros((count, 7, 3, width))
    full[:, :3, :, :dimension] = shifts[:, :3]
    if width > dimension:
        full[:, 3, :, :dimension] = -shifts[:, 3]
        turn = normal[:, 2:] if dimension == 2 else normal
        full[:, 3, :, dimension:] = turn[:, np.newaxis] / 3
        relative = np.eye(3) - 1 / 3
        full[:, 4:, :, dimension:] = relative[..., np.newaxis] * turn[:, np.newaxis, np.newaxis]
    return full.reshape(count, 7, 3 * width)


def triangle_strains(
    points: FloatArray, corners: NDArray[np.int64]
) -> tuple[FloatArray, FloatArray]:
    """Uniform strains and rotations of triangles by their corners' displacements.

    Returns
    -------
    tuple
        Rows ``e_11 + e_22``, ``e_11 - e_22``, ``2 e_12`` and the rotation about the normal, in the
        plane of each triangle, shape (triangles, 4, 3 corners, dimension); normals (triangles, 3).

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
    rows = [
        along * one + across * two,
        along * one - across * two,
        along * two + across * one,
        (along * two - across * one) / 2,
    ]
    return np.stack(rows, axis=1)[..., : points.shape[1]], normal
