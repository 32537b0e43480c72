"""Element matrices of any origin gathered into one sparse matrix of square blocks."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import bsr_array, csr_array

from bondcell.cell import FloatArray

IndexArray = NDArray[np.int64]


FEW = 4
"""Columns up to which a product goes by columns."""


def product(matrix: bsr_array | csr_array, columns: FloatArray) -> FloatArray:
    """``A x``, shape (unknowns, cases).

    Few columns go one by one: the kernel for a single vector takes half the time of that for
    several.
    """
    if columns.shape[1] > FEW:
        return np.asarray(matrix @ columns)
    result = np.empty((matrix.shape[0], columns.shape[1]), dtype=columns.dtype)
    for k in range(columns.shape[1]):
        result[:, k] = matrix @ columns[:, k]
    return result


class BlockAssembler:
    """Sum of element matrices, added chunk by chunk.

    Parameters
    ----------
    connectivity
        Nodes of each element, shape (elements, a).
    count
        Number of nodes.
    width
        Unknowns of a node; unknown ``width n + c`` is component c of node n.

    Notes
    -----
    The pattern is that of ``C C^T`` with C the incidence of nodes and elements. The matrix is
    filled in place: beside it there is never more than one chunk of element matrices.

    Examples
    --------
    >>> springs = BlockAssembler(np.array([[0, 1], [1, 2]]), count=3, width=1)
    >>> springs.add(slice(None), np.tile([[1.0, -1.0], [-1.0, 1.0]], (2, 1, 1)))
    >>> springs.matrix().toarray()
    array([[ 1., -1.,  0.],
           [-1.,  2., -1.],
           [ 0., -1.,  1.]])
    """

    def __init__(self, connectivity: IndexArray, count: int, width: int) -> None:
        self._connectivity, self._count, self._width = connectivity, count, width
        elements, nodes = connectivity.shape
        starts = np.arange(0, nodes * elements + 1, nodes)
        ones = np.ones(nodes * elements, dtype=np.int32)
        incidence = csr_array((ones, connectivity.ravel(), starts), shape=(elements, count))
        pattern = csr_array(incidence.T @ incidence)
        pattern.sort_indices()
        self._indptr, self._indices = pattern.indptr, pattern.indices
        rows = np.repeat(np.arange(count), np.diff(pattern.indptr))
        self._keys = rows * count + pattern.indices
        self._data = np.zeros(pattern.nnz * width * width)

    @property
    def blocks(self) -> int:
        """Number of blocks stored."""
        return int(self._keys.size)

    def add(self, elements: slice | IndexArray, local: FloatArray) -> None:
        """Add the matrices of some elements, shape (elements, a width, a width)."""
        nodes, width = self._connectivity[elements], self._width
        count, a = nodes.shape
        wanted = nodes[:, :, np.newaxis] * self._count + nodes[:, np.newaxis]
        block = np.searchsorted(self._keys, wanted.ravel())
        ordered = local.reshape(count, a, width, a, width).transpose(0, 1, 3, 2, 4)
        at = block[:, np.newaxis] * width**2 + np.arange(width**2)
        np.add.at(self._data, at.ravel(), ordered.ravel())

    def matrix(self) -> bsr_array:
        """The sum so far."""
        size, width = self._count * self._width, self._width
        blocks = self._data.reshape(-1, width, width)
        return bsr_array((blocks, self._indices, self._indptr), shape=(size, size))


def block_diagonal(matrix: bsr_array) -> FloatArray:
    """Diagonal blocks, shape (nodes, width, width); zero where there is none."""
    width = matrix.blocksize[0]
    nodes = matrix.shape[0] // width
    rows = np.repeat(np.arange(nodes), np.diff(matrix.indptr))
    own = np.flatnonzero(rows == matrix.indices)
    result = np.zeros((nodes, width, width))
    result[rows[own]] = matrix.data[own]
    return result


def hold(matrix: bsr_array, held: NDArray[np.bool_]) -> bsr_array:
    """The matrix with the unknowns ``held``, shape (nodes, width), uncoupled from all others.

    Their rows and columns are zero but for the diagonal, which stays as it is, or is one.
    """
    width = matrix.blocksize[0]
    nodes = matrix.shape[0] // width
    rows = np.repeat(np.arange(nodes), np.diff(matrix.indptr))
    free = (~held).astype(np.float64)
    data = matrix.data * free[rows][:, :, np.newaxis]
    data *= free[matrix.indices][:, np.newaxis, :]
    own = np.flatnonzero(rows == matrix.indices)
    for c in range(width):
        diagonal = matrix.data[own, c, c]
        kept = np.where(diagonal > 0, diagonal, 1.0)
        data[own, c, c] = np.where(held[rows[own], c], kept, data[own, c, c])
    return bsr_array((data, matrix.indices, matrix.indptr), shape=matrix.shape)


def scaled(matrix: bsr_array, scale: FloatArray) -> bsr_array:
    """``S A S`` with S diagonal, shape (unknowns,)."""
    width = matrix.blocksize[0]
    factors = scale.reshape(-1, width)
    rows = np.repeat(np.arange(len(factors)), np.diff(matrix.indptr))
    data = matrix.data * factors[rows][:, :, np.newaxis]
    data *= factors[matrix.indices][:, np.newaxis, :]
    return bsr_array((data, matrix.indices, matrix.indptr), shape=matrix.shape)
