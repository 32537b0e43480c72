"""The best positive sum of few exponentials in the largest relative error.

A relaxation curve is completely monotone: among sums of n exponentials one is nearest to it, its
strengths are positive, and its error reaches the same largest size with alternating signs at 2 n +
1 times (Braess, Nonlinear Approximation Theory, 1986). That alternation tells whether a fit found
is the best there is.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.optimize import least_squares, linprog, nnls

from bondcell.cell import FloatArray
from bondcell.prony.chain import Chain

SAMPLES = 16
"""Times a decade at which errors are looked at."""

MOST_STEPS, FIRST_REACH, LEAST_REACH, LARGEST_REACH = 30, 0.5, 1e-4, 3.0
"""Steps at most, and how far logarithms may move in one."""

GAINED = 5e-3
"""Share of the error that another step must promise."""

LEVEL = 0.96
"""Share of the largest error that counts as reaching it."""

HOPELESS = 5.0
"""Error of a start over the one wanted from which levelling, which halves it, is spared."""

BEYOND = np.log(10.0), np.log(1e3)
"""How far times may lie before and after the window, logarithms."""


@dataclass(frozen=True)
class Curve:
    """What is fitted: values over time, of which a part lasts.

    Parameters
    ----------
    times
        Ascending [s], shape (samples,).
    values
        k(t) > 0, shape (samples,).
    lasting
        What never relaxes, kept as it is.
    """

    times: FloatArray
    values: FloatArray
    lasting: float

    @classmethod
    def of(cls, chain: Chain, window: tuple[float, float]) -> Curve:
        """A chain in a window of time."""
        decades = np.log10(window[1] / window[0])
        times = np.geomspace(*window, int(np.ceil(SAMPLES * decades)) + 2)
        return cls(times, chain.relaxation(times), float(chain.equilibrium))


@dataclass(frozen=True)
class Exponentials:
    """A sum of exponentials and how far it is from a curve.

    Parameters
    ----------
    strengths, times
        Shape (terms,).
    error
        Largest relative error.
    is_best
        Whether it alternates as often as the best one does.
    """

    strengths: FloatArray
    times: FloatArray
    error: float
    is_best: bool


def best_exponentials(
    curve: Curve, count: int, fewer: Exponentials | None = None, wanted: float = np.inf
) -> Exponentials:
    """Fit ``count`` exponentials.

    Parameters
    ----------
    curve
        What is fitted.
    count
        Number of terms.
    fewer
        The fit of one term less, if there is one: another place to start from.
    wanted
        Error wanted: a start that is `HOPELESS` times above it is not followed.

    Notes
    -----
    Starts from least squares near even times, if need be from even times themselves and from the
    times of ``fewer`` with one more; steps of linear programmes lower the largest error from there.

    Examples
    --------
    >>> chain = Chain(np.array(1.0), np.array([1.0, 1.0, 1.0]), np.array([1.0, 30.0, 1000.0]))
    >>> fit = best_exponentials(Curve.of(chain, (1e-3, 1e6)), 2)
    >>> fit.is_best, round(fit.error, 3), fit.times.round(1)
    (True, 0.08, array([  6.6, 649.8]))
    """
    first, last = np.log(curve.times[[0, -1]])
    even = np.linspace(first, last, count + 2)[1:-1]
    starts = [(even, True), (even, False)]
    if fewer is not None:
        starts += [(times, True) for times in _with_one_more(curve, fewer)]
    best = None
    for start, free in starts:
        fit = _levelled(curve, *_least_squares(curve, start, free), wanted)
        if best is None or fit.error < best.error:
            best = fit
        if best.is_best:
            break
    assert best is not None
    return best


def _with_one_more(curve: Curve, fewer: Exponentials) -> list[FloatArray]:
    """Times of a smaller fit and one where it errs most, then one in its widest stretch."""
    known = np.log(fewer.times)
    misfit = np.abs(_misfit(curve, fewer.strengths, fewer.times)[0])
    ends = np.log(curve.times[[0, -1]])
    edges = np.sort(np.concatenate((ends, known)))
    widest = int(np.diff(edges).argmax())
    fresh = [np.log(curve.times[misfit.argmax()]), (edges[widest] + edges[widest + 1]) / 2]
    return [np.sort(np.append(known, one)) for one in fresh]


def _levelled(
    curve: Curve, strengths: FloatArray, log_times: FloatArray, wanted: float
) -> Exponentials:
    """From a start down to where no step lowers the largest error."""
    # What least squares leaves out may yet be of use: a little of it moves to where it is.
    least = 1e-6 * max(strengths.max(), float(curve.values[0]) * 1e-6)
    place = np.concatenate((np.log(np.maximum(strengths, least)), log_times))
    misfit, slope = _at(curve, place)
    error, reach = float(np.abs(misfit).max()), FIRST_REACH
    for _ in range(MOST_STEPS):
        if error > HOPELESS * wanted:
            break
        step, promised = _step(curve, place, misfit, slope, reach)
        if error - promised <= GAINED * error or reach < LEAST_REACH:
            break
        fresh, fresh_slope = _at(curve, place + step)
        gained = (error - float(np.abs(fresh).max())) / (error - promised)
        if gained > 0.1:
            place, misfit, slope = place + step, fresh, fresh_slope
            error = float(np.abs(misfit).max())
        reach = (
            min(2 * reach, LARGEST_REACH) if gained > 0.5 else reach / (1 if gained > 0.1 else 3)
        )
    strengths, times = np.exp(place.reshape(2, -1))
    return Exponentials(strengths, times, error, _alternations(misfit) > 2 * times.size)


def _least_squares(curve: Curve, start: FloatArray, free: bool) -> tuple[FloatArray, FloatArray]:
    """Strengths by non-negative least squares of the relative error, times too if ``free``."""
    target = 1 - curve.lasting / curve.values

    def fitted(log_times: FloatArray) -> tuple[FloatArray, FloatArray]:
        table = np.exp(-curve.times[:, None] / np.exp(log_times)) / curve.values[:, None]
        found, _ = nnls(table, target)
        return found, table @ found - target

    if not free:
        return fitted(start)[0], start
    low, high = np.log(curve.times[0]) - BEYOND[0], np.log(curve.times[-1]) + BEYOND[1]
    inside = np.clip(start, low + 1e-9, high - 1e-9)
    best = least_squares(lambda logs: fitted(logs)[1], inside, bounds=(low, high), x_scale=1.0).x
    return fitted(best)[0], best


def _step(
    curve: Curve, place: FloatArray, misfit: FloatArray, slope: FloatArray, reach: float
) -> tuple[FloatArray, float]:
    """The step within reach that lowers the largest error most, to first order, and to what."""
    size = place.size
    ones = np.ones((misfit.size, 1))
    table = np.block([[slope, -ones], [-slope, -ones]])
    ends = np.log(curve.times[[0, -1]])
    low, high = np.full(size, -reach), np.full(size, reach)
    log_times = place[size // 2 :]
    low[size // 2 :] = np.clip(ends[0] - BEYOND[0] - log_times, -reach, 0.0)
    high[size // 2 :] = np.clip(ends[1] + BEYOND[1] - log_times, 0.0, reach)
    found = linprog(
        np.append(np.zeros(size), 1.0),
        A_ub=table,
        b_ub=np.concatenate((-misfit, misfit)),
        bounds=[*zip(low, high, strict=True), (0, None)],
        method="highs",
    )
    if found.x is None:
        return np.zeros(size), float(np.abs(misfit).max())
    return found.x[:-1], float(found.x[-1])


def _at(curve: Curve, place: FloatArray) -> tuple[FloatArray, FloatArray]:
    strengths, times = np.exp(place.reshape(2, -1))
    return _misfit(curve, strengths, times)


def _misfit(
    curve: Curve, strengths: FloatArray, times: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Relative errors, and their slopes in the logarithms of strengths and times."""
    x = curve.times[:, None] / times
    terms = strengths * np.exp(-x) / curve.values[:, None]
    misfit = curve.lasting / curve.values + terms.sum(axis=1) - 1
    return misfit, np.concatenate((terms, x * terms), axis=1)


def _alternations(misfit: FloatArray) -> int:
    """How often in a row the largest error is reached with the other sign."""
    reached = np.sign(misfit[np.abs(misfit) >= LEVEL * np.abs(misfit).max()])
    return 1 + int((reached[1:] != reached[:-1]).sum())
