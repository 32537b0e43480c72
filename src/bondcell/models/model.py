"""What a bond model is: a name, a source, a range of validity and a function for each load."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bondcell.cell import Cell, FloatArray
from bondcell.errors import InputError, Violation


@dataclass(frozen=True)
class Springs:
    """A model's answer.

    Parameters
    ----------
    stiffness
        Stiffness of the bond on the broadcast shape of the cell [N/m for the normal load].
    parts
        Individual springs by name (``k_i``, ``k_int``, ``k_j``), same shape and unit.
    relative_error
        Bound of the evaluation's own numerical error, relative. It says nothing on how well the
        model describes the cell: that is what the reference is for.
    """

    stiffness: FloatArray
    parts: Mapping[str, FloatArray] = field(default_factory=dict)
    relative_error: FloatArray | float = 0.0

    @classmethod
    def of_cell(
        cls,
        cell: Cell,
        stiffness: FloatArray,
        relative_error: FloatArray | float,
        **parts: FloatArray,
    ) -> Springs:
        """Spread a model's arrays over the shape of the cell, inputs it ignores included."""
        shape = cell.shape
        spread = {name: np.broadcast_to(part, shape) for name, part in parts.items()}
        return cls(np.broadcast_to(stiffness, shape), spread, relative_error)


def radius_ratio(option: str, value: Any, otherwise: str = "") -> float:
    """Check an option that is a radius over the smaller particle's, in (0, 1].

    Parameters
    ----------
    option
        Name of the option.
    value
        What was given.
    otherwise
        What else is accepted, for the message.

    Raises
    ------
    InputError
        The value is no number of that interval.
    """
    number = isinstance(value, int | float | np.number) and not isinstance(value, bool)
    if not number or not 0.0 < value <= 1.0:
        raise InputError([Violation(option, value, f"(0, 1]{otherwise}")])
    return float(value)


def in_series(*springs: FloatArray) -> FloatArray:
    """Stiffness of springs in a row; an infinite one does not matter."""
    return np.asarray(1.0 / sum(1.0 / spring for spring in springs))


def everywhere(cell: Cell) -> NDArray[np.bool_]:
    """Validity of a model that holds for every cell."""
    return np.ones(cell.shape, dtype=bool)


@dataclass(frozen=True)
class Model:
    """An entry of ``bondcell.MODELS``.

    Parameters
    ----------
    name, title, summary
        How it is called, in a word, a phrase and a sentence.
    source
        Where it comes from.
    valid_range
        Where it claims to hold, in words.
    loads
        Load name -> function ``(cell, **options) -> Springs``.
    options
        Option name -> what it does.
    is_valid
        Which points of a cell lie in the valid range, for every load.
    limits
        Load name -> which points lie in a range of that load's own; both count.
    is_reference
        Whether it is the finite element reference, which `bondcell.evaluate` runs by geometry.
    from_reference
        Whether it interpolates the reference: close to it by construction, no rival of formulas.
    """

    name: str
    title: str
    summary: str
    source: str
    valid_range: str
    loads: Mapping[str, Callable[..., Springs]]
    options: Mapping[str, str] = field(default_factory=dict)
    is_valid: Callable[[Cell], NDArray[np.bool_]] = everywhere
    limits: Mapping[str, Callable[[Cell], NDArray[np.bool_]]] = field(default_factory=dict)
    is_reference: bool = False
    from_reference: bool = False

    def holds(self, load: str, cell: Cell) -> NDArray[np.bool_]:
        """Which points of a cell lie in the valid range of a load."""
        return np.asarray(self.is_valid(cell) & self.limits.get(load, everywhere)(cell))
