"""Pockets of a plane lattice after large motions: forces and tangent."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from bondcell.cell import FloatArray
from bondcell.lattice.lattice import Lattice


def add_pockets(
    lattice: Lattice, motion: FloatArray, force: FloatArray, tangent: FloatArray
) -> float:
    """Add the pockets' forces and tangent; their energy [J].

    The deviator is that of the triangle's right stretch, to second order
    ``F^T F`` with F the deformation gradient; the area is exact.
    """
    own, width = lattice.pockets, lattice.width
    if not own.count:
        return 0.0
    rows = lattice.pocket_strains()[:, :3].reshape(own.count, 3, 3, width)[..., :2]
    # Gradients of the linear functions, in the triangle's own axes, back from its strains.
    corners = lattice.points[own.corners]
    one = corners[:, 1] - corners[:, 0]
    one = one / np.linalg.norm(one, axis=1, keepdims=True)
    two = np.stack([-one[:, 1], one[:, 0]], axis=1)
    cross = np.linalg.det(np.stack([one, corners[:, 2] - corners[:, 0]], axis=1))
    two = two * np.sign(cross)[:, np.newaxis]
    along = np.einsum("tkd,td->tk", rows[:, 0] + rows[:, 1], one) / 2
    over = np.einsum("tkd,td->tk", rows[:, 0] - rows[:, 1], two) / 2
    now = corners + motion[own.corners][..., :2]
    # Columns of F in those axes: dx/de1, dx/de2.
    a = np.einsum("tk,tkd->td", along, now)
    b = np.einsum("tk,tkd->td", over, now)
    unknowns = (width * own.corners[:, :, np.newaxis] + np.arange(2)).reshape(own.count, -1)
    eye = np.eye(2)

    def lifted(weights: FloatArray, vector: FloatArray) -> FloatArray:
        return (weights[:, :, np.newaxis] * vector[:, np.newaxis]).reshape(own.count, -1)

    def quadratic(left: FloatArray, right: FloatArray) -> FloatArray:
        product = left[:, :, None, None, None] * eye[:, None, :] * right[:, None, None, :, None]
        return np.asarray(product.reshape(own.count, 6, 6))

    turn = np.array([[0.0, 1.0], [-1.0, 0.0]])
    sign = np.sign(cross)
    area = sign * (a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]) - 1
    area_slope = sign[:, None] * (lifted(along, b @ turn.T) - lifted(over, a @ turn.T))
    mixed = along[:, :, None, None, None] * turn[:, None, :] * over[:, None, None, :, None]
    area_bend = sign[:, None, None] * mixed.reshape(own.count, 6, 6)
    area_bend = area_bend + area_bend.transpose(0, 2, 1)
    first = ((a**2).sum(axis=1) - (b**2).sum(axis=1)) / 2
    first_slope = lifted(along, a) - lifted(over, b)
    first_bend = quadratic(along, along) - quadratic(over, over)
    shear = (a * b).sum(axis=1)
    shear_slope = lifted(along, b) + lifted(over, a)
    shear_bend = quadratic(along, over) + quadratic(over, along)
    energy = 0.0
    for stiff, value, slope, bend in (
        (own.stiffness, area, area_slope, area_bend),
        (own.deviator, first, first_slope, first_bend),
        (own.deviator, shear, shear_slope, shear_bend),
    ):
        energy += float((stiff * value**2).sum() / 2)
        add_springs(force, tangent, unknowns, stiff, value, slope, bend)
    return energy


def outer(one: FloatArray, other: FloatArray) -> FloatArray:
    """Products of the components of rows, shape (rows, n, m)."""
    return one[:, :, np.newaxis] * other[:, np.newaxis]


def add_springs(
    force: FloatArray,
    tangent: FloatArray,
    unknowns: NDArray[np.int64],
    stiffness: FloatArray,
    value: FloatArray,
    slope: FloatArray,
    bend: FloatArray,
) -> None:
    """Add springs ``k e^2 / 2`` to forces and tangent."""
    np.add.at(force, unknowns, (stiffness * value)[:, np.newaxis] * slope)
    local = outer(slope, slope) + value[:, None, None] * bend
    at = (unknowns[:, :, np.newaxis], unknowns[:, np.newaxis])
    np.add.at(tangent, at, stiffness[:, None, None] * local)
