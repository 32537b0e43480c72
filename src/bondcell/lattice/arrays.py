"""Arrays as users give them."""

from __future__ import annotations

from typing import Any

import numpy as np

from bondcell.cell import FloatArray
from bondcell.errors import InputError, Violation


def numbers(field: str, given: object) -> FloatArray:
    """An array of numbers, or an error that names the field.

    Examples
    --------
    >>> numbers("radii", [1, 2])
    array([1., 2.])
    """
    try:
        if given is None:
            raise TypeError
        return np.asarray(given, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise InputError([Violation(field, given, "numbers in rows of one length")]) from error


def spread(field: str, given: object, shape: tuple[int, ...], kind: type) -> Any:
    """An array broadcast to a shape, or an error that names the field."""
    values: Any = np.asarray(numbers(field, given), dtype=kind)
    try:
        return np.broadcast_to(values, shape)
    except ValueError as error:
        allowed = f"a shape that broadcasts to {shape}: nodes, unknowns of a node"
        raise InputError([Violation(field, values.shape, allowed)]) from error
