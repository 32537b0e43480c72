"""Rigid motions of a lattice."""

from __future__ import annotations

import numpy as np

from bondcell.cell import FloatArray


def rigid_modes(points: FloatArray, rotates: bool) -> FloatArray:
    """Translations, then rotations about the mean point, shape (nodes, width, 3 or 6).

    Examples
    --------
    >>> rigid_modes(np.array([[0.0, 4.0], [0.0, 0.0]]), rotates=True)[1].tolist()
    [[1.0, 0.0, 2.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
    """
    count, dimension = points.shape
    arm = points - points.mean(axis=0)
    turns = 1 if dimension == 2 else 3
    result = np.zeros((count, dimension + turns, dimension + turns))
    result[:] = np.eye(dimension + turns)
    if dimension == 2:
        result[:, 0, 2], result[:, 1, 2] = -arm[:, 1], arm[:, 0]
    else:
        for axis in range(3):
            result[:, :3, 3 + axis] = np.cross(np.eye(3)[axis], arm)
    return result if rotates else result[:, :dimension]
