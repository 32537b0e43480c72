"""Generalised Maxwell chains: Prony series ``k(t) = k_inf + sum k_j exp(-t/tau_j)``."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from bondcell.cell import FloatArray

LARGEST_BLOCK = 2_000_000
"""Exponentials computed at once, to bound the memory."""


@dataclass(frozen=True)
class Chain:
    """Generalised Maxwell chains: a spring beside Maxwell elements.

    Parameters
    ----------
    equilibrium
        Stiffness that never relaxes, shape (...,).
    strengths
        Stiffness of each Maxwell element, not negative, shape (..., terms).
    times
        Relaxation time of each [s], positive, shape (..., terms) or (terms,). What is padded has
        strength 0 and time 1.

    Examples
    --------
    >>> chain = Chain(np.array(1.0), np.array([2.0, 3.0]), np.array([1.0, 10.0]))
    >>> float(chain.instantaneous), chain.relaxation([0.0, 1e3]).round(3)
    (6.0, array([6., 1.]))
    """

    equilibrium: FloatArray
    strengths: FloatArray
    times: FloatArray

    @property
    def instantaneous(self) -> FloatArray:
        """Stiffness at t = 0, shape (...,)."""
        return np.asarray(self.equilibrium + self.strengths.sum(axis=-1))

    @property
    def count(self) -> int:
        """Number of terms, padded ones included."""
        return int(self.strengths.shape[-1])

    def times_factor(self, factor: ArrayLike) -> Chain:
        """Chains ``factor`` times as stiff, factor of shape (...,)."""
        factor = np.asarray(factor, dtype=float)
        return Chain(self.equilibrium * factor, self.strengths * factor[..., None], self.times)

    def relaxation(self, time: ArrayLike) -> FloatArray:
        """Stiffness after a step, shape (times, ...).

        Parameters
        ----------
        time
            Times since the step [s], not negative, inf for the end, shape (times,).
        """
        return self._sum(time, lambda t, tau: np.exp(-t / tau))

    def dynamic(self, frequency: ArrayLike) -> NDArray[np.complex128]:
        """Complex stiffness ``k* = k_inf + sum k_j i w tau_j/(1 + i w tau_j)``, shape (freq., ...).

        Parameters
        ----------
        frequency
            Angular frequencies [rad/s], shape (frequencies,).
        """

        def element(w: FloatArray, tau: FloatArray) -> NDArray[np.complex128]:
            x = w * tau
            # x^2/(1 + x^2) and x/(1 + x^2) without overflow.
            small = np.minimum(x, 1 / np.where(x > 0, x, 1.0))
            share = 1 / (1 + small**2)
            storage = np.where(x > 1, share, small**2 * share)
            return np.asarray(storage + 1j * small * share)

        return self._sum(frequency, element)

    def transform(self, s: ArrayLike) -> FloatArray:
        """Stiffness at a real Laplace variable, ``s`` times the transform, shape (values, ...)."""

        def element(s: FloatArray, tau: FloatArray) -> FloatArray:
            with np.errstate(divide="ignore"):
                return np.asarray(1 / (1 + 1 / (s * tau)))

        return self._sum(s, element)

    def _sum(
        self, at: ArrayLike, element: Callable[[FloatArray, FloatArray], NDArray[Any]]
    ) -> NDArray[Any]:
        """``k_inf + sum k_j element(at, tau_j)``, the points of ``at`` first."""
        points = np.atleast_1d(np.asarray(at, dtype=float))
        column = points.reshape(-1, *(1 for _ in self.strengths.shape))
        result = np.zeros((points.size, *self.strengths.shape[:-1]), dtype=self._kind(element))
        step = max(1, LARGEST_BLOCK // max(1, self.strengths.size))
        for begin in range(0, points.size, step):
            rows = slice(begin, begin + step)
            terms = self.strengths * element(column[rows], self.times)
            result[rows] = self.equilibrium + terms.sum(axis=-1)
        return result

    @staticmethod
    def _kind(element: Callable[[FloatArray, FloatArray], NDArray[Any]]) -> np.dtype[Any]:
        return element(np.ones(1), np.ones(1)).dtype


def decade_below(share: float) -> float:
    """The power of ten at or below a share: series that end in one decade share what is fitted.

    Examples
    --------
    >>> decade_below(0.014), decade_below(0.0)
    (0.01, 0.0)
    """
    return float(f"1e{int(np.floor(np.log10(share) + 1e-9))}") if share > 0 else 0.0


def merged(strengths: FloatArray, times: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Terms of one chain in ascending time: equal times added up, zero strengths left out.

    Examples
    --------
    >>> merged(np.array([1.0, 2.0, 0.0, 3.0]), np.array([5.0, 1.0, 2.0, 5.0]))
    (array([2., 4.]), array([1., 5.]))
    """
    distinct, position = np.unique(times, return_inverse=True)
    sums = np.zeros(distinct.size)
    np.add.at(sums, position, strengths)
    kept = sums > 0
    return sums[kept], distinct[kept]
