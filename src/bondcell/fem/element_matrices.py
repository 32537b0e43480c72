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

from bondcell.cell import FloatArray
from bondcell.fem.cell_basis import CellBasis, cell_basis, gauss_square
from bondcell.fem.strain import D_R, D_Z, DEVIATOR, OVER_R, TRACE, FourierMode
from bondcell.fem.tensor_sums import sum_products, sum_shapes

__all__ = ["ElementMatrices", "cell_basis", "element_matrices", "gauss_square"]


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


def element_matrices(basis: CellBasis, mode: FourierMode, projected: bool) -> ElementMatrices:
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
    radius = basis.place[0]
    weight = np.sqrt(mode.angle_integral * basis.dx * radius)
    pulled = _pulled_back(basis, radius) * weight
    return ElementMatrices(
        shear=_shear(pulled, mode, basis),
        bulk_root=_bulk_root(pulled, mode, weight, basis, projected),
    )


def _pulled_back(basis: CellBasis, radius: FloatArray) -> FloatArray:
    """Coefficients of (value, d/dx, d/dy) in (value/r, d/dr, d/dz), shape (3, 3, elements, q)."""
    (rx, ry), (zx, zy) = basis.jacobian
    result = np.zeros((3, 3, *radius.shape))
    result[OVER_R, 0] = 1 / radius
    result[D_R, 1:] = np.array([zy, -zx]) / basis.determinant
    result[D_Z, 1:] = np.array([-ry, rx]) / basis.determinant
    return result


def _shear(pulled: FloatArray, mode: FourierMode, basis: CellBasis) -> FloatArray:
    components, elements = len(mode.components), pulled.shape[2]
    q, shapes = basis.points_along, basis.Nbfun
    coefficients = 2 * np.einsum("cxs,st,dyt->cdxy", mode.strain, DEVIATOR, mode.strain)
    # Products of two entries of `pulled` at the points: by (x, y), then by the pair of kinds.
    products = (pulled[:, None, :, None] * pulled[None, :, None, :]).reshape(9, -1)
    shear = np.empty((elements, components, shapes, components, shapes))
    for c in range(components):
        for d in range(c, components):
            fields = (coefficients[c, d].reshape(9) @ products).reshape(3, 3, elements, q, q)
            block = sum_products(fields, basis.elem.p)
            shear[:, c, :, d] = block
            if c != d:
                shear[:, d, :, c] = block.transpose(0, 2, 1)
    return shear.reshape(elements, components * shapes, components * shapes)


def _bulk_root(
    pulled: FloatArray, mode: FourierMode, weight: FloatArray, basis: CellBasis, projected: bool
) -> FloatArray:
    components, elements = len(mode.components), len(weight)
    trace = np.einsum("cxs,s->cx", mode.strain, TRACE)
    if not trace.any():
        return np.zeros((elements, 0, components * basis.Nbfun))
    dilatation = np.tensordot(trace, pulled, 1)
    if projected:
        pressures = _pressure_table(basis.elem.p, basis.points_along) * weight[:, :, None]
        orthonormal, _ = np.linalg.qr(pressures)
        rows = np.ascontiguousarray(orthonormal.transpose(0, 2, 1))
    else:
        # Any orthonormal basis of the quadrature points will do, constant first.
        rows = _householder(weight / np.linalg.norm(weight, axis=1, keepdims=True))
    q = basis.points_along
    root = np.empty((elements, rows.shape[1], components, basis.Nbfun))
    for c in range(components):
        fields = dilatation[c][:, :, None] * rows
        root[:, :, c] = sum_shapes(fields.reshape(3, -1, q, q), basis.tables).reshape(
            elements, -1, basis.Nbfun
        )
    return root.reshape(elements, -1, components * basis.Nbfun)


def _householder(unit: FloatArray) -> FloatArray:
    """Orthogonal matrices whose first rows are the given unit vectors, shape (elements, n, n)."""
    reflected = unit.copy()
    reflected[:, 0] += 1.0
    norm = np.einsum("en,en->e", reflected, reflected)
    identity = np.eye(unit.shape[1])
    matrix = identity - 2 * reflected[:, :, None] * reflected[:, None, :] / norm[:, None, None]
    return np.asarray(-matrix)
