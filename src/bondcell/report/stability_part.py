"""What the page says on the stability of the reference: sentences and tables."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pandas as pd
import xarray as xr

from bondcell.outputs import STIFFNESS_UNITS
from bondcell.report.findings import Finding
from bondcell.report.tables import Table
from bondcell.results.stability import FLAGS, stability_summary
from bondcell.results.view import axis_unit
from bondcell.status import Status
from bondcell.wording import at, listed, model_name, number, percent, quantity, symbol

MOST_POINTS = 20
"""Points of the table of the worst ones."""

NOT_AXES = {
    "load",
    "reference",
    "stiffness",
    "error_estimate",
    "status",
    "order",
    "dof",
    "seconds",
    "way",
    "condition",
}


def stability_findings(table: pd.DataFrame, study: xr.Dataset) -> list[Finding]:
    """How many points are sure, what became of the others, what the worst is.

    Parameters
    ----------
    table
        See `bondcell.results.stability.stability_table`.
    study
        A result of the scene, for the units of its axes.
    """
    return [*_overall(table), *_lost(table), *_missed(table, study), *_cost(table, study)]


def _overall(table: pd.DataFrame) -> Iterator[Finding]:
    good = table[table["status"] == Status.ok.name]
    silent = int((table["stiffness"].isna() & (table["status"].map(_has_value))).sum())
    text = f"{len(good)} of {len(table)} points are within the tolerance"
    if not good.empty:
        text += f" (largest estimate {number(good['error_estimate'].max(), 2)})"
    others = table[table["status"] != Status.ok.name]["status"].value_counts()
    if not others.empty:
        words = [f"{count} {str(flag).replace('_', ' ')}" for flag, count in others.items()]
        text += f"; the others say by their flag what is wrong: {listed(words)}"
    text += "." if not silent else f". {silent} have neither a value nor a flag that says so."
    loads = listed(dict.fromkeys(table["load"]))
    yield Finding(
        text, percent(len(good) / len(table)), f"extremes within the tolerance, {loads}", "extremes"
    )


def _has_value(flag: str) -> bool:
    return Status[flag].has_value


def _lost(table: pd.DataFrame) -> Iterator[Finding]:
    lost = table[table["stiffness"].isna()]
    if not lost.empty:
        flags = [f"{count} {str(flag).replace('_', ' ')}" for flag, count in _counts(lost)]
        yield Finding(f"Without a value are {len(lost)} points: {listed(flags)}.")


def _counts(table: pd.DataFrame) -> Iterator[tuple[str, int]]:
    for flag, count in table["status"].value_counts().items():
        yield str(flag), int(count)


def _missed(table: pd.DataFrame, study: xr.Dataset) -> Iterator[Finding]:
    """Where the points beyond the tolerance are: values of an axis that all of them share."""
    missed = table[table["status"] != Status.ok.name]
    if missed.empty or len(missed) == len(table):
        return
    for axis in _axes(table):
        values = set(missed[axis])
        if len(values) < table[axis].nunique():
            where = listed((_at(axis, value, study) for value in sorted(values)), "or")
            yield Finding(f"Every point beyond the tolerance has {where}.")
    known = missed[missed["error_estimate"].notna()]
    if not known.empty:
        row = known.iloc[0]
        place = ", ".join(_at(axis, row[axis], study) for axis in _axes(table))
        yield Finding(
            f"The largest estimate is {percent(row['error_estimate'])} ({row['load']}, {place})."
        )


def _cost(table: pd.DataFrame, study: xr.Dataset) -> Iterator[Finding]:
    if table["seconds"].notna().any():
        row = table.loc[table["seconds"].idxmax()]
        place = ", ".join(_at(axis, row[axis], study) for axis in _axes(table))
        yield Finding(
            f"A point takes {quantity(table['seconds'].median(), 's', 2)} in the median; the "
            f"slowest {quantity(row['seconds'], 's', 2)} with {row['dof']} unknowns "
            f"({row['load']}, {place})."
        )


def stability_lines(table: pd.DataFrame, study: xr.Dataset) -> list[Table]:
    """Points by flag with the flags' meaning, and the worst points.

    Parameters
    ----------
    table, study
        As in `stability_findings`.
    """
    return [_summary(table), _worst(table, study)]


def _summary(table: pd.DataFrame) -> Table:
    lines = [
        [
            str(row.load),
            model_name(str(row.reference)),
            str(row.status).replace("_", " "),
            FLAGS[Status[str(row.status)]],
            str(row.points),
            number(row.largest_estimate, 2),
            quantity(row.median_seconds, "s", 2),
            quantity(row.largest_seconds, "s", 2),
        ]
        for row in stability_summary(table).itertuples()
    ]
    header = ["load", "reference", "flag", "which means", "points", "largest estimate"]
    header += ["median time", "longest"]
    return Table("Points of the reference by flag.", header, lines, names=4)


def _worst(table: pd.DataFrame, study: xr.Dataset) -> Table:
    axes = _axes(table)
    lines = []
    for _, row in table.head(MOST_POINTS).iterrows():
        known = np.isfinite(row["stiffness"])
        lines.append(
            [
                str(row["load"]),
                *(quantity(row[axis], axis_unit(study, axis)) for axis in axes),
                quantity(row["stiffness"], STIFFNESS_UNITS[row["load"]]) if known else "–",
                number(row["error_estimate"], 2),
                row["status"].replace("_", " "),
                f"{row['order']} / {row['dof']}",
                number(row["condition"], 2),
                quantity(row["seconds"], "s", 2),
                row["way"].replace("_", " "),
            ]
        )
    header = [
        "load",
        *(symbol(axis) for axis in axes),
        "stiffness",
        "estimate",
        "flag",
        "order / unknowns",
        "condition",
        "time",
        "way",
    ]
    caption = (
        f"The worst {len(lines)} of {len(table)} points; all are in stability.csv. Condition: "
        "largest over smallest finite modulus of the cell, a proxy for that of its equations."
    )
    return Table(caption, header, lines)


def _axes(table: pd.DataFrame) -> list[str]:
    return [name for name in table.columns if name not in NOT_AXES and table[name].nunique() > 1]


def _at(axis: str, value: float, study: xr.Dataset) -> str:
    if axis == "modulus_ratio" and np.isinf(value):
        return "rigid particles"
    return at(axis, value, axis_unit(study, axis))
