"""Values spread from a start to a stop: decimal numbers, far enough apart to differ."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from bondcell.cell import FloatArray
from bondcell.scenes.quantities import NotAllowed

FINEST_STEP = 1e-14
"""Smallest step of a range, relative to its larger end: finer ones drown in round-off."""


@lru_cache(maxsize=8)
def spread(start: float, stop: float, points: int, spacing: str) -> FloatArray:
    """Values from start to stop, both included, free of round-off: 0.3, not 0.30000000000000004.

    Parameters
    ----------
    start, stop
        The ends; either may be the larger one.
    points
        Number of values.
    spacing
        ``lin`` for equal steps, ``log`` for equal ratios.

    Returns
    -------
    numpy.ndarray
        Shape (points,), read-only: the same range is spread once.

    Examples
    --------
    >>> spread(0.0, 0.4, 5, "lin").tolist()
    [0.0, 0.1, 0.2, 0.3, 0.4]
    """
    raw = (
        np.linspace(start, stop, points) if spacing == "lin" else np.geomspace(start, stop, points)
    )
    values = np.fromiter((float(f"{value:.15g}") for value in raw.tolist()), np.float64, points)
    values[[0, -1]] = start, stop
    values.flags.writeable = False
    return values


def check_apart(start: float, stop: float, points: int) -> None:
    """Check that the values of a range differ from each other."""
    widest = max(abs(start), abs(stop))
    if abs(stop - start) / widest < FINEST_STEP * points:
        raise NotAllowed("points that differ; start and stop are too close for so many")
