"""Lagrange tetrahedra of any order, curved like their nodes, and batched element matrices."""

from __future__ import annotations

from functools import cache

import numpy as np
from numpy.typing import NDArray

from bondcell.cell import FloatArray

EDGES = np.array([[0, 1], [1, 2], [0, 2], [0, 3], [1, 3], [2, 3]])
"""Corners of the six edges of a tetrahedron, in the order of their nodes."""

FACES = np.array([[0, 1, 2], [0, 1, 3], [0, 2, 3], [1, 2, 3]])
"""Corners of the four faces, in the order of their nodes."""

ORDERS = (2, 3, 4)
"""Orders of the displacements that are offered."""

QUADRATURE = {2: (2, 5), 3: (5, 7), 4: (6, 7)}
"""Order of displacements -> orders of quadrature on straight and on curved elements.

Twice the order of the strains is exact where the element is straight.
"""


@cache
def lattice_of(order: int) -> NDArray[np.int64]:
    """Nodes of the reference tetrahedron as ``order`` times their barycentric coordinates.

    Corners first, then edges (from their first corner to their second), faces, the inside: shape
    (nodes, 4).

    Examples
    --------
    >>> [len(lattice_of(order)) for order in (1, 2, 3, 4)]
    [4, 10, 20, 35]
    """
    eye = np.eye(4, dtype=np.int64)
    rows = [order * eye]
    for groups in (EDGES, FACES, np.arange(4)[np.newaxis]):
        # Reversed, the nodes of an edge come from its first corner to its second.
        inner = _compositions(order, groups.shape[1])[::-1]
        rows += [inner @ eye[group] for group in groups.tolist()]
    return np.concatenate(rows)


def _compositions(total: int, parts: int) -> NDArray[np.int64]:
    """Ways to write a number as a sum of positive ones, shape (ways, parts)."""
    if parts == 1:
        return np.full((min(total, 1), 1), total, dtype=np.int64)
    found = [
        np.column_stack([np.full(len(rest), first), rest])
        for first in range(1, total)
        if len(rest := _compositions(total - first, parts - 1))
    ]
    return np.concatenate(found) if found else np.empty((0, parts), dtype=np.int64)


def reference_nodes(order: int) -> FloatArray:
    """Nodes of the reference tetrahedron, shape (nodes, 3)."""
    return lattice_of(order)[:, 1:] / order


def order_of(nodes: int) -> int:
    """Order of an element with so many nodes.

    Examples
    --------
    >>> order_of(10)
    2
    """
    return {len(lattice_of(order)): order for order in (1, *ORDERS)}[nodes]


def shape_values(points: FloatArray, order: int = 2) -> FloatArray:
    """Shape functions at points of the reference element, shape (points, nodes).

    Notes
    -----
    The function of the node with ``order`` times its barycentric coordinates ``(a, b, c, d)`` is
    ``P_a(l_0) P_b(l_1) P_c(l_2) P_d(l_3)`` with ``P_m(l) = product over s < m of
    (order l - s)/(s + 1)``.
    """
    factors, _ = _factors(points, order)
    return np.asarray(factors.prod(axis=2))


def shape_gradients(points: FloatArray, order: int = 2) -> FloatArray:
    """Their gradients on the reference element, shape (points, nodes, 3)."""
    factors, slopes = _factors(points, order)
    of_coordinates = np.stack(
        [
            np.where(np.arange(4) == k, slopes, factors).prod(axis=2)
            for k in range(4)
        ],
        axis=2,
    )  # fmt: skip
    return np.asarray(of_coordinates @ np.vstack([-np.ones(3), np.eye(3)]))


def _factors(points: FloatArray, order: int) -> tuple[FloatArray, FloatArray]:
    """``P_m(l)`` and its derivative of each node and coordinate, shape (points, nodes, 4)."""
    coordinates = np.concatenate([1 - points.sum(axis=1, keepdims=True), points], axis=1)
    value, slope = [np.ones_like(coordinates)], [np.zeros_like(coordinates)]
    for s in range(order):
        step = (order * coordinates - s) / (s + 1)
        slope.append(slope[-1] * step + value[-1] * order / (s + 1))
        value.append(value[-1] * step)
    which = lattice_of(order)
    pick = (which, slice(None), np.arange(4))
    return (
        np.stack(value)[pick].transpose(2, 0, 1),
        np.stack(slope)[pick].transpose(2, 0, 1),
    )


def quadrature(order: int) -> tuple[FloatArray, FloatArray]:
    """Points (points, 3) and weights (points,) that integrate polynomials of an order exactly."""
    from skfem.quadrature import get_quadrature
    from skfem.refdom import RefTet

    points, weights = get_quadrature(RefTet, order)
    return np.ascontiguousarray(points.T), np.asarray(weights)


def jacobians(corners: FloatArray, gradients: FloatArray) -> FloatArray:
    """``dx_i/dX_j`` at points, shape (elements, points, 3, 3).

    Parameters
    ----------
    corners
        Nodes of the elements, shape (elements, nodes, 3).
    gradients
        Gradients of their shape functions, shape (points, nodes, 3).
    """
    return np.asarray(corners.transpose(0, 2, 1)[:, np.newaxis] @ gradients)


def physical_gradients(
    corners: FloatArray, reference: FloatArray, weights: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Gradients of the shape functions in space, and integration weights there.

    Parameters
    ----------
    corners
        Nodes of the elements, shape (elements, nodes, 3).
    reference, weights
        Gradients (points, nodes, 3) and weights (points,) on the reference element.

    Returns
    -------
    tuple
        Gradients (elements, points, nodes, 3) and weights (elements, points).
    """
    jacobian = jacobians(corners, reference)
    back, determinant = inverse(jacobian)
    # Corners may be counted either way round.
    return reference @ back, np.abs(determinant) * weights


def inverse(matrix: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Inverses and determinants of 3x3 matrices, by cofactors."""
    rows = [matrix[..., k, :] for k in range(3)]
    columns = [np.cross(rows[(k + 1) % 3], rows[(k + 2) % 3]) for k in range(3)]
    determinant = np.einsum("...i,...i->...", rows[0], columns[0])
    inverse = np.stack(columns, axis=-1)
    inverse /= determinant[..., np.newaxis, np.newaxis]
    return inverse, determinant


def element_matrices(
    gradients: FloatArray, weights: FloatArray, lam: FloatArray, mu: FloatArray
) -> FloatArray:
    """Stiffness matrices of elements, shape (elements, 3 nodes, 3 nodes), node by node.

    Parameters
    ----------
    gradients, weights
        Of `physical_gradients`.
    lam, mu
        Lame's constants [Pa], shape (elements,).

    Notes
    -----
    With ``H_(ai)(bj)`` the integral of ``phi_a,i phi_b,j``,
    ``K_(ai)(bj) = lambda H_(ai)(bj) + mu H_(aj)(bi) + mu delta_ij H_(ak)(bk)``.
    """
    count, points, nodes = gradients.shape[:3]
    rows = gradients.reshape(count, points, 3 * nodes)
    products = (rows * weights[..., np.newaxis]).transpose(0, 2, 1) @ rows
    shape = (count, nodes, 3, nodes, 3)
    split = products.reshape(shape)
    trace = np.trace(split, axis1=2, axis2=4)
    result = lam[:, None, None] * products
    swapped = split.transpose(0, 1, 4, 3, 2).reshape(products.shape)
    result += mu[:, None, None] * swapped
    view = result.reshape(shape)
    for i in range(3):
        view[:, :, i, :, i] += mu[:, None, None] * trace
    return result
