"""Bonds as springs between rigid bodies: stiffnesses and the motions that strain them."""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import ArrayLike, NDArray

from bondcell.cell import FloatArray
from bondcell.errors import InputError, Violation

MODES = {2: ("normal", "shear", "bending"), 3: ("normal", "shear", "bending", "torsion")}
"""Ways a bond is strained, by the dimension of the lattice."""

_ROWS = {
    2: ("normal", "shear", "bending"),
    3: ("normal", "shear", "shear", "bending", "bending", "torsion"),
}

_RANGES = {"pivot": (0.0, 1.0, "[0, 1]"), "offset": (-np.inf, np.inf, "finite numbers, m")}


@dataclass(frozen=True)
class Bonds:
    """Bonds between nodes; build them with `bonds`, which fills the defaults and checks.

    Parameters
    ----------
    first, second
        Nodes, shape (bonds,).
    normal, shear
        Stiffness along and across the bond [N/m], shape (bonds,).
    bending, torsion
        Stiffness against relative rotation of the two nodes [N m/rad], shape (bonds,).
    pivot
        Where on the bond the shear force causes no moment, as a fraction of its length from the
        first node; 1/2 for equal particles.
    offset
        How far beside the nodes the normal force acts [m], to the left of the way from the first
        node to the second; of a bond with more matrix on one side. In the plane only.
    """

    first: NDArray[np.int64]
    second: NDArray[np.int64]
    normal: FloatArray
    shear: FloatArray
    bending: FloatArray
    torsion: FloatArray
    pivot: FloatArray
    offset: FloatArray

    @property
    def count(self) -> int:
        """Number of bonds."""
        return int(self.first.size)

    def stiffness(self, dimension: int) -> FloatArray:
        """Stiffness of each strain of `strains`, shape (bonds, strains)."""
        return np.stack([getattr(self, mode) for mode in _ROWS[dimension]], axis=1)

    def take(self, rows: slice | NDArray[np.int64]) -> Bonds:
        """Some of the bonds."""
        return Bonds(**{item.name: getattr(self, item.name)[rows] for item in fields(self)})

    def joined(self, other: Bonds) -> Bonds:
        """These bonds, then others."""
        return Bonds(
            **{
                item.name: np.concatenate([getattr(self, item.name), getattr(other, item.name)])
                for item in fields(self)
            }
        )


def bonds(
    pairs: ArrayLike,
    normal: ArrayLike,
    shear: ArrayLike = 0.0,
    bending: ArrayLike = 0.0,
    torsion: ArrayLike = 0.0,
    pivot: ArrayLike = 0.5,
    offset: ArrayLike = 0.0,
) -> Bonds:
    """Bonds between pairs of nodes.

    Parameters
    ----------
    pairs
        Shape (bonds, 2).
    normal, shear, bending, torsion, pivot, offset
        As in `Bonds`; single numbers hold for all.

    Raises
    ------
    InputError
        A stiffness is negative or no number, a pair joins a node with itself.

    Examples
    --------
    >>> bonds([[0, 1], [1, 2]], normal=1e5).normal
    array([100000., 100000.])
    """
    ends = np.asarray(pairs, dtype=np.int64).reshape(-1, 2)
    given = {
        "normal": normal, "shear": shear, "bending": bending, "torsion": torsion,
        "pivot": pivot, "offset": offset,
    }  # fmt: skip
    arrays, violations = {}, []
    for name, value in given.items():
        array = np.asarray(value, dtype=np.float64)
        if array.shape not in ((), (len(ends),)):
            allowed = f"one number or {len(ends)} of them"
            violations.append(Violation(f"bonds.{name}", array.shape, allowed))
            continue
        arrays[name] = np.broadcast_to(array, len(ends)).copy()
        low, top, allowed = _RANGES.get(name, (0.0, np.inf, "[0, inf)"))
        good = np.isfinite(array) & (array >= low) & (array <= top)
        if not good.all():
            worst = float(np.atleast_1d(array)[~np.atleast_1d(good)][0])
            violations.append(Violation(f"bonds.{name}", worst, allowed))
    same = np.flatnonzero(ends[:, 0] == ends[:, 1])
    violations += [
        Violation(f"pairs[{k}]", ends[k].tolist(), "two different nodes") for k in same[:20]
    ]
    if violations:
        raise InputError(violations)
    return Bonds(ends[:, 0], ends[:, 1], **arrays)


def bond_lengths(points: FloatArray, bonds: Bonds) -> FloatArray:
    """Distances of the bonds' nodes [m], shape (bonds,)."""
    return np.asarray(np.linalg.norm(points[bonds.second] - points[bonds.first], axis=1))


def strains(points: FloatArray, bonds: Bonds) -> FloatArray:
    """What nodal motions do to the bonds, shape (bonds, strains, unknowns of two nodes).

    A node's unknowns are its displacement and its rotation: (x, y, rotation) in the plane, three
    and three in space.

    Notes
    -----
    With n the bond's direction, t across it, L its length, p the pivot:
    normal ``n.(u_j - u_i)``, in the plane less ``o (th_j - th_i)`` with the offset o; shear
    ``t.(u_j - u_i - L (p th_i + (1-p) th_j) x n)``, the sliding of the two bodies where the shear
    force acts; bending ``t.(th_j - th_i)``; torsion ``n.(th_j - th_i)``.
    """
    length = bond_lengths(points, bonds)
    along = (points[bonds.second] - points[bonds.first]) / length[:, np.newaxis]
    arms = np.stack([bonds.pivot * length, (1 - bonds.pivot) * length])
    if points.shape[1] == 2:
        return _plane(along, arms, bonds.offset)
    return _space(along, arms)


def _plane(along: FloatArray, arms: FloatArray, offset: FloatArray) -> FloatArray:
    result = np.zeros((len(along), 3, 6))
    across = np.stack([-along[:, 1], along[:, 0]], axis=1)
    for node, sign in ((0, -1.0), (1, 1.0)):
        shift, turn = slice(3 * node, 3 * node + 2), 3 * node + 2
        result[:, 0, shift], result[:, 0, turn] = sign * along, -sign * offset
        result[:, 1, shift] = sign * across
        result[:, 1, turn] = -arms[node]
        result[:, 2, turn] = sign
    return result


def _space(along: FloatArray, arms: FloatArray) -> FloatArray:
    result = np.zeros((len(along), 6, 12))
    one, two = frame(along)
    for node, sign in ((0, -1.0), (1, 1.0)):
        shift, turn = slice(6 * node, 6 * node + 3), slice(6 * node + 3, 6 * node + 6)
        arm = arms[node][:, np.newaxis]
        result[:, 0, shift] = sign * along
        # t1.(th x n) = th.t2 and t2.(th x n) = -th.t1 for a right-handed (n, t1, t2).
        result[:, 1, shift], result[:, 1, turn] = sign * one, -arm * two
        result[:, 2, shift], result[:, 2, turn] = sign * two, arm * one
        result[:, 3, turn], result[:, 4, turn] = sign * one, sign * two
        result[:, 5, turn] = sign * along
    return result


def frame(along: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Two directions across unit vectors that make right-handed triads with them."""
    axis = np.eye(3)[np.argmin(np.abs(along), axis=1)]
    one = np.cross(along, axis)
    one /= np.linalg.norm(one, axis=1, keepdims=True)
    return one, np.cross(along, one)
