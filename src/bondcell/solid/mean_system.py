"""Linear systems under prescribed mean displacements."""

from __future__ import annotations

import numpy as np
from scipy.sparse import bsr_array

from bondcell.cell import FloatArray
from bondcell.fem.blocks import product
from bondcell.fem.krylov import TOLERANCE, conjugate_gradients
from bondcell.solid.multigrid import PMultigrid


class MeanSystem:
    """A stiffness matrix with linear functionals whose values are prescribed.

    Parameters
    ----------
    matrix
        The matrix, shape (unknowns, unknowns).
    solver
        Its preconditioner, which knows the unknowns that are held.
    means
        The functionals M, zero on held unknowns, shape (unknowns, functionals).

    Notes
    -----
    With lifts W, ``M^T W = 1``, and ``P = 1 - W M^T`` the answer is ``u = W g + v`` with v in the
    range of P: ``P^T A v = P^T (f - A W g)`` by conjugate gradients, preconditioned by ``P B P^T``.
    The lifts are coarse answers to forces on the particles: they cost little energy, which keeps P
    small.
    """

    def __init__(self, matrix: bsr_array, solver: PMultigrid, means: FloatArray) -> None:
        self._matrix, self._solver, self._means = matrix, solver, means
        self._free = solver.free[:, np.newaxis]
        lifts = solver(means)
        self._lifts = lifts @ np.linalg.inv(means.T @ lifts)

    def _apply(self, x: FloatArray) -> FloatArray:
        return np.asarray(self._balanced((product(self._matrix, x)) * self._free))

    def _balanced(self, forces: FloatArray) -> FloatArray:
        """``P^T f``: forces without those that the prescribed means take."""
        return forces - self._means @ (self._lifts.T @ forces)

    def _precondition(self, residual: FloatArray) -> FloatArray:
        answer = self._solver(residual)
        return np.asarray(answer - self._lifts @ (self._means.T @ answer))

    def solve(
        self, given: FloatArray, forces: FloatArray | float = 0.0, tolerance: float = TOLERANCE
    ) -> tuple[FloatArray, FloatArray, int]:
        """Solve ``A u = f + M l`` with ``M^T u = g``.

        Parameters
        ----------
        given
            Values g of the functionals, shape (functionals, cases).
        forces
            Forces f, shape (unknowns, cases).
        tolerance
            Error in the energy norm relative to that of ``W g``.

        Returns
        -------
        tuple
            Displacements (unknowns, cases), the forces l (functionals, cases), iterations.
        """
        start = self._lifts @ given
        right = self._balanced((forces - product(self._matrix, start)) * self._free)
        step, iterations = conjugate_gradients(self._apply, self._precondition, right, tolerance)
        answer = start + step
        pull = self._lifts.T @ ((product(self._matrix, answer) - forces) * self._free)
        return answer, pull, iterations

    def unbalanced(self, forces: FloatArray) -> FloatArray:
        """What of nodal forces neither supports nor the prescribed means take."""
        return self._balanced(forces * self._free)
