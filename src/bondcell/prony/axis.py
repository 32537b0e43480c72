"""Times and frequencies as users give them."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from bondcell.cell import FloatArray
from bondcell.errors import InputError, Violation


def checked_axis(name: str, given: ArrayLike, allow_end: bool = True) -> FloatArray:
    """A list of numbers that are not negative.

    Parameters
    ----------
    name
        What they are, for the error.
    given
        One number or a list.
    allow_end
        Whether infinity is one of them.

    Raises
    ------
    InputError
        Names the first wrong value.

    Examples
    --------
    >>> checked_axis("time", 3)
    array([3.])
    """
    allowed = f"a list of numbers in [0, {'inf]' if allow_end else 'inf)'}"
    try:
        raw = np.atleast_1d(np.asarray(given))
    except ValueError:
        raw = np.empty((0, 0))
    if raw.ndim != 1 or not raw.size or raw.dtype.kind not in "iuf":
        raise InputError([Violation(name, given, allowed)])
    values = raw.astype(float)
    wrong = ~((values >= 0) & (np.isfinite(values) | allow_end))
    if wrong.any():
        raise InputError([Violation(name, float(values[wrong][0]), allowed)])
    return values
