"""A thin layer that resists like springs side by side, between two elastic half-spaces.

Unknown is the normal traction p(s) on the disk 0 < s < 1. Of all tractions with the same resultant
the true one has the least complementary energy, so a stiffness from trial tractions is never above
the exact one.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from itertools import pairwise

import numpy as np
from numpy.polynomial.legendre import leggauss, legvander

from bondcell.cell import FloatArray

RATIO = 0.3
"""Neighbouring rings shrink by this towards the axis, where a narrow gap focuses the traction."""

INNERMOST = 1e-7
"""Radius of the innermost disk: well below sqrt(L_g/R) of a gap of 1e-12 R."""

EDGE_RINGS = 3
"""Rings added at the edge of the cement, where stiff cement has a square-root singularity."""

EDGE_RATIO = 0.2
"""They shrink by this towards the edge."""

DEGREE = 2
"""Degree in 1/s of the traction on each ring; 1/s^2 is what rigid particles near contact give."""

RELATIVE_ERROR = 2e-4
"""Bound of the discretisation, see tests/verification/test_cementation.py."""

BATCH = 256
"""Systems solved at once, to bound the memory."""


@dataclass(frozen=True)
class Operators:
    """Matrices of the trial tractions p = sum of c_k b_k(s), integrals over 0 < s < 1.

    Parameters
    ----------
    resultant
        ``f_k = integral of b_k s ds``.
    uniform
        ``integral of b_k b_l s ds``, a layer of constant thickness.
    parabolic
        ``integral of s^2 b_k b_l s ds``, a layer that thickens outward.
    half_spaces
        ``integral of q_k q_l dt``, ``q_k(t) = integral of b_k s ds / sqrt(s^2 - t^2)`` over s > t:
        the work of p on the settlement of a half-space (Boussinesq, in Copson's form).
    """

    resultant: FloatArray
    uniform: FloatArray
    parabolic: FloatArray
    half_spaces: FloatArray


def compliance_factor(
    gap: FloatArray, flexibility: FloatArray, matrices: Operators | None = None
) -> FloatArray:
    """Resultant of the traction that closes the layer by one, in units of the layer.

    Parameters
    ----------
    gap
        Thickness on the axis G of a layer ``G + s^2`` thick, any shape.
    flexibility
        Settlement of the two half-spaces against that of the layer, ``c``; 0 for rigid ones.
    matrices
        Another discretisation than the default one.

    Returns
    -------
    ndarray
        ``Y = f . A^-1 f``, ``A = G uniform + parabolic + c half_spaces``; low by at most
        `RELATIVE_ERROR`.

    Examples
    --------
    Rigid half-spaces: ``Y = log(1 + 1/G) / 2``.

    >>> float(compliance_factor(np.array(0.1), np.array(0.0)).round(4))
    1.1989
    """
    gap, flexibility = np.broadcast_arrays(gap, flexibility)
    shape = gap.shape
    gaps, flexibilities = gap.reshape(-1, 1, 1), flexibility.reshape(-1, 1, 1)
    op = operators() if matrices is None else matrices
    load = op.resultant[:, None]
    result = np.empty(gaps.shape[0])
    for start in range(0, result.size, BATCH):
        part = slice(start, start + BATCH)
        matrix = gaps[part] * op.uniform + op.parabolic + flexibilities[part] * op.half_spaces
        result[part] = (load.T @ np.linalg.solve(matrix, load)).ravel()
    return result.reshape(shape)


@cache
def operators(
    ratio: float = RATIO, edge_rings: int = EDGE_RINGS, degree: int = DEGREE
) -> Operators:
    """The matrices of a discretisation, assembled once."""
    borders = _borders(ratio, edge_rings)
    heights, weights = _settlement_points(borders)
    blocks = [_ring(inner, outer, degree, heights) for inner, outer in pairwise(borders)]
    size = sum(block[0].size for block in blocks)
    resultant, uniform, parabolic = np.empty(size), np.zeros((size, size)), np.zeros((size, size))
    transforms = np.empty((size, heights.size))
    start = 0
    for forces, mass, moment, transform in blocks:
        here = slice(start, start + forces.size)
        resultant[here], transforms[here] = forces, transform
        uniform[here, here], parabolic[here, here] = mass, moment
        start += forces.size
    return Operators(resultant, uniform, parabolic, (transforms * weights) @ transforms.T)


def _borders(ratio: float, edge_rings: int) -> FloatArray:
    """Radii of the rings' borders, from 0 to 1."""
    count = int(np.ceil(np.log(INNERMOST) / np.log(ratio)))
    inner = ratio ** np.arange(count, 0, -1)
    edge = 1.0 - (1.0 - ratio) * EDGE_RATIO ** np.arange(1, edge_rings + 1)
    return np.concatenate(([0.0], inner, edge, [1.0]))


def _settlement_points(borders: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Quadrature in t; q(t) has a square root below each border, which t = border - y^2 removes."""
    node, weight = leggauss(12)
    y = (node + 1.0) / 2.0
    width = np.diff(borders)[:, None]
    return (borders[1:, None] - width * y**2).ravel(), (width * y * weight).ravel()


def _ring(
    inner: float, outer: float, degree: int, heights: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Resultants, the two layer matrices and the transforms q of one ring's trial tractions."""
    node, weight = leggauss(12)
    half, middle = (outer**2 - inner**2) / 2.0, (outer**2 + inner**2) / 2.0
    square = middle + half * node
    measure = weight * half / 2.0  # s ds = d(s^2) / 2
    trial = _trial(np.sqrt(square), inner, outer, degree)
    mass = (trial * measure) @ trial.T
    moment = (trial * (measure * square)) @ trial.T

    # With sigma^2 = s^2 - t^2 the singular weight becomes s ds / sqrt(s^2 - t^2) = d sigma.
    node, weight = leggauss(24)
    top = np.sqrt(np.maximum(outer**2 - heights**2, 0.0))
    bottom = np.sqrt(np.maximum(inner**2 - heights**2, 0.0))
    sigma = bottom[:, None] + np.outer(top - bottom, (node + 1.0) / 2.0)
    radius = np.sqrt(np.clip(sigma**2 + heights[:, None] ** 2, inner**2, outer**2))
    transform = (_trial(radius, inner, outer, degree) @ weight) * (top - bottom) / 2.0
    return trial @ measure, mass, moment, transform


def _trial(radius: FloatArray, inner: float, outer: float, degree: int) -> FloatArray:
    """Trial tractions, trial first: polynomials in 1/s on a ring, a constant on the disk."""
    if inner == 0.0:
        return np.ones((1, *radius.shape))
    scaled = (2.0 / radius - 1.0 / inner - 1.0 / outer) / (1.0 / outer - 1.0 / inner)
    polynomials: FloatArray = np.asarray(legvander(scaled, degree), dtype=np.float64)
    return np.moveaxis(polynomials, -1, 0)
