"""Response as a function of the particles' modulus alone."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy.linalg

from bondcell.cell import FloatArray
from bondcell.fem.symmetric_solve import half_solve

MANY = 16
"""Moduli from which one eigenvalue problem is cheaper than a factorisation of each."""


@dataclass(frozen=True)
class Pencil:
    """The interface system ``(S + rho P) x = -b`` once pressures are eliminated.

    With the eigenvectors of ``S v = lambda P v``, ``v^T P v = 1``, the stiffness is explicit::

        K = c - b^T (S + rho P)^-1 b = c - sum (v^T b)^2 / (lambda + rho)

    Parameters
    ----------
    matrix, particles
        ``S`` and ``P``, shape (n, n); both positive definite.
    coupling
        ``b``, shape (n, motions).
    own
        ``c``, shape (motions, motions).
    is_half
        Whether this is half of a symmetric pair.
    """

    matrix: FloatArray
    particles: FloatArray
    coupling: FloatArray
    own: FloatArray
    is_half: bool

    def response(self, ratios: FloatArray) -> FloatArray:
        """Of the whole cell, for unit shear modulus of the matrix.

        Parameters
        ----------
        ratios
            Shear modulus of particle i over the matrix's, infinite if all particles are rigid.

        Returns
        -------
        numpy.ndarray
            Shape (ratios, motions, motions).

        Raises
        ------
        numpy.linalg.LinAlgError
            If a system is not positive definite.
        """
        if ratios.size < MANY:
            lost = np.array([self._lost(ratio) for ratio in ratios])
        else:
            eigenvalues, forces = self.spectrum
            shares = 1 / (eigenvalues + ratios[:, None])
            lost = (shares[:, :, None] * forces).transpose(0, 2, 1) @ forces
        response = self.own - lost
        return np.asarray(response / 2 if self.is_half else response)

    def _lost(self, ratio: float) -> FloatArray:
        if np.isinf(ratio):
            return np.zeros_like(self.own)
        root = half_solve(self.matrix + ratio * self.particles, self.coupling.T.copy())
        return np.asarray(root @ root.T)

    @cached_property
    def spectrum(self) -> tuple[FloatArray, FloatArray]:
        """``lambda``, shape (n,), and ``v^T b``, shape (n, motions)."""
        eigenvalues, vectors = scipy.linalg.eigh(self.matrix, self.particles, check_finite=False)
        return eigenvalues, vectors.T @ self.coupling
