"""Series of a network whose shear and bulk springs relax by a chain each.

A prescribed motion and few unknowns v are held by ``P + x(s) D + y(s) B``, symmetric and not
negative, where the Laplace variable s sets both moduli, ``x = g_inf + sum g_k s tau_k/(1 + s
tau_k)`` and y alike. What is left on the motion after v is eliminated is a Prony series again.

With ``D = R^T R`` every term has internal strains ``e = sqrt(g_k) R u / (1 + s tau_k)``.
Eliminating v leaves ``(H - Z A_0^-1 Z^T) e = c``, ``H = 1 + s T``, where Z stacks ``sqrt(g_k) R``
(and the same of B) on v, T their times, and ``A(s)`` is the network on v, A_0 that at t = 0. With
``T^(1/2) (H - Z A_0^-1 Z^T)^-1 T^(1/2) = G^T G``::

    G = [ sqrt(T/H)               ]        A(s) = L L^T
        [ L^-1 Z^T sqrt(T) / H    ]

each singular value of G gives a rate, ``1/sigma^2 = w + s``, and its vector u the strength ``4 w
(u^T sqrt(T) e(w))^2``, e the strains at ``s = w``. Nothing cancels, and one-sided Jacobi rotations
find singular values of such graded columns to their own precision however far apart times are.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.linalg
from scipy.linalg.lapack import dgejsv

from bondcell.cell import FloatArray
from bondcell.prony.chain import Chain

SHIFT = 1e-8
"""Where a fluid is looked at from, s times its longest time: at rest it has no stiffness."""

AT_REST = 1e-3
"""Rates below this times that s are those of a fluid at rest, which bear nothing."""

RANK = 1e-15
"""Share of the largest eigenvalue of D or B below which one is round-off."""

NEGLIGIBLE = 1e-17
"""Strength, over what K is when the term relaxes, that changes no digit."""


@dataclass(frozen=True)
class Network:
    """A prescribed motion, first, and unknowns; arrays of shape (1 + n, 1 + n).

    Parameters
    ----------
    lasting
        P [N/m; N m/rad].
    shear, bulk
        D and B, at unit share of the moduli.
    """

    lasting: FloatArray
    shear: FloatArray
    bulk: FloatArray

    def stiffness(self, shear: FloatArray, bulk: FloatArray) -> FloatArray:
        """K at shares of both moduli, shape of the shares (states,)."""
        whole = self._at(shear, bulk)
        solved = self._solve(whole)
        return np.asarray(whole[:, 0, 0] + (whole[:, 0, 1:] * solved).sum(axis=1))

    def relaxation(self, shear: Chain, bulk: Chain, bears_at_rest: bool = True) -> Chain:
        """The exact series.

        Parameters
        ----------
        shear, bulk
            Single chains of shares.
        bears_at_rest
            Whether anything is left once a modulus without equilibrium has relaxed.

        Examples
        --------
        A spring of 4 before a matrix of one kind, the check value of theory.md:

        >>> chain = Chain(np.array(1.0), np.array([2.0, 3.0]), np.array([1.0, 10.0]))
        >>> spring, both = np.array([[0.0, 0.0], [0.0, 4.0]]), np.array([[1.0, -1.0], [-1.0, 1.0]])
        >>> none = Chain(np.array(1.0), np.empty(0), np.empty(0))
        >>> series = Network(spring, both, np.zeros((2, 2))).relaxation(chain, none)
        >>> series.times.round(8), series.strengths.round(8), round(float(series.equilibrium), 8)
        (array([ 1.23742672, 16.16257328]), array([0.36047333, 1.23952667]), 0.8)
        """
        stacked, times = self._stacked(shear, bulk)
        fluid = min(float(shear.equilibrium), float(bulk.equilibrium)) == 0.0
        seen_from = SHIFT / times.max() if fluid and times.size else 0.0
        at = np.array([seen_from])
        x, y = shear.transform(at), bulk.transform(at)
        rates, vectors = self._modes(stacked[:, 1:], times, self._at(x, y)[0, 1:, 1:], seen_from)
        whole = self._at(shear.transform(rates), bulk.transform(rates))
        motion = np.column_stack([np.ones(rates.size), self._solve(whole)])
        strains = (stacked @ motion.T) * (np.sqrt(times)[:, None] / (1 + np.outer(times, rates)))
        strengths = 4 * rates * (vectors * strains).sum(axis=0) ** 2
        value = float(self.stiffness(x, y)[0])
        rest = value - float((strengths * seen_from / (seen_from + rates)).sum())
        end = max(rest, 0.0) if bears_at_rest or not fluid else 0.0
        return _without_nothing(Chain(np.asarray(end), strengths, 1 / rates))

    def _at(self, shear: FloatArray, bulk: FloatArray) -> FloatArray:
        x, y = shear[:, None, None], bulk[:, None, None]
        return np.asarray(self.lasting + x * self.shear + y * self.bulk)

    @staticmethod
    def _solve(whole: FloatArray) -> FloatArray:
        """Unknowns for a unit motion, shape (states, n)."""
        matrix = whole[:, 1:, 1:]
        scale = 1 / np.sqrt(np.diagonal(matrix, axis1=1, axis2=2))
        scaled = matrix * scale[:, :, None] * scale[:, None, :]
        right = -(whole[:, 1:, 0] * scale)[:, :, None]
        return np.asarray(np.linalg.solve(scaled, right)[:, :, 0] * scale)

    def _stacked(self, shear: Chain, bulk: Chain) -> tuple[FloatArray, FloatArray]:
        """Z with the motion's own column first, and the time of each row."""
        rows, times = [np.empty((0, len(self.lasting)))], [np.empty(0)]
        for matrix, chain in ((self.shear, shear), (self.bulk, bulk)):
            root = _root(matrix)
            for strength, tau in zip(chain.strengths, chain.times, strict=True):
                rows.append(np.sqrt(strength) * root)
                times.append(np.full(len(root), tau))
        return np.concatenate(rows), np.concatenate(times)

    @staticmethod
    def _modes(
        stacked: FloatArray, times: FloatArray, whole: FloatArray, seen_from: float
    ) -> tuple[FloatArray, FloatArray]:
        """Rates, and vectors as columns, slow ones first."""
        order = np.argsort(-times, kind="stable")
        share = 1 + seen_from * times[order]
        factor = _scaled_factor(whole, stacked[order].T)
        top = np.diag(np.sqrt(times[order] / share))
        graded = np.concatenate((top, factor * (np.sqrt(times[order]) / share)))
        size, _, right, work, _, failed = dgejsv(np.asfortranarray(graded), joba=0, jobu=3, jobv=0)
        if failed:
            raise np.linalg.LinAlgError("the rates of a network were not found")
        rates = (size * (work[0] / work[1])) ** -2.0 - seen_from
        moving = rates > AT_REST * seen_from
        vectors = np.empty_like(right)
        vectors[order] = right
        return rates[moving], vectors[:, moving]


def _root(matrix: FloatArray) -> FloatArray:
    """R with ``R^T R`` a matrix that is not negative, as many rows as its rank."""
    values, vectors = np.linalg.eigh(matrix)
    kept = values > RANK * values[-1]
    return np.asarray(np.sqrt(values[kept])[:, None] * vectors[:, kept].T)


def _scaled_factor(matrix: FloatArray, right: FloatArray) -> FloatArray:
    """``L^-1 right`` for ``matrix = L L^T``."""
    scale = 1 / np.sqrt(np.diagonal(matrix))
    factor = np.linalg.cholesky(matrix * scale * scale[:, None])
    solved = scipy.linalg.solve_triangular(factor, scale[:, None] * right, lower=True)
    return np.asarray(solved)


def _without_nothing(chain: Chain) -> Chain:
    """Times ascending, without terms that change no digit of k(t)."""
    order = np.argsort(chain.times)
    sorted_ = Chain(chain.equilibrium, chain.strengths[order], chain.times[order])
    kept = sorted_.strengths > NEGLIGIBLE * sorted_.relaxation(sorted_.times)
    return Chain(sorted_.equilibrium, sorted_.strengths[kept], sorted_.times[kept])
