"""A chain of many terms replaced by one of few, over a window of time."""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.optimize import least_squares, nnls

from bondcell.cell import FloatArray
from bondcell.errors import InputError, Violation
from bondcell.prony.chain import Chain, merged

SAMPLES = 40
"""Times a decade at which the curves are compared."""


def reduce_chain(chain: Chain, count: int, window: tuple[float, float]) -> tuple[Chain, float]:
    """Fit a chain of at most ``count`` terms; what never relaxes stays as it is.

    Parameters
    ----------
    chain
        A single chain.
    count
        Largest number of terms.
    window
        First and last time of interest [s], both positive.

    Returns
    -------
    Chain
        Terms with times around the window; those that relax before it are given up.
    float
        Largest relative error of k(t) in the window, seen at `SAMPLES` times a decade.

    Notes
    -----
    Strengths by non-negative least squares of the relative error, times by least squares around
    that, from even ones in the logarithm.

    Examples
    --------
    >>> chain = Chain(np.array(1.0), np.full(3, 2.0), np.array([1.0, 1.01, 50.0]))
    >>> few, error = reduce_chain(chain, 2, (1e-2, 1e3))
    >>> few.strengths.round(3), few.times.round(3), bool(error < 1e-4)
    (array([4., 2.]), array([ 1.005, 50.   ]), True)
    """
    low, high = _checked(count, window)
    t = np.geomspace(low, high, int(np.ceil(SAMPLES * np.log10(high / low))) + 2)
    wanted = chain.relaxation(t)
    if chain.count <= count:
        return chain, 0.0
    if not np.all(wanted > 0):
        bad = float(t[wanted <= 0][0])
        raise InputError([Violation("window", (low, high), f"times before {bad:g} s: K is zero")])
    target = 1 - chain.equilibrium / wanted

    def strengths(log_times: FloatArray) -> tuple[FloatArray, FloatArray]:
        table = np.exp(-t[:, None] / np.exp(log_times)) / wanted[:, None]
        found, _ = nnls(table, target)
        return found, table @ found - target

    edges = np.log(low), np.log(high)
    start = np.linspace(edges[0], edges[1], count + 2)[1:-1]
    reach = edges[0] - np.log(10.0), edges[1] + np.log(1e3)
    best = least_squares(lambda logs: strengths(logs)[1], start, bounds=reach, x_scale=1.0).x
    found, misfit = strengths(best)
    few = Chain(chain.equilibrium, *merged(found, np.exp(best)))
    return few, float(np.abs(misfit).max())


def _checked(count: Any, window: Any) -> tuple[float, float]:
    bad = []
    if not isinstance(count, int | np.integer) or isinstance(count, bool) or count < 1:
        bad.append(Violation("terms", count, "a whole number, at least 1"))
    pair = np.asarray(window, dtype=float) if np.size(window) == 2 else np.array([np.nan, 0.0])
    if not (np.isfinite(pair).all() and 0 < pair[0] < pair[1]):
        bad.append(Violation("window", window, "two times [s], 0 < first < last, finite"))
    if bad:
        raise InputError(bad)
    return float(pair[0]), float(pair[1])
