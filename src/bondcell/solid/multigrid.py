"""Preconditioner by polynomial order: second-order functions, first-order ones, aggregates."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import bsr_array, csr_array

from bondcell.cell import FloatArray
from bondcell.fem.aggregates import Aggregates
from bondcell.fem.smoother import Chebyshev
from bondcell.lattice.rigid_modes import rigid_modes
from bondcell.solid.stiffness import Stiffness
from bondcell.solid.tets import Tets


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
    Chebyshev smoothing on the second-order functions before and after one cycle of smoothed
    aggregation (rigid modes as near null space) on the first-order ones.
    """

    def __init__(
        self, mesh: Tets, stiffness: Stiffness, held: NDArray[np.bool_], many: bool = False
    ) -> None:
        self.free = (~held).astype(np.float64).ravel()
        # Rows of numbers are quicker than blocks where several vectors are multiplied at once.
        self.matrix = _free_rows(stiffness.fine, self.free) if many else stiffness.fine
        self._smoother = Chebyshev(stiffness.fine, self.free, self.matrix)
        self._corners, self._ends = mesh.corners, mesh.ends
        rows = np.repeat(np.arange(len(mesh.ends)), 2)
        halves = np.full(rows.size, 0.5)
        shape = (len(mesh.ends), mesh.corners)
        self._average = csr_array((halves, (rows, mesh.ends.ravel())), shape=shape)
        self._back = csr_array(self._average.T)
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
        """First-order functions in terms of second-order ones, on the free unknowns."""
        cases = coarse.shape[1]
        inner = coarse * self._coarse_free
        middle = (self._average @ inner.reshape(-1, 3 * cases)).reshape(-1, cases)
        return np.concatenate([inner, middle]) * self.free[:, np.newaxis]

    def __call__(self, residual: FloatArray) -> FloatArray:
        """Approximate ``A^-1 r`` on the free unknowns, shape (unknowns, cases)."""
        free = self.free[:, np.newaxis]
        right = residual * free
        answer = self._smoother.smooth(right)
        rest = (right - self.matrix @ answer) * free
        answer += self.extend(self._aggregates(self.restrict(rest)))
        return self._smoother.smooth(right, answer)


def _free_rows(matrix: bsr_array, free: FloatArray) -> csr_array:
    """The matrix by rows, with zero rows and columns where unknowns are held."""
    result = csr_array(matrix)
    rows = np.repeat(np.arange(free.size), np.diff(result.indptr))
    result.data *= free[rows] * free[result.indices]
    result.eliminate_zeros()
    return result
