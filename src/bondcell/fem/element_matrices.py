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
from bondcell.fem.cell_basis import ElementPoints, gauss_line
from bondcell.fem.strain import D_R, D_Z, DEVIATOR, OVER_R, TRACE, FourierMode
from bondcell.fem.tensor_sums import (
    component_pairs,
    dilatations,
    pressure_line,
    pressure_pairs,
    product_places,
    sum_products,
    sum_shapes,
)


@dataclass(frozen=True)
class ElementMatrices:
    """Element matrices, cut into the unknowns inside an element and on its boundary.

    Either kind is in the order (component, shape function).

    Parameters
    ----------
    inner, link, outer
        Of ``2 mu |dev eps|^2`` at ``mu = 1``: inside with inside, boundary with inside, boundary
        with boundary; shapes (elements, i, i), (elements, o, i), (elements, o, o).
    root_inner, root_outer
        ``R`` above, shapes (elements, pressures, i) and (elements, pressures, o); the first row is
        the element's mean dilatation, and there is none where the mode has no dilatation.
    """

    inner: FloatArray
    link: FloatArray
    outer: FloatArray
    root_inner: FloatArray
    root_outer: FloatArray

    def of(self, elements: slice) -> ElementMatrices:
        """Those of some elements."""
        return ElementMatrices(
            *(
                block[elements]
                for block in (self.inner, self.link, self.outer, self.root_inner, self.root_outer)
            )
        )

    @property
    def shear(self) -> FloatArray:
        """The shear matrices in one piece, unknowns inside first, shape (elements, n, n)."""
        upper = np.concatenate((self.inner, self.link.transpose(0, 2, 1)), axis=2)
        return np.concatenate((upper, np.concatenate((self.link, self.outer), axis=2)), axis=1)

    @property
    def bulk_root(self) -> FloatArray:
        """``R`` in one piece, unknowns inside first, shape (elements, pressures, n)."""
        return np.concatenate((self.root_inner, self.root_outer), axis=2)

    @property
    def pressures(self) -> int:
        """Pressures of an element."""
        return int(self.root_inner.shape[1])


def element_matrices(points: ElementPoints, mode: FourierMode, projected: bool) -> ElementMatrices:
    """Assemble both matrices of every element.

    Parameters
    ----------
    points
        The elements' geometry at their Gauss points; its order is the displacement's.
    mode
        Fourier mode of the displacement.
    projected
        Project the dilatation on polynomials of degree below the order (mixed form), or keep it
        as it is (displacement form: an upper bound of the stiffness, but it locks near nu = 1/2).
    """
    radius = points.place[0]
    measure = mode.angle_integral * points.dx * radius
    pulled = _pulled_back(points, radius)
    return ElementMatrices(
        *_shear(pulled, measure, mode, points),
        *_bulk_root(pulled, measure, mode, points, projected),
    )


def _pulled_back(points: ElementPoints, radius: FloatArray) -> FloatArray:
    """Coefficients of (value, d/dx, d/dy) in (value/r, d/dr, d/dz), shape (3, 3, elements, q)."""
    (rx, ry), (zx, zy) = points.jacobian
    result = np.zeros((3, 3, *radius.shape))
    result[OVER_R, 0] = 1 / radius
    result[D_R, 1:] = np.array([zy, -zx]) / points.determinant
    result[D_Z, 1:] = np.array([-ry, rx]) / points.determinant
    return result


def _shear(
    pulled: FloatArray, measure: FloatArray, mode: FourierMode, points: ElementPoints
) -> tuple[FloatArray, FloatArray, FloatArray]:
    components, elements = len(mode.components), pulled.shape[2]
    order, q = points.order, points.along
    coefficients = 2 * np.einsum("cxs,st,dyt->cdxy", mode.strain, DEVIATOR, mode.strain)
    # Products of two entries of `pulled` at the points: by (x, y), then by the pair of kinds.
    products = (pulled[:, None, :, None] * (pulled * measure)[None, :, None, :]).reshape(9, -1)
    pairs = component_pairs(components)
    sums = np.empty((elements, len(pairs), points.shapes, points.shapes))
    for k, (c, d) in enumerate(pairs):
        fields = (coefficients[c, d].reshape(9) @ products).reshape(3, 3, elements, q, q)
        sum_products(fields, order, out=sums[:, k])
    flat = sums.reshape(elements, -1)
    inner, link, outer = (
        flat.take(place, axis=1, mode="clip") for place in product_places(order, q, components)
    )
    return inner, link, outer


def _bulk_root(
    pulled: FloatArray,
    measure: FloatArray,
    mode: FourierMode,
    points: ElementPoints,
    projected: bool,
) -> tuple[FloatArray, FloatArray]:
    components, elements = len(mode.components), len(measure)
    trace = np.einsum("cxs,s->cx", mode.strain, TRACE)
    edge = 4 * points.order
    inside = points.shapes - edge
    if not trace.any():
        return np.zeros((elements, 0, components * inside)), np.zeros(
            (elements, 0, components * edge)
        )
    dilatation = np.tensordot(trace, pulled, 1)
    make = _projected_roots if projected else _plain_roots
    inner, outer = [], []
    for root in make(dilatation, measure, points):
        outer.append(root[:, :, :edge])
        inner.append(root[:, :, edge:])
    return np.concatenate(inner, axis=2), np.concatenate(outer, axis=2)


def _projected_roots(
    dilatation: FloatArray, measure: FloatArray, points: ElementPoints
) -> list[FloatArray]:
    """``R`` of each component, with pressures made orthonormal by their Gram matrix's factor."""
    order, q = points.order, points.along
    table = _pressure_table(order, q)
    gram = table.T @ (measure[:, :, None] * table)
    orthonormal = np.linalg.inv(np.linalg.cholesky(gram))
    return [
        orthonormal @ dilatations((component * measure).reshape(3, -1, q, q), order)
        for component in dilatation
    ]


def _plain_roots(
    dilatation: FloatArray, measure: FloatArray, points: ElementPoints
) -> list[FloatArray]:
    """``R`` of each component, with a pressure for every quadrature point, constant first."""
    q = points.along
    weight = np.sqrt(measure)
    rows = _householder(weight / np.linalg.norm(weight, axis=1, keepdims=True))
    roots = []
    for component in dilatation:
        fields = (component * weight)[:, :, None] * rows
        root = sum_shapes(fields.reshape(3, -1, q, q), points.tables)
        roots.append(root.reshape(len(weight), -1, points.shapes))
    return roots


@lru_cache(maxsize=32)
def _pressure_table(order: int, count: int) -> FloatArray:
    """Pressures at the Gauss points, constant first, shape (points, pressures)."""
    legendre = pressure_line(order, gauss_line(count)[0])
    along, across = pressure_pairs(order)
    return np.ascontiguousarray(
        (legendre[along][:, :, None] * legendre[across][:, None, :]).reshape(along.size, -1).T
    )


def _householder(unit: FloatArray) -> FloatArray:
    """Orthogonal matrices whose first rows are the given unit vectors, shape (elements, n, n)."""
    reflected = unit.copy()
    reflected[:, 0] += 1.0
    norm = np.einsum("en,en->e", reflected, reflected)
    identity = np.eye(unit.shape[1])
    matrix = identity - 2 * reflected[:, :, None] * reflected[:, None, :] / norm[:, None, None]
    return np.asarray(-matrix)
