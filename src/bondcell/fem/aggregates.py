"""Algebraic multigrid for several right-hand sides at once, on a hierarchy made by pyamg."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import pinvh
from scipy.sparse import bsr_array, csr_array

from bondcell.cell import FloatArray
from bondcell.fem.blocks import hold, product, scaled
from bondcell.fem.smoother import Chebyshev

COARSEST = 100
"""Nodes of the coarsest level, which is inverted densely."""

WEAK = 0.03
"""Nodes coupled by less do not share an aggregate: the two sides of an interface."""


class Aggregates:
    """One symmetric cycle of smoothed aggregation as an approximate inverse.

    Parameters
    ----------
    matrix
        Stiffness of square blocks.
    held
        Unknowns that stay zero, shape (nodes, width).
    modes
        Rigid motions, shape (nodes, width, motions).
    many
        Whether many right-hand sides will come at once: rows of numbers are quicker for these than
        blocks, and take more memory.
    """

    def __init__(
        self,
        matrix: bsr_array,
        held: NDArray[np.bool_],
        modes: FloatArray,
        many: bool = False,
    ) -> None:
        from pyamg.aggregation import smoothed_aggregation_solver

        inner = hold(matrix, held)
        # Without units, so that a stiff particle and its soft matrix are told apart.
        self._scale = 1 / np.sqrt(inner.diagonal())[:, np.newaxis]
        inner = scaled(inner, self._scale[:, 0])
        near = np.where(held[:, :, np.newaxis], 0.0, modes).reshape(-1, modes.shape[2])
        near /= self._scale
        levels = smoothed_aggregation_solver(
            inner,
            B=near / np.linalg.norm(near, axis=0),
            strength=("symmetric", {"theta": WEAK}),
            improve_candidates=None,
            max_coarse=COARSEST,
            coarse_solver=None,
        ).levels
        self.sizes = [level.A.shape[0] for level in levels]
        form = csr_array if many else bsr_array
        self._matrices = [form(level.A) for level in levels[:-1]]
        self._down = [form(level.R) for level in levels[:-1]]
        self._up = [form(level.P) for level in levels[:-1]]
        self._smoothers = [
            Chebyshev(bsr_array(level.A), np.ones(level.A.shape[0]), quicker=own)
            for level, own in zip(levels[:-1], self._matrices, strict=True)
        ]
        self._coarsest = pinvh(levels[-1].A.toarray(), rtol=1e-12)

    def __call__(self, right: FloatArray) -> FloatArray:
        """Approximate ``A^-1 r``, shape (unknowns, cases)."""
        return np.asarray(self._scale * self._cycle(self._scale * right, 0))

    def _cycle(self, right: FloatArray, level: int) -> FloatArray:
        if level == len(self._matrices):
            return np.asarray(self._coarsest @ right)
        smoother = self._smoothers[level]
        answer = smoother.smooth(right)
        rest = right - product(self._matrices[level], answer)
        answer += product(self._up[level], self._cycle(product(self._down[level], rest), level + 1))
        return smoother.smooth(right, answer)
