"""Sums over the points of a tensor grid, one direction at a time.

A shape function is ``f_a(x) g_b(y)``. Its value, x-slope and y-slope (the three *kinds*) are
products too, so with coefficients ``C`` at the points ``(i, j)``::

    sum_ij C_ij (f_a f_c)_i (g_b g_d)_j = sum_j [ sum_i C_ij (f_a f_c)_i ] (g_b g_d)_j

costs a tenth of the sum over all points at once, at order 8. Kinds that are alike along one
direction are collected before the sum along the other.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from bondcell.cell import FloatArray
from bondcell.fem.cell_basis import LineTables, gauss_line, line_tables

X_SLOPE = (0, 1, 0)
"""Whether a kind differentiates along x."""

Y_SLOPE = (0, 0, 1)
"""Whether a kind differentiates along y."""

_Y_PAIRS = ((0, 0), (0, 1), (1, 0), (1, 1))


@lru_cache(maxsize=32)
def _pair_tables(order: int, count: int) -> tuple[list[FloatArray], FloatArray, NDArray[np.int64]]:
    """Products of two functions along x (a table each pair of kinds along y) and along y.

    The last array says where the matrix entries of the square's shape functions are found.
    """
    tables = line_tables(order, count)
    line = (tables.value, tables.slope)
    n = order + 1

    def product(one: int, other: int) -> FloatArray:
        return np.asarray((line[one][:, None] * line[other]).reshape(n * n, count))

    along_x = [
        np.concatenate([product(X_SLOPE[k], X_SLOPE[m]) for k, m in kinds_of(pair)], axis=1)
        for pair in _Y_PAIRS
    ]
    along_y = np.concatenate([product(*pair) for pair in _Y_PAIRS], axis=1).T
    row = tables.first[:, None] * n + tables.first
    column = tables.second[:, None] * n + tables.second
    return along_x, np.ascontiguousarray(along_y), row * n * n + column


def kinds_of(y_slopes: tuple[int, int]) -> list[tuple[int, int]]:
    """Pairs of kinds with the given slopes along y."""
    return [(k, m) for k in range(3) for m in range(3) if (Y_SLOPE[k], Y_SLOPE[m]) == y_slopes]


def component_pairs(components: int) -> list[tuple[int, int]]:
    """Pairs of components whose sums differ: the others are transposed."""
    return [(c, d) for c in range(components) for d in range(c, components)]


@lru_cache(maxsize=64)
def product_places(order: int, count: int, components: int) -> tuple[NDArray[np.int64], ...]:
    """Where matrix entries are found among the `sum_products` of all `component_pairs`.

    Of unknowns inside an element with each other, of unknowns on its boundary with those inside,
    and of those on the boundary with each other; either kind is in the order (component, shape).
    """
    place = _pair_tables(order, count)[2]
    edge = 4 * order
    number = {pair: k for k, pair in enumerate(component_pairs(components))}
    whole = np.empty((components, len(place), components, len(place)), dtype=np.int64)
    for c in range(components):
        for d in range(components):
            own = place if c <= d else place.T
            whole[c, :, d] = own + number[min(c, d), max(c, d)] * place.size
    inside, boundary = slice(edge, None), slice(0, edge)
    return tuple(
        whole[:, rows, :, columns].reshape(components * whole[0, rows].shape[0], -1)
        for rows, columns in ((inside, inside), (boundary, inside), (boundary, boundary))
    )


def sum_products(coefficients: FloatArray, order: int, out: FloatArray) -> None:
    """Weighted sums of products of two shape functions, in the order of `product_places`.

    Parameters
    ----------
    coefficients
        Of each pair of kinds at the points, shape (3, 3, batch, q, q).
    order
        Polynomial order.
    out
        Receives the sums, shape (batch, shapes, shapes).
    """
    batch, count = coefficients.shape[2:4]
    along_x, along_y, _ = _pair_tables(order, count)
    half = []
    for pair, table in zip(_Y_PAIRS, along_x, strict=True):
        collected = np.stack([coefficients[k, m] for k, m in kinds_of(pair)], axis=1)
        half.append(table @ collected.reshape(batch, -1, count))
    np.matmul(np.concatenate(half, axis=2), along_y, out=out)


def pressure_line(order: int, at: FloatArray) -> FloatArray:
    """Legendre polynomials of degree below ``order`` on [0, 1], shape (order, points)."""
    return np.asarray(np.polynomial.legendre.legvander(2 * at - 1, order - 1).T)


def pressure_pairs(order: int) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Degrees along x and y of the polynomials of total degree below ``order``, constant first."""
    pairs = sorted(((a, b) for a in range(order) for b in range(order - a)), key=sum)
    along, across = np.array(pairs).T
    return along, across


@lru_cache(maxsize=32)
def _pressure_tables(
    order: int, count: int
) -> tuple[FloatArray, FloatArray, FloatArray, NDArray[np.int64]]:
    """Products of a pressure and a function: along x (for either slope along y) and along y.

    The last array says where the entries (pressure, shape function) are found.
    """
    tables = line_tables(order, count)
    legendre = pressure_line(order, gauss_line(count)[0])
    value = (legendre[:, None] * tables.value).reshape(-1, count)
    slope = (legendre[:, None] * tables.slope).reshape(-1, count)
    along, across = pressure_pairs(order)
    row = along[:, None] * (order + 1) + tables.first
    column = across[:, None] * (order + 1) + tables.second
    along_x = np.concatenate([value, slope], axis=1)
    along_y = np.ascontiguousarray(np.concatenate([value, slope], axis=1).T)
    return along_x, value, along_y, row * len(value) + column


def dilatations(coefficients: FloatArray, order: int) -> FloatArray:
    """Weighted sums of products of a pressure and a shape function.

    Parameters
    ----------
    coefficients
        Of each kind of the shape function at the points, shape (3, batch, q, q).
    order
        Polynomial order of the shape functions; pressures have total degrees below it.

    Returns
    -------
    numpy.ndarray
        Shape (batch, pressures, shapes).
    """
    batch, count = coefficients.shape[1:3]
    along_x, value_x, along_y, place = _pressure_tables(order, count)
    no_slope = along_x @ coefficients[:2].transpose(1, 0, 2, 3).reshape(batch, -1, count)
    half = np.concatenate([no_slope, value_x @ coefficients[2]], axis=2)
    both = half.reshape(-1, along_y.shape[0]) @ along_y
    return both.reshape(batch, -1).take(place, axis=1, mode="clip")


def sum_shapes(coefficients: FloatArray, tables: LineTables) -> FloatArray:
    """Weighted sums of shape functions.

    Parameters
    ----------
    coefficients
        Of each kind at the points, shape (3, batch, q, q).
    tables
        Functions of one direction.

    Returns
    -------
    numpy.ndarray
        Shape (batch, shapes).
    """
    value, slope = tables.value, tables.slope
    level = coefficients[0] @ value.T + coefficients[2] @ slope.T
    both = value @ level + slope @ (coefficients[1] @ value.T)
    return np.asarray(both[:, tables.first, tables.second])
