"""A smooth function of several variables: Chebyshev coefficients squeezed into a Tucker tensor."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.polynomial import chebyshev

from bondcell.cell import FloatArray

BLOCK = 2048
"""Points evaluated at once: intermediate arrays stay in the cache."""


@dataclass(frozen=True)
class Tucker:
    """``f(x) = sum core[a, b, ..] phi_a(x_0) phi_b(x_1) ..`` with ``phi = factor^T T(x)``.

    Parameters
    ----------
    core
        Shape (r_0, r_1, ...).
    factors
        One a variable, shape (n_k, r_k): Chebyshev coefficients of the variable's functions.
    """

    core: FloatArray
    factors: tuple[FloatArray, ...]

    @classmethod
    def fit(cls, values: FloatArray, tolerance: float) -> Tucker:
        """Interpolate values at Chebyshev extrema, and drop what is below ``tolerance``.

        Parameters
        ----------
        values
            Values on the tensor grid of `surrogate_axes.chebyshev_points`.
        tolerance
            Absolute error in the root mean square that each variable's truncation may add.
        """
        core = values
        factors = []
        for axis, count in enumerate(values.shape):
            points = -np.cos(np.pi * np.arange(count) / (count - 1))
            inverse = np.linalg.inv(chebyshev.chebvander(points, count - 1))
            core = np.moveaxis(np.tensordot(inverse, core, (1, axis)), 0, axis)
        for axis in range(values.ndim):
            unfolded = np.moveaxis(core, axis, 0).reshape(core.shape[axis], -1)
            left, singular, _ = np.linalg.svd(unfolded, full_matrices=False)
            tail = np.sqrt(np.cumsum(singular[::-1] ** 2))[::-1]
            rank = max(1, int((tail > tolerance).sum()))
            factors.append(left[:, :rank])
            core = np.moveaxis(np.tensordot(left[:, :rank].T, core, (1, axis)), 0, axis)
        return cls(core, tuple(factors))

    def __call__(self, coordinates: Sequence[FloatArray]) -> FloatArray:
        """Evaluate at points of [-1, 1]^d, each coordinate an array of shape (points,)."""
        result = np.empty(coordinates[0].size)
        for start in range(0, result.size, BLOCK):
            block = slice(start, start + BLOCK)
            result[block] = self._evaluate([x[block] for x in coordinates])
        return result

    def _evaluate(self, coordinates: Sequence[FloatArray]) -> FloatArray:
        bases = [
            chebyshev.chebvander(x, len(factor) - 1) @ factor
            for x, factor in zip(coordinates, self.factors, strict=True)
        ]
        partial = bases[0] @ self.core.reshape(len(self.core), -1)
        for basis in bases[1:]:
            partial = partial.reshape(len(basis), basis.shape[1], -1)
            partial = np.matmul(basis[:, None, :], partial)[:, 0]
        return partial[:, 0]
