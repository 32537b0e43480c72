"""Prony series from tables as commercial finite element programs have them, CSV or YAML."""

from __future__ import annotations

import csv
from pathlib import Path
from typing import Any

from bondcell.errors import InputError, Violation
from bondcell.prony.prony import Prony, PronyError
from bondcell.scenes.yaml_loading import load_mapping

PAIRED = ("g", "k", "tau")
"""Columns of one table for both moduli (Abaqus-like)."""

SPLIT = ("table", "weight", "tau")
"""Columns of a table for each modulus, named ``shear`` or ``bulk`` (ANSYS-like)."""

OPTIONS = ("relative_to", "long_term", "modulus", "bulk_long_term")
"""Keys of a YAML file that are handed to `Prony`."""


def read_prony(path: str | Path, **options: Any) -> Prony:
    r"""Read a Prony series.

    Parameters
    ----------
    path
        ``.csv`` with the header ``g,k,tau`` (Abaqus-like: relative shear and bulk weight of each
        time, k may be left out) or ``table,weight,tau`` (ANSYS-like: ``table`` is ``shear`` or
        ``bulk``, relative moduli and times of each); lines with ``#`` are remarks. ``.yaml`` with
        the same columns as lists under ``g, k, tau``, or ``shear`` and ``bulk`` as lists of
        ``[weight, tau]``, and optionally the keys of `OPTIONS`. Times in seconds.
    **options
        Arguments of `Prony`, they win over those of the file.

    Returns
    -------
    Prony
        Without a bulk series where all its weights are zero.

    Raises
    ------
    PronyError
        Names file, line or key, value and what is allowed, all violations at once.

    Examples
    --------
    >>> import tempfile
    >>> path = Path(tempfile.mkdtemp()) / "asphalt.csv"
    >>> _ = path.write_text("g,k,tau\n0.3,0,1e-3\n0.2,0,1.0\n")
    >>> read_prony(path)
    Prony(2 terms, g_inf=0.5, relative to instantaneous)
    """
    try:
        source = Path(path)
    except TypeError:
        raise PronyError([Violation("file", path, "a path")]) from None
    if source.suffix.lower() == ".csv":
        shear, bulk = _from_csv(source)
        settings: dict[str, Any] = {}
    elif source.suffix.lower() in (".yaml", ".yml"):
        shear, bulk, settings = _from_yaml(source)
    else:
        raise PronyError([Violation("file", str(source), "a .csv, .yaml or .yml file")])
    if any(weight != 0 for weight, _ in bulk):
        settings["bulk_weights"], settings["bulk_times"] = zip(*bulk, strict=True)
    weights, times = zip(*shear, strict=True) if shear else ((), ())
    try:
        return Prony(weights, times, **(settings | options))
    except InputError as error:
        raise PronyError(error.violations, str(source)) from None


Rows = list[tuple[Any, Any]]


def _from_csv(source: Path) -> tuple[Rows, Rows]:
    try:
        text = source.read_text(encoding="utf-8-sig")
    except (OSError, UnicodeDecodeError) as error:
        raise PronyError([Violation("file", str(source), f"readable text ({error})")]) from None
    lines = [
        (number, [cell.strip() for cell in row])
        for number, row in enumerate(csv.reader(text.splitlines()), start=1)
        if row and any(cell.strip() for cell in row) and not row[0].lstrip().startswith("#")
    ]
    header = tuple(name.lower() for name in lines[0][1]) if lines else ()
    if header not in (PAIRED, ("g", "tau"), SPLIT):
        allowed = f"{','.join(PAIRED)} or g,tau or {','.join(SPLIT)}"
        raise PronyError([Violation("header", ",".join(header), allowed)], str(source))
    bad: list[Violation] = []
    shear, bulk = Rows(), Rows()
    for number, row in lines[1:]:
        where = f"line {number}"
        if len(row) != len(header):
            bad.append(Violation(where, ",".join(row), f"{len(header)} values"))
            continue
        entry = dict(zip(header, row, strict=True))
        table = entry.pop("table", "shear").lower()
        if table not in ("shear", "bulk"):
            bad.append(Violation(f"{where}, table", table, "shear or bulk"))
        values = {name: _number(f"{where}, {name}", text, bad) for name, text in entry.items()}
        first = values["weight"] if "weight" in values else values["g"]
        (bulk if table == "bulk" else shear).append((first, values["tau"]))
        if "k" in values:
            bulk.append((values["k"], values["tau"]))
    if not lines[1:]:
        bad.append(Violation("rows", "none", "at least one below the header"))
    if bad:
        raise PronyError(bad, str(source))
    return shear, bulk


def _number(where: str, text: str, bad: list[Violation]) -> float:
    """A number in its range; which range is the column's, the last word of ``where``."""
    column = where.split()[-1]
    allowed = "(0, inf) s, finite" if column == "tau" else "[0, inf), finite"
    try:
        value = float(text)
    except ValueError:
        bad.append(Violation(where, text, f"a number in {allowed}"))
        return 0.0
    low = value > 0 if column == "tau" else value >= 0
    if not low or value == float("inf"):
        bad.append(Violation(where, value, allowed))
    return value


def _from_yaml(source: Path) -> tuple[Rows, Rows, dict[str, Any]]:
    content = load_mapping(source, PronyError)
    settings = {name: content.pop(name) for name in OPTIONS if name in content}
    paired = "tau" in content or "g" in content
    known = PAIRED if paired else ("shear", "bulk")
    bad = [
        Violation(name, value, f"one of {', '.join((*PAIRED, 'shear', 'bulk', *OPTIONS))}")
        for name, value in content.items()
        if name not in known
    ]
    tables: dict[str, Any]
    if paired:
        columns: dict[str, Any] = {name: content[name] for name in PAIRED if name in content}
        lengths = {len(v) if isinstance(v, list) else -1 for v in columns.values()}
        if not {"g", "tau"} <= set(columns) or len(lengths) != 1 or -1 in lengths:
            bad.append(Violation("g, k, tau", columns, "lists of equal length, k may be left out"))
        rows = {"shear": ("g", "tau"), "bulk": ("k", "tau")}
        tables = {
            table: list(zip(columns[first], columns[last], strict=False))
            for table, (first, last) in rows.items()
            if not bad and first in columns
        }
    else:
        tables = {name: content.get(name, []) for name in known}
        for name, table in tables.items():
            rows_of = table if isinstance(table, list) else [table]
            if not all(isinstance(row, list) and len(row) == 2 for row in rows_of):
                bad.append(Violation(name, table, "a list of [weight, tau]"))
    if bad:
        raise PronyError(bad, str(source))
    return _pairs(tables.get("shear", [])), _pairs(tables.get("bulk", [])), settings


def _pairs(table: list[Any]) -> Rows:
    return [(row[0], row[1]) for row in table]
