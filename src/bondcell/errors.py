"""Exceptions: complaints about input name field, value and allowed range, all of them at once."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any


class BondcellError(Exception):
    """Base of everything this package raises on purpose."""


LONGEST_SHOWN = 120
"""Longest field or value that a message shows in full, in characters."""


@dataclass(frozen=True)
class Violation:
    """One thing that is wrong with an input.

    Parameters
    ----------
    field
        Name of the offending field, dotted for nested ones (``cell.gap``).
    value
        The value as given.
    allowed
        What would have been accepted, in words or as an interval, with its unit.
    """

    field: str
    value: Any
    allowed: str

    def __str__(self) -> str:
        # A file's own words reach the terminal only as far as they can be printed on one line.
        field = self.field if self.field.isprintable() else ascii(self.field)[1:-1]
        return f"{_cut(field)} = {_cut(repr(self.value))}: allowed is {self.allowed}"


def _cut(text: str) -> str:
    return text if len(text) <= LONGEST_SHOWN else text[: LONGEST_SHOWN - 3] + "..."


class InputError(BondcellError, ValueError):
    """Bad input; carries every violation found, not only the first.

    Parameters
    ----------
    violations
        What is wrong, in reading order.
    source
        The file or command the input came from, if any.
    """

    def __init__(self, violations: Iterable[Violation], source: str | None = None) -> None:
        self.violations = tuple(violations)
        self.source = source
        super().__init__(str(self))

    def __str__(self) -> str:
        where = f"{self.source}: " if self.source else ""
        if len(self.violations) == 1:
            return f"{where}{self.violations[0]}"
        lines = "\n".join(f"  {violation}" for violation in self.violations)
        return f"{where}{len(self.violations)} violations\n{lines}"

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.violations, self.source)


class UnknownModel(InputError):
    """The model's name is not in ``bondcell.MODELS``."""


class UnsupportedLoad(InputError):
    """The model does not cover the load (or the boundary condition) asked for."""


class SceneError(InputError):
    """A scene file is wrong."""


class DataError(InputError):
    """A result file cannot be read, or is not what it should be."""


class CannotWrite(BondcellError):
    """A file cannot be written: no space, no permission; what was there before still is."""


class BoundExceeded(BondcellError):
    """A job needs more memory or time than this attempt has: another one may have it."""


class PointLost(BondcellError):
    """Points need more memory or time than the last attempt has, or ended their process."""


class MissingLibrary(BondcellError):
    """A system library that an optional step needs is absent; the message says what to install."""
