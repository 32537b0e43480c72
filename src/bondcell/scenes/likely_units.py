"""Values that are allowed, but so unusual that their unit was probably forgotten."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from bondcell.cell import UNITS

LARGEST_LIKELY_LENGTH = 1.0
"""Beyond this a length in metres was probably meant in millimetres [m]."""

SMALLEST_LIKELY_MODULUS = 100.0
"""Below this a modulus in pascals was probably meant in megapascals [Pa]."""


def unlikely(name: str, values: ArrayLike) -> str | None:
    """Say what was probably meant by the most unusual value of an input, None if all is usual.

    Parameters
    ----------
    name
        An input of the cell; other names are never unusual.
    values
        Its values [SI].

    Examples
    --------
    >>> unlikely("radius_i", 7.5)
    '7.5 m: beyond 1 m; were millimetres meant (7.5 mm)?'
    >>> unlikely("poisson_m", 0.46) is None
    True
    """
    unit = UNITS.get(name)
    if unit == "m" and (largest := float(np.max(values))) > LARGEST_LIKELY_LENGTH:
        hint = f"beyond {LARGEST_LIKELY_LENGTH:g} m; were millimetres meant (7.5 mm)?"
        return f"{largest:g} m: {hint}"
    if unit == "Pa" and (smallest := float(np.min(values))) < SMALLEST_LIKELY_MODULUS:
        hint = f"below {SMALLEST_LIKELY_MODULUS:g} Pa; were megapascals meant (1.4 MPa)?"
        return f"{smallest:g} Pa: {hint}"
    return None
