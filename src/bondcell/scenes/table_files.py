"""Tables of points beside a scene: CSV or netCDF files, a column or variable a parameter."""

from __future__ import annotations

import csv
import re
from collections.abc import Collection
from pathlib import Path
from typing import Any

import numpy as np

from bondcell.cell import UNITS, FloatArray
from bondcell.errors import Violation
from bondcell.scenes.quantities import NotAllowed, parse_quantity

TABLE_NAME = re.compile(r"[A-Za-z0-9_][A-Za-z0-9_.-]{0,99}\.(csv|nc)")
"""Names of tables: files beside the scene, not somewhere else."""

TABLE_RULE = "a file name beside the scene that ends in .csv or .nc"

MOST_SHOWN = 5
"""Wrong values of a column that are named."""

SEPARATORS = (";", "\t", "|")
"""What other programs put between columns, spreadsheets where decimals have a comma among them."""

_INFINITE = ("young_i", "young_j", "modulus_ratio")


def read_table(
    folder: Path, name: str, known: Collection[str], most: int
) -> tuple[dict[str, FloatArray], list[Violation]]:
    """Values of a table by parameter, or everything that is wrong with it.

    Parameters
    ----------
    folder
        Where the table is.
    name
        Its file name, as in `TABLE_NAME`.
    known
        Names that a column may have.
    most
        Most rows.

    Returns
    -------
    tuple
        Parameter -> SI values, shape (rows,), and the violations; their fields begin with the
        file's name.

    Notes
    -----
    The first line of a CSV file names the columns; a value is a number [SI] or carries its unit,
    as in a scene. netCDF variables of one dimension are taken in SI units.
    """
    path = folder / name
    if not path.is_file():
        return {}, [Violation(name, "absent", "an existing file beside the scene")]
    try:
        columns, violations = (_csv if name.endswith(".csv") else _netcdf)(path)
    except (OSError, ValueError, csv.Error) as error:
        return {}, [Violation(name, str(error)[:100], "a readable table")]
    unknown = [column for column in columns if column not in known]
    violations += [
        Violation(f"{name}.{column}", column, f"one of {', '.join(known)}") for column in unknown
    ]
    if violations:
        return {}, violations
    rows = max((len(column) for column in columns.values()), default=0)
    if not 1 <= rows <= most:
        violations.append(Violation(name, f"{rows} rows", f"1 to {most} rows of some parameters"))
    else:
        found = {column: _numbers(column, texts) for column, texts in columns.items()}
        violations = [
            Violation(f"{name}.{column}.{row}", value, allowed)
            for column, (_, wrong) in found.items()
            for row, value, allowed in wrong
        ]
        return {column: values for column, (values, _) in found.items()}, violations
    return {}, violations


def _csv(path: Path) -> tuple[dict[str, Any], list[Violation]]:
    with path.open(encoding="utf-8-sig", newline="") as file:
        rows = [row for row in csv.reader(file, skipinitialspace=True) if row]
    names = [name.strip() for name in rows[0]] if rows else []
    if any(mark in name for name in names for mark in SEPARATORS):
        words = "names of columns with commas between them, decimals with a point"
        return {}, [Violation(f"{path.name}: first line", ",".join(names)[:100], words)]
    twice = sorted({name for name in names if names.count(name) > 1})
    violations = [Violation(f"{path.name}.{name}", "twice", "each column once") for name in twice]
    ragged = [(i, len(row)) for i, row in enumerate(rows[1:]) if len(row) != len(names)]
    violations += [
        Violation(f"{path.name}.{i}", f"{found} values", f"{len(names)}, one for each column")
        for i, found in ragged[:MOST_SHOWN]
    ]
    if violations:
        return {}, violations
    columns = zip(*rows[1:], strict=True) if len(rows) > 1 else ([] for _ in names)
    return dict(zip(names, map(list, columns), strict=True)), []


def _netcdf(path: Path) -> tuple[dict[str, Any], list[Violation]]:
    from bondcell.storage import read_dataset

    data = read_dataset(path)
    violations = []
    for name, variable in data.variables.items():
        unit, allowed = variable.attrs.get("units"), UNITS.get(str(name), "1")
        if unit is not None and unit != allowed:
            violations.append(Violation(f"{path.name}.{name}.units", unit, f"{allowed!r}"))
        if variable.ndim != 1:
            words = "one dimension, shared by all variables"
            violations.append(
                Violation(f"{path.name}.{name}", f"{variable.ndim} dimensions", words)
            )
    if len(data.sizes) > 1:
        violations.append(Violation(path.name, ", ".join(map(str, data.sizes)), "one dimension"))
    skipped = {name for name in data.sizes if name in data.variables}  # the rows' own numbers
    return {
        str(name): variable.values
        for name, variable in data.variables.items()
        if name not in skipped
    }, violations


def _numbers(column: str, given: Any) -> tuple[FloatArray, list[tuple[int, Any, str]]]:
    """A column as SI numbers, and the first rows that are none."""
    values = np.asarray(given)
    if values.dtype.kind in "iuf":
        numbers = values.astype(np.float64)
        infinite = np.isinf(numbers) & (numbers > 0) & (column in _INFINITE)
        bad = np.flatnonzero(~np.isfinite(numbers) & ~infinite)[:MOST_SHOWN]
        return numbers, [(int(row), float(numbers[row]), "a finite number") for row in bad]
    plain = _plain(values)
    if plain is not None:
        return plain, []
    unit, infinite_too = UNITS.get(column, "1"), column in _INFINITE
    numbers, wrong = np.full(values.shape, np.nan), []
    for row, text in enumerate(values.tolist()):
        try:
            numbers[row] = parse_quantity(text, unit, allow_infinite=infinite_too)
        except NotAllowed as error:
            wrong.append((row, text, error.allowed))
            if len(wrong) == MOST_SHOWN:
                break
    return numbers, wrong


def _plain(texts: Any) -> FloatArray | None:
    """Texts as numbers where all of them are finite decimal ones: many at once, to the last bit."""
    try:
        numbers = texts.astype(np.float64)
    except ValueError:
        return None
    grouped = any("_" in text for text in texts.tolist())  # digits grouped as in Python
    return numbers if np.isfinite(numbers).all() and not grouped else None
