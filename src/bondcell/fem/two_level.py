"""Conjugate gradients for second-order elements, preconditioned by the first-order ones in them."""

from __future__ import annotations

import numpy as np
from scipy.sparse import csc_array, csr_array
from scipy.sparse.linalg import LinearOperator, cg, splu

from bondcell.cell import FloatArray
from bondcell.errors import BondcellError

MOST_ITERATIONS = 1000
"""A hundred are usual; the number does not grow with the mesh, but with badly shaped elements."""


class TwoLevelSolver:
    """Symmetric positive definite system of a finite element space with a smaller one inside.

    Parameters
    ----------
    matrix
        Shape (n, n).
    embedding
        Coefficients of the smaller space's functions in the larger space, shape (n, m).

    Notes
    -----
    The preconditioner is ``D^-1 + P (P^T A P)^-1 P^T`` with D the diagonal of A and P the
    embedding: the smaller space, solved directly, takes what is smooth, and what is left oscillates
    from node to node, where the diagonal is as good as the matrix.
    """

    def __init__(self, matrix: csr_array, embedding: csr_array) -> None:
        self._matrix = matrix
        diagonal = matrix.diagonal()
        coarse = splu(
            csc_array(embedding.T @ matrix @ embedding),
            permc_spec="MMD_AT_PLUS_A",
            diag_pivot_thresh=0.0,
            options={"SymmetricMode": True},
        )

        def approximate_inverse(residual: FloatArray) -> FloatArray:
            fine = residual / diagonal
            return np.asarray(fine + embedding @ coarse.solve(embedding.T @ residual))

        self._preconditioner = LinearOperator(matrix.shape, approximate_inverse, dtype=np.float64)

    def solve(self, right: FloatArray, residual: float) -> FloatArray:
        """Solve for one right-hand side to a relative residual.

        Raises
        ------
        BondcellError
            The residual is not reached in `MOST_ITERATIONS`.
        """
        answer, failed = cg(
            self._matrix, right, rtol=residual, maxiter=MOST_ITERATIONS, M=self._preconditioner
        )
        if failed:
            raise BondcellError(f"no residual of {residual} within {MOST_ITERATIONS} iterations")
        return np.asarray(answer)
