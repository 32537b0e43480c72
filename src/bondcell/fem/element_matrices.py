"""Bulk and shear matrices of all elements, for unit moduli.

The energy density of an isotropic solid splits without coupling::

    sigma : eps = kappa (tr eps)^2 + 2 mu |dev eps|^2

so every element needs two matrices once a geometry; any modulus, Poisson's ratio or Prony state
is a sum of them. The bulk part is kept as a root ``R`` with ``tr eps`` projected on the element's
pressure space, ``integral (tr eps)^2 = |R u|^2``, which is what a mixed form needs and avoids
locking.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from skfem import Basis, MeshQuad
from skfem.element import ElementQuadP
from skfem.mapping import MappingIsoparametric

from bondcell.cell import FloatArray
from bondcell.fem.strain import DEVIATOR, TRACE, FourierMode

EXTRA_POINTS = 3
"""Gauss points a direction beyond the order: curved geometry and 1/r are not polynomials."""


@dataclass(frozen=True)
class ElementMatrices:
    """Element matrices in the local order (component, shape function).

    Parameters
    ----------
    shear
        Of ``2 mu |dev eps|^2`` at ``mu = 1``, shape (elements, n, n).
    bulk_root
        ``R`` above, shape (elements, pressures, n); the first row is the element's mean
        dilatation, and there is none where the mode has no dilatation.
    """

    shear: FloatArray
    bulk_root: FloatArray


def gauss_square(count: int) -> tuple[FloatArray, FloatArray]:
    """Tensor Gauss rule on the unit square: points (2, count^2) and weights."""
    x, w = np.polynomial.legendre.leggauss(count)
    x, w = (x + 1) / 2, w / 2
    points = np.array([np.repeat(x, count), np.tile(x, count)])
    return points, np.outer(w, w).ravel()


def cell_basis(mesh: MeshQuad, mapping: MappingIsoparametric, order: int) -> Basis:
    """Scalar hierarchical basis of one displacement component on the curved mesh."""
    return Basis(
        mesh, ElementQuadP(order), mapping=mapping, quadrature=gauss_square(order + EXTRA_POINTS)
    )


@lru_cache(maxsize=32)
def _pressure_table(order: int, count: int) -> FloatArray:
    """Polynomials of total degree below ``order`` at the Gauss points, constant first."""
    points, _ = gauss_square(count)
    legendre = [
        np.polynomial.legendre.legvander(2 * coordinate - 1, order - 1) for coordinate in points
    ]
    pairs = sorted(
        ((a, b) for a in range(order) for b in range(order - a)), key=lambda pair: sum(pair)
    )
    return np.stack([legendre[0][:, a] * legendre[1][:, b] for a, b in pairs], axis=-1)


def element_matrices(basis: Basis, mode: FourierMode, projected: bool) -> ElementMatrices:
    """Assemble both matrices of every element.

    Parameters
    ----------
    basis
        Scalar basis of one component, coordinates (r, z).
    mode
        Fourier mode of the displacement.
    projected
        Project the dilatation on polynomials of degree below the order (mixed form), or keep it
        as it is (displacement form: an upper bound of the stiffness, but it locks near nu = 1/2).
    """
    radius = basis.global_coordinates()[0]
    weight = np.sqrt(mode.angle_integral * basis.dx * radius)
    # tables[k] is value/r, d/dr, d/dz of every shape function, times the root of the weight.
    values = np.stack(
        [np.broadcast_to(np.asarray(phi[0]), weight.shape) for phi in basis.basis], axis=1
    )
    gradients = np.stack([phi[0].grad for phi in basis.basis], axis=2)
    tables = np.stack([values / radius[:, None], *gradients]) * weight[:, None]
    return ElementMatrices(
        shear=_shear(tables, mode), bulk_root=_bulk_root(tables, mode, weight, basis, projected)
    )


def _shear(tables: FloatArray, mode: FourierMode) -> FloatArray:
    components = len(mode.components)
    elements, shapes = tables.shape[1:3]
    coefficients = 2 * np.einsum(
        "cxs,st,dyt->cxdy", mode.strain, DEVIATOR, mode.strain, optimize=True
    )
    shear = np.zeros((elements, components, shapes, components, shapes))
    for x in range(3):
        for y in range(3):
            block = coefficients[:, x, :, y]
            if not block.any():
                continue
            product = tables[x] @ tables[y].transpose(0, 2, 1)
            for c, d in zip(*np.nonzero(block), strict=True):
                shear[:, c, :, d] += block[c, d] * product
    return shear.reshape(elements, components * shapes, components * shapes)


def _bulk_root(
    tables: FloatArray, mode: FourierMode, weight: FloatArray, basis: Basis, projected: bool
) -> FloatArray:
    elements, shapes, points = tables.shape[1:]
    trace = np.einsum("cxs,s->cx", mode.strain, TRACE)
    if not trace.any():
        return np.zeros((elements, 0, len(mode.components) * shapes))
    dilatation = np.zeros((elements, len(mode.components), shapes, points))
    for c, x in zip(*np.nonzero(trace), strict=True):
        dilatation[:, c] += trace[c, x] * tables[x]
    flat = dilatation.reshape(elements, -1, points).transpose(0, 2, 1)
    count = round(points**0.5)
    order = basis.elem.p if projected else count
    pressures = _pressure_table(order, count) * weight[:, :, None]
    if projected:
        orthonormal, _ = np.linalg.qr(pressures)
        return np.asarray(orthonormal.transpose(0, 2, 1) @ flat)
    # Without projection any orthonormal basis of the quadrature points will do, constant first.
    mean = weight / np.linalg.norm(weight, axis=1, keepdims=True)
    rotation = _householder(mean)
    return np.asarray(rotation @ flat)


def _householder(unit: FloatArray) -> FloatArray:
    """Orthogonal matrices whose first rows are the given unit vectors, shape (elements, n, n)."""
    reflected = unit.copy()
    reflected[:, 0] += 1.0
    norm = np.einsum("en,en->e", reflected, reflected)
    identity = np.eye(unit.shape[1])
    matrix = identity - 2 * reflected[:, :, None] * reflected[:, None, :] / norm[:, None, None]
    return np.asarray(-matrix)
