"""Preconditioner by polynomial order: all functions, first-order ones, aggregates."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import bsr_array, csr_array

from bondcell.cell import FloatArray
from bondcell.fem.aggregates import Aggregates
from bondcell.fem.blocks import product
from bondcell.fem.smoother import Chebyshev
from bondcell.lattice.rigid_modes import rigid_modes
from bondcell.solid.stiffness import Stiffness
from bondcell.solid.tets import Tets

DEGREES = {2: 2, 3: 3, 4: 4}
"""Order of the functions -> products in one smoothing: the higher, the more is rough."""


class PMultigrid:
    """One symmetric cycle as an approximate inverse.

    Parameters
    ----------
    mesh, stiffness
        The mesh and its matrices.
    held
        Unknowns that stay zero, shape (nodes, 3).
    many
        Whether many right-hand sides will be solved at once; then `matrix` lacks what is held.

    Notes
    -----
    Chebyshev smoothing on the functions of the mesh's order before and after one cycle of smoothed
    aggregation (rigid modes as near null space) on the first-order ones. Smoothing is in single
    precision: an approximate inverse needs no more, and half of the time goes into fetching the
    matrix.
    """

    def __init__(
        self, mesh: Tets, stiffness: Stiffness, held: NDArray[np.bool_], many: bool = False
    ) -> None:
        self.free = (~held).astype(np.float64).ravel()
        # Rows of numbers are quicker than blocks.
        self.matrix = _free_rows(stiffness.fine, self.free) if many else stiffness.fine
        self._rows = _free_rows(stiffness.fine, self.free.astype(np.float32))
        self._smoother = Chebyshev(stiffness.fine, self.free, self._rows, DEGREES[mesh.order])
        self._corners = mesh.corners
        self._average, self._back = mesh.linear, csr_array(mesh.linear.T)
        coarse_held = held[: mesh.corners]
        self._coarse_free = self.free[: 3 * mesh.corners, np.newaxis]
        modes = rigid_modes(mesh.points[: mesh.corners], rotates=True)[:, :3]
        self._aggregates = Aggregates(stiffness.coarse, coarse_held, modes, many)

    def restrict(self, fine: FloatArray) -> FloatArray:
        """Transpose of `extend`."""
        cases = fine.shape[1]
        top = fine[: 3 * self._corners].copy()
        rest = fine[3 * self._corners :].reshape(-1, 3 * cases)
        top += (self._back @ rest).reshape(-1, cases)
        return top * self._coarse_free

    def extend(self, coarse: FloatArray) -> FloatArray:
        """First-order functions in terms of the mesh's own, on the free unknowns."""
        cases = coarse.shape[1]
        inner = coarse * self._coarse_free
        middle = (self._average @ inner.reshape(-1, 3 * cases)).reshape(-1, cases)
        return np.concatenate([inner, middle]) * self.free[:, np.newaxis]

    def __call__(self, residual: FloatArray) -> FloatArray:
        """Approximate ``A^-1 r`` on the free unknowns, shape (unknowns, cases)."""
        right = residual * self.free[:, np.newaxis]
        size = np.abs(right).max(axis=0)
        size[size == 0] = 1.0
        right = (right / size).astype(np.float32)
        answer = self._smoother.smooth(right)
        rest = right - product(self._rows, answer)
        answer += self.extend(self._aggregates(self.restrict(rest)))
        return self._smoother.smooth(right, answer) * size


def _free_rows(matrix: bsr_array, free: FloatArray) -> csr_array:
    """The matrix by rows, with zero rows and columns where unknowns are held.

    Its precision is that of ``free``. Blocks are masked before they are taken apart: half of the
    memory is what the masks would take afterwards.
    """
    width = matrix.blocksize[0]
    mask = free.reshape(-1, width)
    blocks = matrix.data.astype(free.dtype)
    blocks *= np.repeat(mask, np.diff(matrix.indptr), axis=0)[:, :, np.newaxis]
    blocks *= mask[matrix.indices][:, np.newaxis]
    result = csr_array(bsr_array((blocks, matrix.indices, matrix.indptr), shape=matrix.shape))
    result.eliminate_zeros()
    return result
