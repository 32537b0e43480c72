"""Quantities as people write them: ``0.5 mm``, ``1.4 MPa``, ``46 %`` or a bare SI number."""

from __future__ import annotations

import math
import re
from decimal import Decimal
from functools import lru_cache
from numbers import Real
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import pint

LONGEST = 60
"""Longest text that is looked at, in characters."""

NUMBER = r"[+-]?(?:[0-9]{1,40}(?:\.[0-9]{0,40})?|\.[0-9]{1,40})(?:[eE][+-]?[0-9]{1,3})?"
"""A decimal number; no digit groups, no other bases, no comma."""

_FACTOR = r"[A-Za-zµμÅ]{1,24}(?:(?:\^|\*\*)-?[1-4]|[²³])?"
UNIT = rf"(?:%|{_FACTOR}(?:\s{{0,3}}[/ ]\s{{0,3}}{_FACTOR}){{0,2}})"
"""A unit: names with small whole exponents, multiplied by a space or divided by ``/``."""

_QUANTITY = re.compile(rf"\s*({NUMBER})\s*({UNIT})?\s*", re.ASCII)
_RIGID = re.compile(r"\s*(?:rigid|\+?\.?inf)\s*", re.IGNORECASE)

PREFIXES = {"": 0, "k": 3, "M": 6, "G": 9, "c": -2, "m": -3, "u": -6, "µ": -6, "μ": -6, "n": -9}
"""Powers of ten of the prefixes that nearly every scene makes do with."""

EXAMPLES = {"m": "0.5 mm", "Pa": "1.4 MPa", "s": "1 ms", "1": "0.46"}
"""How a value of each supported SI unit may be written."""

_KINDS = {"m": "a length", "Pa": "a pressure", "s": "a time", "1": "a number without unit"}


class UnitsWarning(UserWarning):
    """A value that is allowed, but so unusual that its unit was probably forgotten."""


class NotAllowed(ValueError):
    """A single value is not acceptable; says what would have been.

    Parameters
    ----------
    allowed
        What would have been accepted, in words or as an interval, with its unit.
    """

    def __init__(self, allowed: str) -> None:
        self.allowed = allowed
        super().__init__(f"allowed is {allowed}")


def parse_quantity(value: Any, unit: str = "1", *, allow_infinite: bool = False) -> float:
    """Read a number or a text with a unit as a finite SI number.

    Parameters
    ----------
    value
        A number (SI), a number as text (``"1e-3"``, SI), or ``"<number> <unit>"``. Never evaluated:
        an expression is refused.
    unit
        SI unit of the result: ``"m"``, ``"Pa"``, ``"s"`` or ``"1"``. A dimensionless value may be
        given in per cent.
    allow_infinite
        Whether an infinite number, also written ``rigid``, is accepted.

    Returns
    -------
    float
        The value in `unit`, correctly rounded: ``0.3 mm`` is exactly ``3e-4``.

    Raises
    ------
    NotAllowed
        Not a number, a wrong dimension, an unknown unit, not finite.

    Examples
    --------
    >>> parse_quantity("0.5 mm", "m")
    0.0005
    >>> parse_quantity("1.4 N/mm^2", "Pa")
    1400000.0
    >>> parse_quantity("46 %")
    0.46
    >>> parse_quantity("rigid", "Pa", allow_infinite=True)
    inf
    >>> parse_quantity("2 kg", "m")
    Traceback (most recent call last):
    bondcell.scenes.quantities.NotAllowed: allowed is a length [m], bare or with its unit, as in \
0.5 mm; kg is no length
    """
    allowed = describe(unit, allow_infinite=allow_infinite)
    if allow_infinite and _is_rigid(value):
        return math.inf
    if isinstance(value, str):
        number = _parse_text(value, unit, allowed)
    elif isinstance(value, bool) or not isinstance(value, Real):
        raise NotAllowed(allowed)
    else:
        number = _to_float(value)
    if not math.isfinite(number):
        raise NotAllowed(f"{allowed}; finite")
    return number


def describe(unit: str, *, allow_infinite: bool = False) -> str:
    """Say what `parse_quantity` accepts.

    Examples
    --------
    >>> describe("Pa", allow_infinite=True)
    'a pressure [Pa], bare or with its unit, as in 1.4 MPa, or rigid'
    >>> describe("1")
    'a number without unit, as in 0.46'
    """
    label = "" if unit == "1" else f" [{unit}], bare or with its unit"
    infinite = ", or rigid" if allow_infinite else ""
    return f"{_KINDS[unit]}{label}, as in {EXAMPLES[unit]}{infinite}"


def _is_rigid(value: Any) -> bool:
    if isinstance(value, str):
        return len(value) <= LONGEST and _RIGID.fullmatch(value) is not None
    return isinstance(value, float) and value == math.inf


def _parse_text(text: str, unit: str, allowed: str) -> float:
    if len(text) > LONGEST:
        raise NotAllowed(f"{allowed}; at most {LONGEST} characters")
    match = _QUANTITY.fullmatch(text)
    if match is None:
        raise NotAllowed(allowed)
    number, written_unit = match.groups()
    if written_unit is None:
        return _to_float(number)
    # Decimal arithmetic rounds once, at the end: 0.3 mm and 3e-4 are the same number.
    return _to_float(Decimal(number) * _factor(written_unit, unit))


def _to_float(number: Real | str | Decimal) -> float:
    try:
        return float(number)
    except OverflowError:
        return math.inf


@lru_cache(maxsize=256)
def _factor(written: str, unit: str) -> Decimal:
    """Size of the written unit in the SI unit."""
    allowed = describe(unit)
    if unit == "1":
        if written in ("%", "percent"):
            return Decimal("0.01")
        raise NotAllowed(f"{allowed}; {written} is a unit")
    if written == "%":
        raise NotAllowed(f"{allowed}; % is no unit of it")
    prefix = written.removesuffix(unit)
    if written.endswith(unit) and prefix in PREFIXES:
        return Decimal(1).scaleb(PREFIXES[prefix])
    registry = _registry()
    try:
        parsed = registry.parse_units(written)
        # A dimensionless factor (m/rad, m/pi) is a slip, not a unit of length or pressure.
        proper = all(registry.Unit(name).dimensionality for name in parsed._units)
        fits = proper and parsed.dimensionality == registry.Unit(unit).dimensionality
        size = registry.get_base_units(parsed)[0]
    except Exception as error:
        # The library raises whatever its parser meets (KeyError, TypeError, ...) on odd names.
        raise NotAllowed(f"{allowed}; {written} is no known unit") from error
    if not fits:
        raise NotAllowed(f"{allowed}; {written} is no {_KINDS[unit].split()[-1]}")
    return Decimal(str(size))


@lru_cache(maxsize=1)
def _registry() -> pint.UnitRegistry[Any]:
    # Half a second: paid only by an input with another unit than a prefix and the SI unit.
    import pint

    return pint.UnitRegistry(non_int_type=Decimal)
