"""A chain of many terms replaced by one of few, over a window of time."""

from __future__ import annotations

from typing import Any

import numpy as np

from bondcell.cell import FloatArray
from bondcell.errors import InputError, Violation
from bondcell.prony.best_exponentials import Curve, Exponentials, best_exponentials
from bondcell.prony.chain import Chain, merged
from bondcell.relaxing_ranges import TIMES

CHECKED = 80
"""Times a decade at which the error that is told is measured."""


def reduce_chain(
    chain: Chain,
    count: int | None,
    window: tuple[float, float] | None,
    error: float | None = None,
) -> tuple[Chain, float]:
    """Fit a chain of few terms; what never relaxes stays as it is.

    Parameters
    ----------
    chain
        A single chain.
    count
        Largest number of terms; None: as few as `error` allows.
    window
        First and last time of interest [s], in `TIMES`.
    error
        Largest relative error allowed; None where `count` is given.

    Returns
    -------
    Chain
        Terms with times around the window; those that relax before it are given up.
    float
        Largest relative error of k(t) in the window, seen at `CHECKED` times a decade.

    Examples
    --------
    >>> chain = Chain(np.array(1.0), np.full(3, 2.0), np.array([1.0, 1.01, 50.0]))
    >>> few, error = reduce_chain(chain, 2, (1e-2, 1e3))
    >>> few.strengths.round(3), few.times.round(3), bool(error < 1e-4)
    (array([4., 2.]), array([ 1.005, 50.   ]), True)
    >>> reduce_chain(chain, None, (1e-2, 1e3), error=0.01)[0].count
    2
    """
    low, high = _checked(count, window, error)
    if count is not None and chain.count <= count:
        return chain, 0.0
    curve = Curve.of(chain, (low, high))
    if not np.all(curve.values > 0):
        bad = float(curve.times[curve.values <= 0][0])
        raise InputError([Violation("window", (low, high), f"times before {bad:g} s: K is zero")])
    if count is not None:
        fit = _of_size(curve, count)
        return _chain_and_error(chain, fit, (low, high))
    assert error is not None
    known: Exponentials | None = None
    for size in range(1, chain.count):
        known = best_exponentials(curve, size, known, error)
        if known.error <= error:
            few, missed = _chain_and_error(chain, known, (low, high))
            if missed <= error:
                return few, missed
    return chain, 0.0


def _of_size(curve: Curve, count: int) -> Exponentials:
    """The best of a size; of one less, where that helps to find it."""
    fit = best_exponentials(curve, count)
    if fit.is_best or count == 1:
        return fit
    fewer = best_exponentials(curve, count - 1)
    more = best_exponentials(curve, count, fewer)
    return min(fit, more, fewer, key=lambda own: own.error)


def _chain_and_error(
    chain: Chain, fit: Exponentials, window: tuple[float, float]
) -> tuple[Chain, float]:
    few = Chain(chain.equilibrium, *merged(fit.strengths, fit.times))
    decades = np.log10(window[1] / window[0])
    times: FloatArray = np.geomspace(*window, int(np.ceil(CHECKED * decades)) + 2)
    return few, float(np.abs(few.relaxation(times) / chain.relaxation(times) - 1).max())


def _checked(count: Any, window: Any, error: Any) -> tuple[float, float]:
    bad = []
    if (count is None) == (error is None):
        bad.append(Violation("terms", count, "either a number of terms or an error"))
    elif error is not None:
        number = isinstance(error, int | float | np.number) and not isinstance(error, bool)
        if not (number and 0 < error < 1):
            bad.append(Violation("error", error, "a number in (0, 1)"))
    elif not isinstance(count, int | np.integer) or isinstance(count, bool) or count < 1:
        bad.append(Violation("terms", count, "a whole number, at least 1"))
    try:
        pair = np.asarray(window, dtype=float)
    except (TypeError, ValueError):
        pair = np.empty(0)
    if pair.shape != (2,) or not TIMES[0] <= pair[0] < pair[1] <= TIMES[1]:
        allowed = f"two times [s], 0 < first < last, in [{TIMES[0]:g}, {TIMES[1]:g}]"
        bad.append(Violation("window", window, allowed))
    if bad:
        raise InputError(bad)
    return float(pair[0]), float(pair[1])
