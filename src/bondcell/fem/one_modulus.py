"""The reference's stiffness as a sum of springs in one modulus of the matrix, particles fixed.

For elastic particles, and a matrix whose bulk modulus or whose Poisson's ratio stays, the
discrete stiffness is ``K = K_0 + c x + sum m x/(1 + a x)`` in the share x of the relaxing modulus,
all terms positive: the eigenvalues of a pencil with thousands of terms, of which few count. They
are found from solutions at few moduli (`positive_fit`), chosen until others are met.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from bondcell.cell import FloatArray
from bondcell.prony.bank import Bank
from bondcell.prony.chain import Chain
from bondcell.prony.positive_fit import PositiveFit, positive_fit

FIRST, MORE, ROUNDS = 9, 3, 7
"""Moduli solved at first, added in each round, and rounds at most."""

REACH = 3.0
"""Moduli are sampled up to this factor beyond the range of relaxation."""


@dataclass(frozen=True)
class OneModulus:
    """A reduced model in one modulus.

    Parameters
    ----------
    fit
        The springs.
    missed
        Largest relative error at moduli that the fit had not seen.
    """

    fit: PositiveFit
    missed: float

    def stiffness(self, share: FloatArray) -> FloatArray:
        """K at shares of the modulus, shape of the shares."""
        return self.fit(share)

    def series(self, chain: Chain) -> Chain:
        """The exact series where the modulus relaxes by a chain."""
        fit = self.fit
        strength, softness = np.append(fit.strength, fit.bare), np.append(fit.softness, 0.0)
        bank = Bank(strength[None], softness[None], np.array([fit.constant]))
        series = bank.relaxation(chain, np.ones(1), np.zeros(1))
        return Chain(series.equilibrium[0], series.strengths[0], series.times[0])


def reduce_one(
    stiffness: Callable[[float], float], lowest: float, has_constant: bool, tolerance: float
) -> OneModulus:
    """Reduce a cell for the moduli from a lowest share on.

    Parameters
    ----------
    stiffness
        K at a share of the modulus.
    lowest
        Least share to look at.
    has_constant
        Whether anything is left without the modulus.
    tolerance
        Relative error that the reduction may leave at moduli it has not seen.
    """
    x = np.geomspace(lowest, REACH, FIRST)
    values = np.array([stiffness(float(share)) for share in x])
    for attempt in range(ROUNDS):
        fit = positive_fit(x, values, has_constant)
        fresh = _doubtful(fit, positive_fit(x[::2], values[::2], has_constant), x)
        found = np.array([stiffness(float(share)) for share in fresh])
        missed = float(np.abs(fit(fresh) / found - 1).max())
        if missed <= tolerance or attempt == ROUNDS - 1:
            break
        order = np.argsort(np.concatenate((x, fresh)))
        x = np.concatenate((x, fresh))[order]
        values = np.concatenate((values, found))[order]
    return OneModulus(fit, max(missed, fit.error, tolerance))


def _doubtful(fit: PositiveFit, other: PositiveFit, x: FloatArray) -> FloatArray:
    """Moduli between the known ones where fits of all and of half of the values differ most."""
    between = np.sqrt(x[:-1] * x[1:])
    differ = np.abs(fit(between) / other(between) - 1)
    return np.asarray(between[np.sort(np.argsort(-differ, kind="stable")[:MORE])])
