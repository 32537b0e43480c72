"""A bond as springs of matrix and particle in series, any number of them side by side.

As a function of one modulus X of the matrix, the particles' staying what they are, a bond's
stiffness is ``K(X) = K_0 + sum m_l X / (1 + a_l X)``, all terms positive: m_l X are springs of
matrix, ``1/(a_l X)`` the ratio of the particle springs before them to those. Where X relaxes, each
pair is the problem of `springs`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bondcell.cell import FloatArray
from bondcell.prony.chain import Chain
from bondcell.prony.springs import behind_spring

GAUSS_CLASSES = (2, 4, 6, 9, 13, 18)
"""Numbers of pairs that Gauss quadrature may leave of many."""

GAUSS_ERROR = 1e-17
"""Relative error that it may make, by its rate of convergence."""

POINTS_AT_ONCE = 2000
"""Bounds the memory of intermediate arrays."""


@dataclass(frozen=True)
class Bank:
    """Pairs of springs for many bonds.

    Parameters
    ----------
    strength
        m_l, stiffness for a unit modulus, shape (points, pairs); padded with zeros.
    softness
        a_l [1/Pa], shape (points, pairs).
    constant
        K_0, what the bond keeps when X is zero, shape (points,).
    """

    strength: FloatArray
    softness: FloatArray
    constant: FloatArray

    @classmethod
    def of(cls, strength: FloatArray, softness: FloatArray) -> Bank:
        """Pairs only."""
        return cls(strength, softness, np.zeros(len(strength)))

    def stiffness(self, modulus: FloatArray) -> FloatArray:
        """K at a modulus of each point, shape (points,)."""
        x = modulus[:, None]
        return self.constant + (self.strength * x / (1 + self.softness * x)).sum(axis=1)

    def beside(self, other: Bank) -> Bank:
        """Both banks side by side."""
        return Bank(
            np.concatenate((self.strength, other.strength), axis=1),
            np.concatenate((self.softness, other.softness), axis=1),
            self.constant + other.constant,
        )

    def take(self, index: NDArray[np.int64]) -> Bank:
        """Some of the points, pairs that none of them has left out."""
        used = (self.strength[index] > 0).any(axis=0)
        return Bank(
            self.strength[index][:, used], self.softness[index][:, used], self.constant[index]
        )

    def squeezed(self, largest: FloatArray) -> Bank:
        """Fewer pairs for moduli up to ``largest`` of each point, the same to round-off.

        Notes
        -----
        ``sum m_l X/(1 + a_l X)`` is an integral over a of a function whose next singularity is at
        ``-1/X``: Gauss quadrature with the m_l as weights converges as ``rho^-2n``, ``rho =
        (sqrt(1 + a X) + 1)/(sqrt(1 + a X) - 1)`` with the largest a. Stiff particles need few
        pairs.
        """
        peak = np.where(self.strength > 0, self.softness, 0.0).max(axis=1) * largest
        root = np.sqrt(1 + peak)
        with np.errstate(divide="ignore"):
            rate = 2 * np.log((root + 1) ** 2 / peak)
            needed = np.ceil(-np.log(GAUSS_ERROR) / rate)
        count = self.strength.shape[1]
        classes = np.array([n for n in GAUSS_CLASSES if n < count])
        if not classes.size:
            return self
        chosen = np.where(
            needed <= classes[-1],
            classes[np.searchsorted(classes, needed).clip(0, classes.size - 1)],
            count,
        )
        width = int(chosen.max())
        strength, softness = (np.zeros((len(chosen), width)) for _ in range(2))
        for n in np.unique(chosen):
            rows = chosen == n
            own = self.strength[rows], self.softness[rows]
            if n < count:
                own = _gauss(*own, int(n))
            strength[rows, :n], softness[rows, :n] = own
        return Bank(strength, softness, self.constant)

    def relaxation(self, chain: Chain, instantaneous: FloatArray, before: FloatArray) -> Chain:
        """Exact series of the bonds where X relaxes.

        Parameters
        ----------
        chain
            X over its value at t = 0: a single chain.
        instantaneous
            X at t = 0 [Pa], shape (points,).
        before
            Compliance of another spring before each pair's matrix, so that ``1/X + before`` takes
            the place of 1/X [1/Pa], shape (points,).

        Returns
        -------
        Chain
            Shape (points,), times ascending.
        """
        points, pairs = self.strength.shape
        size = pairs * chain.count
        result = Chain(self.constant.copy(), np.zeros((points, size)), np.ones((points, size)))
        for start in range(0, points, POINTS_AT_ONCE):
            rows = slice(start, start + POINTS_AT_ONCE)
            scale = instantaneous[rows, None]
            series = behind_spring(chain, (self.softness[rows] + before[rows, None]) * scale)
            series = series.times_factor(self.strength[rows] * scale)
            flat = len(scale), size
            times = np.where(series.strengths > 0, series.times, np.inf).reshape(flat)
            order = np.argsort(times, axis=1)
            times = np.take_along_axis(times, order, axis=1)
            result.times[rows] = np.where(np.isinf(times), 1.0, times)
            strengths = series.strengths.reshape(flat)
            result.strengths[rows] = np.take_along_axis(strengths, order, axis=1)
            result.equilibrium[rows] += series.equilibrium.sum(axis=1)
        used = int((result.strengths > 0).sum(axis=1).max(initial=0))
        return Chain(result.equilibrium, result.strengths[:, :used], result.times[:, :used])


def _gauss(strength: FloatArray, softness: FloatArray, count: int) -> tuple[FloatArray, FloatArray]:
    """Gauss quadrature of a discrete measure, by the Lanczos process with full orthogonalisation.

    Measures of fewer points than ``count`` end early: what is left gets no weight.
    """
    mass = strength.sum(axis=1)
    unit = softness.max(axis=1)
    unit = np.where(unit > 0, unit, 1.0)
    nodes = softness / unit[:, None]
    vector = np.sqrt(strength / mass[:, None])
    jacobi = np.zeros((len(mass), count, count))
    basis = np.zeros((len(mass), count, nodes.shape[1]))
    for n in range(count):
        basis[:, n] = vector
        image = nodes * vector
        jacobi[:, n, n] = (vector * image).sum(axis=1)
        for _ in range(2):
            shares = np.einsum("pkl,pl->pk", basis[:, : n + 1], image)
            image = image - np.einsum("pk,pkl->pl", shares, basis[:, : n + 1])
        norm = np.linalg.norm(image, axis=1)
        norm = np.where(norm > 1e-15, norm, 0.0)
        vector = image / np.where(norm > 0, norm, 1.0)[:, None] * (norm > 0)[:, None]
        if n + 1 < count:
            jacobi[:, n, n + 1] = jacobi[:, n + 1, n] = norm
    points, vectors = np.linalg.eigh(jacobi)
    return mass[:, None] * vectors[:, 0] ** 2, np.clip(points, 0.0, None) * unit[:, None]
