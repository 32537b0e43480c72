"""Spheres in a box: what touches, what overlaps, who are neighbours."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bondcell.cell import FloatArray
from bondcell.errors import InputError, Violation
from bondcell.lattice.arrays import numbers

MOST_LISTED = 20
"""Overlaps listed one by one; what is beyond is counted."""

_ON_WALL = 1e-9
_LARGEST = 1e100  # squares of distances have to be numbers
_WALLS = ("x lower", "x upper", "y lower", "y upper", "z lower", "z upper")


@dataclass(frozen=True)
class Packing:
    """Spheres in a box; build one with `packing`, which checks it.

    Parameters
    ----------
    centres
        Centres [m], shape (spheres, 3).
    radii
        Radii [m], shape (spheres,).
    box
        Lower and upper walls of x, y and z [m], shape (3, 2).
    """

    centres: FloatArray
    radii: FloatArray
    box: FloatArray

    @property
    def count(self) -> int:
        """Number of spheres."""
        return int(self.radii.size)

    def neighbours(self, cutoff: float) -> NDArray[np.int64]:
        """Pairs of spheres whose gap is at most ``cutoff`` [m], shape (pairs, 2), first < second.

        Examples
        --------
        >>> three = packing([[0, 0, 0], [0, 0, 3], [0, 0, 7]], 1.0)
        >>> three.neighbours(1.5).tolist()
        [[0, 1]]
        """
        return _close_pairs(self.centres, self.radii, cutoff)

    def gaps(self, pairs: NDArray[np.int64]) -> FloatArray:
        """Shortest distance between the spheres of each pair [m], shape (pairs,)."""
        return _gaps(self.centres, self.radii, pairs)

    def on_wall(self, wall: int) -> NDArray[np.bool_]:
        """Spheres that a wall cuts in half, shape (spheres,); walls count as in ``box.ravel()``."""
        axis, side = divmod(wall, 2)
        distance = np.abs(self.centres[:, axis] - self.box[axis, side])
        return np.asarray(distance <= _ON_WALL * self.radii)


def packing(centres: object, radii: object, box: object | None = None) -> Packing:
    """Check spheres in a box.

    Parameters
    ----------
    centres
        Centres [m], shape (spheres, 3).
    radii
        Radii [m], shape (spheres,) or a single one.
    box
        Walls [m], shape (3, 2); without it there are none. A wall may cut a sphere through its
        centre, which leaves a half of it, and nowhere else.

    Raises
    ------
    InputError
        Every sphere that is no sphere, overlaps another one, touches it, or pierces a wall.

    Examples
    --------
    >>> packing([[0, 0, 0], [0, 0, 1.5]], 1.0)  # doctest: +ELLIPSIS
    Traceback (most recent call last):
      ...
    bondcell.errors.InputError: centres[0, 1] = 1.5: allowed is a distance above 2.0 m, ...
    """
    where = np.atleast_2d(numbers("centres", centres))
    if where.ndim != 2 or where.shape[1] != 3 or not len(where):
        allowed = "an array of shape (spheres, 3), at least one sphere"
        raise InputError([Violation("centres", where.shape, allowed)])
    size = numbers("radii", radii)
    if size.shape not in ((), (len(where),)):
        raise InputError([Violation("radii", size.shape, f"one number or {len(where)} of them")])
    size = np.broadcast_to(size, len(where)).copy()
    walls = np.full((3, 2), [-np.inf, np.inf]) if box is None else numbers("box", box)
    if walls.shape != (3, 2) or not (walls[:, 0] < walls[:, 1]).all():
        allowed = "shape (3, 2), lower below upper wall"
        raise InputError([Violation("box", walls.tolist(), allowed)])
    violations = [
        Violation(f"radii[{k}]", float(size[k]), f"(0, {_LARGEST:g}) m")
        for k in np.flatnonzero(~((size > 0) & (size < _LARGEST)))
    ]
    violations += [
        Violation(f"centres[{k}]", where[k].tolist(), f"finite numbers below {_LARGEST:g} m")
        for k in np.flatnonzero(~(np.abs(where) < _LARGEST).all(axis=1))
    ]
    if violations:
        raise InputError(_shortened(violations))
    violations = _overlaps(where, size) + _piercings(where, size, walls)
    if violations:
        raise InputError(violations)
    return Packing(where, size, walls)


def _gaps(centres: FloatArray, radii: FloatArray, pairs: NDArray[np.int64]) -> FloatArray:
    i, j = pairs.T
    distance = np.linalg.norm(centres[j] - centres[i], axis=1)
    return np.asarray(distance - radii[i] - radii[j])


def _close_pairs(centres: FloatArray, radii: FloatArray, cutoff: float) -> NDArray[np.int64]:
    from scipy.spatial import cKDTree  # slow to load, and who draws a specimen needs none

    reach = 2 * float(radii.max()) + cutoff
    pairs = cKDTree(centres).query_pairs(reach * (1 + 1e-12), output_type="ndarray")
    pairs = np.sort(pairs.astype(np.int64), axis=1)
    pairs = pairs[_gaps(centres, radii, pairs) <= cutoff + 1e-12 * reach]
    return pairs[np.lexsort(pairs.T[::-1])]


def _overlaps(centres: FloatArray, radii: FloatArray) -> list[Violation]:
    pairs = _close_pairs(centres, radii, 0.0)
    pairs = pairs[_gaps(centres, radii, pairs) <= 0]
    found = []
    for i, j in pairs[: MOST_LISTED + 1].tolist():
        allowed = f"a distance above {radii[i] + radii[j]} m, the sum of the radii"
        distance = float(np.linalg.norm(centres[j] - centres[i]))
        found.append(Violation(f"centres[{i}, {j}]", distance, allowed))
    return _shortened(found, len(pairs))


def _piercings(centres: FloatArray, radii: FloatArray, box: FloatArray) -> list[Violation]:
    found: list[Violation] = []
    for wall, name in enumerate(_WALLS):
        axis, side = divmod(wall, 2)
        inside = (centres[:, axis] - box[axis, side]) * (1 if side == 0 else -1)
        bad = np.flatnonzero((inside <= radii) & (np.abs(inside) > _ON_WALL * radii))
        found += [
            Violation(
                f"centres[{k}].{'xyz'[axis]}",
                float(centres[k, axis]),
                f"more than the radius {radii[k]} m inside the {name} wall at "
                f"{box[axis, side]} m, or on it",
            )
            for k in bad.tolist()
        ]
    return _shortened(found)


def _shortened(found: list[Violation], count: int | None = None) -> list[Violation]:
    count = len(found) if count is None else count
    if count <= MOST_LISTED:
        return found
    rest = Violation("and more", count - MOST_LISTED, "none")
    return [*found[:MOST_LISTED], rest]
