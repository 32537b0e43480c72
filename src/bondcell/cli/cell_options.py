"""The options that describe one bond cell, read and checked all at once."""

from __future__ import annotations

import argparse

from bondcell.cell import LONG_NAMES, REQUIRED, UNITS, Cell
from bondcell.errors import InputError, Violation
from bondcell.scenes.likely_units import unlikely
from bondcell.scenes.quantities import EXAMPLES, NotAllowed, parse_quantity

OPTIONS = {
    "radius_i": "--radius",
    "radius_j": "--radius-j",
    "gap": "--gap",
    "cylinder_radius": "--cylinder-radius",
    "young_i": "--young-particle",
    "young_j": "--young-particle-j",
    "poisson_i": "--poisson-particle",
    "poisson_j": "--poisson-particle-j",
    "young_m": "--young-matrix",
    "poisson_m": "--poisson-matrix",
}
"""Input -> option."""

_DEFAULTS = {
    "radius_j": "that of particle i",
    "young_j": "that of particle i",
    "poisson_j": "that of particle i",
    "cylinder_radius": "the larger radius",
}

_NEUTRAL = {name: 0.0 if unit == "1" else 1.0 for name, unit in UNITS.items()}
"""Stands in for what is missing or unreadable, so that the rest is checked as well."""


def add_cell_options(parser: argparse.ArgumentParser) -> None:
    """Add an option for each input of the cell; the values stay text until they are all read."""
    group = parser.add_argument_group("the bond cell (bare numbers are SI; units may be written)")
    for name, option in OPTIONS.items():
        unit = "" if UNITS[name] == "1" else f" [{UNITS[name]}]"
        text = f"{LONG_NAMES[name]}{unit}, as in {EXAMPLES[UNITS[name]]!r}"
        if name in _DEFAULTS:
            text += f"; default: {_DEFAULTS[name]}"
        group.add_argument(option, dest=name, metavar="VALUE", help=text.replace("%", "%%"))


def read_cell(arguments: argparse.Namespace) -> tuple[Cell | None, list[Violation]]:
    """The cell that the options describe, or every reason why there is none.

    Parameters
    ----------
    arguments
        What the parser found: each input as text or None.
    """
    values: dict[str, float] = {}
    violations: dict[str, Violation] = {}
    for name, option in OPTIONS.items():
        text = getattr(arguments, name)
        if text is None:
            if name in REQUIRED:
                unit = "" if UNITS[name] == "1" else f" [{UNITS[name]}]"
                allowed = f"the {LONG_NAMES[name]}{unit}: required"
                violations[name] = Violation(option, None, allowed)
            continue
        try:
            rigid = name in ("young_i", "young_j")
            values[name] = parse_quantity(text, UNITS[name], allow_infinite=rigid)
        except NotAllowed as error:
            violations[name] = Violation(option, text, error.allowed)
    violations |= _range_violations(values)
    if violations:
        return None, [violations[name] for name in OPTIONS if name in violations]
    return Cell.from_values(**values), []


def unit_warnings(cell: Cell) -> list[str]:
    """Values that are allowed, but whose unit was probably forgotten."""
    found: dict[str, str] = {}
    for name in OPTIONS:
        oddity = unlikely(name, getattr(cell, name))
        if oddity:  # a default repeats the value of another option: told once
            found.setdefault(oddity, f"{OPTIONS[name]} = {oddity}")
    return list(found.values())


def _range_violations(values: dict[str, float]) -> dict[str, Violation]:
    filled = {**{name: _NEUTRAL[name] for name in REQUIRED}, **values}
    if "radius_i" not in values:
        filled.pop("cylinder_radius", None)
    try:
        Cell.from_values(**filled)
    except InputError as error:
        return {
            violation.field: Violation(
                OPTIONS.get(violation.field, violation.field), violation.value, violation.allowed
            )
            for violation in error.violations
            if violation.field in values
        }
    return {}
