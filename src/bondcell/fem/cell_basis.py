"""Scalar hierarchical basis on curved quadrilaterals, kept as a tensor product.

Every shape function of scikit-fem's `ElementQuadP` is a product of two functions of its
`ElementLinePp`, and the Gauss rule is a product as well. Sums over points therefore split into one
sum a direction, which is what makes high order cheap.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray
from skfem import Basis, MeshQuad
from skfem.assembly.basis.abstract_basis import AbstractBasis
from skfem.element import DiscreteField, ElementLinePp, ElementQuadP

from bondcell.cell import FloatArray
from bondcell.fem.curved_mapping import CurvedMapping

EXTRA_POINTS = 2
"""Gauss points a direction beyond the order: curved geometry and 1/r are not polynomials."""


@lru_cache(maxsize=64)
def gauss_line(count: int) -> tuple[FloatArray, FloatArray]:
    """Gauss rule on [0, 1]: points and weights, shape (count,)."""
    x, w = np.polynomial.legendre.leggauss(count)
    return (x + 1) / 2, w / 2


def gauss_square(count: int) -> tuple[FloatArray, FloatArray]:
    """Tensor Gauss rule on the unit square: points (2, count^2) and weights."""
    x, w = gauss_line(count)
    points = np.array([np.repeat(x, count), np.tile(x, count)])
    return points, np.outer(w, w).ravel()


@dataclass(frozen=True)
class LineTables:
    """Shape functions of one direction at the Gauss points.

    Parameters
    ----------
    value, slope
        Shape (order + 1, points).
    first, second
        Which function of each direction makes up a shape function of the square, shape
        ((order + 1)^2,).
    """

    value: FloatArray
    slope: FloatArray
    first: NDArray[np.int64]
    second: NDArray[np.int64]


@lru_cache(maxsize=32)
def line_tables(order: int, count: int) -> LineTables:
    """Tables of scikit-fem's element, once an order."""
    line = ElementLinePp(order)
    tables = [line.lbasis(gauss_line(count)[0][None], k) for k in range(order + 1)]
    value = np.array([phi for phi, _ in tables])
    slope = np.array([dphi[0] for _, dphi in tables])
    points, _ = gauss_square(count)
    square = ElementQuadP(order)
    shapes = np.array([square.lbasis(points, k)[0] for k in range((order + 1) ** 2)])
    # In the basis of all products each shape function has a single coefficient, which is one.
    inverse = np.linalg.pinv(value)
    coefficients = inverse.T @ shapes.reshape(-1, count, count) @ inverse
    first, second = np.divmod(np.abs(coefficients).reshape(len(shapes), -1).argmax(1), order + 1)
    return LineTables(value, slope, first, second)


class ElementPoints:
    """Geometry at the Gauss points of some elements.

    Parameters
    ----------
    mapping
        Curved geometry of all elements; its order is the displacement's.
    elements
        Which of them; all by default.

    Attributes
    ----------
    place
        Coordinates (r, z), shape (2, elements, points) [m].
    jacobian, determinant
        Of the mapping, shapes (2, 2, elements, points) [m] and (elements, points) [m2].
    dx
        Weights of the Gauss rule on the section, shape (elements, points) [m2].
    """

    def __init__(self, mapping: CurvedMapping, elements: slice = slice(None)) -> None:
        self.order = mapping.order
        self.along = self.order + EXTRA_POINTS
        points, weights = gauss_line(self.along)
        self.place, self.jacobian = mapping.on_grid(points, elements)
        (rx, ry), (zx, zy) = self.jacobian
        self.determinant = rx * zy - ry * zx
        self.dx = np.abs(self.determinant) * np.outer(weights, weights).ravel()

    @property
    def shapes(self) -> int:
        """Shape functions of an element."""
        return (self.order + 1) ** 2

    @property
    def tables(self) -> LineTables:
        """Shape functions of one direction."""
        return line_tables(self.order, self.along)


class CellBasis(Basis):
    """Basis of one displacement component at the Gauss points of every element.

    Parameters
    ----------
    mesh
        Topology.
    mapping
        Curved geometry.
    order
        Polynomial order.

    Notes
    -----
    scikit-fem numbers the unknowns and provides the element. Geometry at the points, and the tables
    of every shape function there, which only bilinear forms want, are made on demand.
    """

    def __init__(self, mesh: MeshQuad, mapping: CurvedMapping, order: int) -> None:
        AbstractBasis.__init__(
            self,
            mesh,
            _element(order),
            mapping,
            quadrature=gauss_square(order + EXTRA_POINTS),
            disable_doflocs=True,
        )
        # Where unknowns lie is never asked for: most functions of this element have no place.
        self.doflocs = np.empty((2, 0))
        self.tind, self.nelems = None, mesh.nelements

    @cached_property
    def points(self) -> ElementPoints:
        """Geometry at the points of all elements."""
        return ElementPoints(self.mapping)

    @property
    def dx(self) -> FloatArray:
        """Weights of the Gauss rule, shape (elements, points) [m2]."""
        return self.points.dx

    @cached_property
    def basis(self) -> list[tuple[Any, ...]]:
        """Values and gradients of every shape function, as scikit-fem's forms take them."""
        return [self.elem.gbasis(self.mapping, self.X, k) for k in range(self.Nbfun)]

    def global_coordinates(self) -> DiscreteField:
        """Coordinates (r, z) of the Gauss points, shape (2, elements, points) [m]."""
        return DiscreteField(self.points.place)


@lru_cache(maxsize=32)
def _element(order: int) -> ElementQuadP:
    return ElementQuadP(order)


def cell_basis(mesh: MeshQuad, mapping: CurvedMapping, order: int) -> CellBasis:
    """Scalar hierarchical basis of one displacement component on the curved mesh."""
    return CellBasis(mesh, mapping, order)
