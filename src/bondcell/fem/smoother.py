"""Chebyshev iterations on the block diagonal: what is rough in a residual goes, in parallel."""

from __future__ import annotations

import numpy as np
from scipy.sparse import bsr_array, csr_array

from bondcell.cell import FloatArray
from bondcell.fem.blocks import block_diagonal, product

DEGREE = 2
"""Products with the matrix in one smoothing."""

_FRACTION = 12.0
_POWER_STEPS = 12
_SAFETY = 1.1


class Chebyshev:
    """Smoother of a symmetric positive definite matrix of square blocks.

    Parameters
    ----------
    matrix
        The matrix.
    free
        One where unknowns are free, zero where they are held, shape (unknowns,).
    quicker
        The same matrix in another format, whose products are quicker, or in single precision,
        which is then that of the smoothing.
    degree
        Products with the matrix in one smoothing.

    Notes
    -----
    The polynomial is the smallest one on the upper part ``[l/12, l]`` of the spectrum of
    ``D^-1 A``, D the block diagonal, l the largest eigenvalue by power iteration.
    """

    def __init__(
        self,
        matrix: bsr_array,
        free: FloatArray,
        quicker: csr_array | None = None,
        degree: int = DEGREE,
    ) -> None:
        self._matrix = matrix if quicker is None else quicker
        self._degree = degree
        width = matrix.blocksize[0]
        mask = free.reshape(-1, width)
        blocks = block_diagonal(matrix) * mask[:, :, np.newaxis] * mask[:, np.newaxis]
        own = np.einsum("nii->ni", blocks)
        alone = own <= 0
        own += alone
        usable = ~alone
        inverse = np.linalg.inv(blocks) * usable[:, :, np.newaxis] * usable[:, np.newaxis]
        every = np.arange(len(inverse) + 1)
        inverse = inverse.astype(self._matrix.dtype)
        self._inverse = bsr_array((inverse, every[:-1], every), shape=matrix.shape)
        self._largest = _SAFETY * self._largest_eigenvalue(free)

    def _largest_eigenvalue(self, free: FloatArray) -> float:
        vector = np.random.default_rng(0).normal(size=free.size) * free
        vector = vector.astype(self._matrix.dtype)
        value = 1.0
        for _ in range(_POWER_STEPS):
            vector = self._inverse @ (self._matrix @ (vector / np.linalg.norm(vector)))
            value = float(np.linalg.norm(vector))
        return value

    def smooth(self, right: FloatArray, start: FloatArray | None = None) -> FloatArray:
        """Improve ``start`` (default zero) as a solution of ``A x = right``."""
        low, high = self._largest / _FRACTION, self._largest
        middle, half = (high + low) / 2, (high - low) / 2
        residual = right if start is None else right - product(self._matrix, start)
        step = product(self._inverse, residual) / middle
        answer = step.copy() if start is None else start + step
        ratio = half / middle
        for _ in range(self._degree - 1):
            residual = right - product(self._matrix, answer)
            following = 1 / (2 * middle / half - ratio)
            step *= following * ratio
            step += (2 * following / half) * product(self._inverse, residual)
            answer += step
            ratio = following
        return answer
