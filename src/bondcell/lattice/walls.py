"""Walls: what ties several nodes of a lattice to the ground at once."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from bondcell.cell import FloatArray
from bondcell.errors import InputError, Violation


@dataclass(frozen=True)
class Wall:
    """Stiffness of a wall; build it with `wall`, which checks it.

    Parameters
    ----------
    nodes
        Nodes that feel it, shape (k,).
    stiffness
        Forces [N] and moments [N m] by their motions [m, rad], node by node, shape (k width, k
        width). Spheres that press matrix against a wall together are coupled.
    """

    nodes: NDArray[np.int64]
    stiffness: FloatArray


def wall(nodes: ArrayLike, stiffness: ArrayLike) -> Wall:
    """Check the stiffness of a wall.

    Raises
    ------
    InputError
        The matrix is not square, not symmetric, or gives energy away.
    """
    own = np.asarray(nodes, dtype=np.int64).ravel()
    matrix = np.asarray(stiffness, dtype=np.float64)
    if matrix.ndim != 2 or matrix.shape[0] != matrix.shape[1] or not np.isfinite(matrix).all():
        raise InputError([Violation("stiffness", matrix.shape, "a square matrix of numbers")])
    size = np.sqrt(np.abs(np.diag(matrix)))
    scaled = matrix / np.maximum(size[:, np.newaxis] * size, np.finfo(float).tiny)
    if np.abs(scaled - scaled.T).max() > 1e-6:
        raise InputError([Violation("stiffness", matrix.tolist(), "a symmetric matrix")])
    lowest = float(np.linalg.eigvalsh(scaled)[0])
    if lowest < -1e-6:
        allowed = "no negative eigenvalue (of the matrix with unit diagonal)"
        raise InputError([Violation("stiffness", lowest, allowed)])
    return Wall(own, (matrix + matrix.T) / 2)
