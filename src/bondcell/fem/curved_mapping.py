"""High-order isoparametric mapping: element geometry interpolated at Gauss-Lobatto points."""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.special import roots_jacobi
from skfem import MeshQuad
from skfem.mapping import MappingIsoparametric

from bondcell.cell import FloatArray


@lru_cache(maxsize=64)
def lobatto_points(order: int) -> FloatArray:
    """The ``order + 1`` Gauss-Lobatto points of [0, 1], end points included."""
    if order == 1:
        return np.array([0.0, 1.0])
    inner, _ = roots_jacobi(order - 1, 1.0, 1.0)
    return np.concatenate(([0.0], (inner + 1) / 2, [1.0]))


def lagrange_tables(order: int, at: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Lagrange polynomials on the Gauss-Lobatto points, and their derivatives.

    Parameters
    ----------
    order
        Polynomial degree.
    at
        Evaluation points in [0, 1], shape (q,).

    Returns
    -------
    values, derivatives
        Both of shape (order + 1, q).
    """
    points = lobatto_points(order)
    distances = points[:, None] - points[None, :]
    np.fill_diagonal(distances, 1.0)
    denominators = distances.prod(axis=1)
    values = np.empty((order + 1, at.size))
    for k in range(order + 1):
        values[k] = np.prod(at - np.delete(points, k)[:, None], axis=0) / denominators[k]
    # nodal[i, k] is the derivative of polynomial k at point i; rows sum to zero.
    nodal = denominators[:, None] / denominators[None, :] / distances
    np.fill_diagonal(nodal, 0.0)
    np.fill_diagonal(nodal, -nodal.sum(axis=1))
    return values, nodal.T @ values


@lru_cache(maxsize=64)
def _grid_tables(order: int, at: tuple[float, ...]) -> tuple[FloatArray, FloatArray]:
    """`lagrange_tables` at points that every mesh asks for."""
    return lagrange_tables(order, np.array(at))


class CurvedMapping(MappingIsoparametric):
    """Mapping of each reference square onto a curved quadrilateral.

    Parameters
    ----------
    mesh
        Topology (its straight-sided vertices are not used for the geometry).
    nodes
        Positions of the tensor Gauss-Lobatto nodes, shape (2, elements, order + 1, order + 1):
        coordinate, element, node along the first and second reference direction [m].

    Notes
    -----
    The geometry's order equals the displacement's, so that rigid motions stay in the space, and the
    interpolation of a circular arc converges as fast as the field.
    """

    def __init__(self, mesh: MeshQuad, nodes: FloatArray) -> None:
        super().__init__(mesh, mesh.elem(), None)
        self.nodes = nodes
        self.order = nodes.shape[-1] - 1

    def _evaluate(
        self, i: int, X: FloatArray, tind: NDArray[Any] | None, derivative: int | None
    ) -> FloatArray:
        x, dx = lagrange_tables(self.order, X[0])
        y, dy = lagrange_tables(self.order, X[1])
        if derivative == 0:
            x = dx
        elif derivative == 1:
            y = dy
        nodes = self.nodes[i] if tind is None else self.nodes[i][tind]
        return np.asarray(((nodes @ y) * x).sum(axis=1))

    def on_grid(
        self, points: FloatArray, elements: slice = slice(None)
    ) -> tuple[FloatArray, FloatArray]:
        """Coordinates and their derivatives at a tensor grid of reference points.

        Parameters
        ----------
        points
            Reference points of either direction, shape (q,).
        elements
            Elements wanted.

        Returns
        -------
        place
            Shape (2, elements, q^2) [m].
        jacobian
            Coordinate by reference direction, shape (2, 2, elements, q^2) [m].
        """
        value, slope = _grid_tables(self.order, tuple(points))
        nodes = self.nodes[:, elements]
        shape = (*nodes.shape[:2], points.size**2)
        along, across = nodes @ value, nodes @ slope
        place = (value.T @ along).reshape(shape)
        jacobian = [(slope.T @ along).reshape(shape), (value.T @ across).reshape(shape)]
        return place, np.stack(jacobian, axis=1)

    def Fmap(self, i: int, X: FloatArray, tind: NDArray[Any] | None = None) -> FloatArray:
        """Coordinate ``i`` at reference points ``X``, shape (elements, points) [m]."""
        return self._evaluate(i, X, tind, None)

    def _J(self, i: int, j: int, X: FloatArray, tind: NDArray[Any] | None = None) -> FloatArray:
        return self._evaluate(i, X, tind, j)
