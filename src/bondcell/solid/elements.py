"""Shape functions of second-order tetrahedra and batched element matrices."""

from __future__ import annotations

import numpy as np

from bondcell.cell import FloatArray

# Corners of the reference tetrahedron, then the middles of its edges.
_CORNERS = np.vstack([np.zeros(3), np.eye(3)])
_PAIRS = np.array([[0, 1], [1, 2], [0, 2], [0, 3], [1, 3], [2, 3]])
NODES = np.vstack([_CORNERS, _CORNERS[_PAIRS].mean(axis=1)])
"""Nodes of the reference tetrahedron, shape (10, 3)."""

EMBEDDING = np.vstack([np.eye(4), (np.eye(4)[_PAIRS]).mean(axis=1)])
"""Values of the four first-order functions at the ten nodes, shape (10, 4)."""


def shape_values(points: FloatArray) -> FloatArray:
    """Second-order shape functions at points of the reference element, shape (points, 10)."""
    l = np.concatenate([1 - points.sum(axis=1, keepdims=True), points], axis=1)  # noqa: E741
    return np.concatenate([l * (2 * l - 1), 4 * l[:, _PAIRS[:, 0]] * l[:, _PAIRS[:, 1]]], axis=1)


def shape_gradients(points: FloatArray) -> FloatArray:
    """Their gradients on the reference element, shape (points, 10, 3)."""
    l = np.concatenate([1 - points.sum(axis=1, keepdims=True), points], axis=1)  # noqa: E741
    slope = np.vstack([-np.ones(3), np.eye(3)])
    corners = (4 * l - 1)[:, :, np.newaxis] * slope
    a, b = _PAIRS.T
    middles = 4 * (l[:, a, np.newaxis] * slope[b] + l[:, b, np.newaxis] * slope[a])
    return np.concatenate([corners, middles], axis=1)


GRADIENTS_AT_NODES = shape_gradients(NODES)
"""Gradients at the nodes, where the orientation of curved elements is checked."""


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
        Nodes of the elements, shape (elements, 10, 3).
    reference, weights
        Gradients (points, 10, 3) and weights (points,) on the reference element.

    Returns
    -------
    tuple
        Gradients (elements, points, 10, 3) and weights (elements, points).
    """
    jacobian = jacobians(corners, reference)
    back, determinant = inverse(jacobian)
    return reference @ back, determinant * weights


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
    """Stiffness matrices of elements, shape (elements, 30, 30), node by node.

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
    count, points = weights.shape
    rows = (gradients * np.sqrt(weights)[..., None, None]).reshape(count, points, 30)
    products = rows.transpose(0, 2, 1) @ rows
    shape = (count, 10, 3, 10, 3)
    split = products.reshape(shape)
    trace = np.trace(split, axis1=2, axis2=4)
    result = lam[:, None, None] * products
    swapped = split.transpose(0, 1, 4, 3, 2).reshape(count, 30, 30)
    result += mu[:, None, None] * swapped
    view = result.reshape(shape)
    for i in range(3):
        view[:, :, i, :, i] += mu[:, None, None] * trace
    return result
