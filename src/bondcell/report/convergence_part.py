"""What a convergence study shows: sentences and tables."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr

from bondcell.report.findings import Finding
from bondcell.report.tables import Table
from bondcell.results.convergence import (
    BASIS,
    GRADED,
    STAGES,
    STRUCTURED,
    TRIANGLES,
    convergence_table,
)
from bondcell.wording import (
    case_name,
    ladder_name,
    model_name,
    model_phrase,
    number,
    percent,
    quantity,
    unit_text,
)

ROUND_OFF = 1e-9
"""Differences between two solutions below it are round-off, whatever a bound says."""

TARGET = 1e-6
"""Error whose cost is told."""


def convergence_findings(convergence: xr.Dataset) -> list[Finding]:
    """What the ladders show, case by case.

    Parameters
    ----------
    convergence
        A convergence study on ``(case, method, level)``.
    """
    table = convergence_table(convergence)
    found: list[Finding] = []
    for case, rows in table.groupby("case", sort=False):
        found += _race(str(case), rows)
        found += _graded(str(case), rows)
        found += _basis(str(case), rows)
        found += _models(str(case), rows)
        found += _failures(str(case), rows)
    return found


def _race(case: str, rows: pd.DataFrame) -> Iterator[Finding]:
    """The cost of an error that both discretisations reach, and how the ladders fall."""
    structured = _ladder(rows, STRUCTURED)
    triangles = _ladder(rows, TRIANGLES)
    where = f"Case {_case(rows)}"
    if structured.empty:
        return
    cheap = structured[structured["error"] <= TARGET]
    told = structured.loc[structured["error"].idxmin()] if cheap.empty else cheap.iloc[0]
    reached = number(max(told["error"], TARGET), 2)
    text = f"{where}: the structured mesh reaches {reached} with {_cost(told)}"
    brief = (
        f"Finite elements themselves reach a relative error of {reached} with {_cost(told)}, case "
        f"{_case(rows)}."
    )
    key = f"{reached} in {quantity(told['seconds'], 's', 2)}"
    label = f"error and time of finite elements, {case_name(case)}"
    if triangles.empty:
        yield Finding(f"{text}.", key, label, "cost", brief)
        return
    last = triangles.loc[triangles["error"].idxmin()]
    text += (
        f". The triangles, an independent discretisation, come within "
        f"{number(last['error'], 2)} of its finest level with {_cost(last)}"
    )
    order = triangles["order"].dropna()
    if not order.empty:
        text += f", at an observed order of {number(order.median(), 2)} in h"
    same = structured[structured["error"] <= last["error"]]
    if not same.empty:
        factor = last["seconds"] / same.iloc[0]["seconds"]
        text += f". Just as accurate, the structured mesh takes {_cost(same.iloc[0])}"
        if factor > 1:
            text += f", {number(factor, 2)} times less"
    yield Finding(f"{text}.", key, label, "cost", brief)


def _case(rows: pd.DataFrame) -> str:
    """Name of a case with its boundary condition, or its load where conditions mean nothing."""
    row = rows.iloc[0]
    if row["load"] in row["case"]:
        return case_name(row["case"])
    return f"{case_name(row['case'])} ({row['bc'] if row['load'] == 'normal' else row['load']})"


def _graded(case: str, rows: pd.DataFrame) -> Iterator[Finding]:
    """What finer meshes of a fixed order give against higher orders."""
    graded, structured = _ladder(rows, GRADED), _ladder(rows, STRUCTURED)
    if graded.empty or structured.empty:
        return
    last = graded.loc[graded["error"].idxmin()]
    text = (
        f"Case {case_name(case)}: finer meshes at order 4 reach {number(last['error'], 2)} with "
        f"{_cost(last)}"
    )
    same = structured[structured["error"] <= last["error"]]
    if not same.empty:
        text += f"; higher orders get there with {_cost(same.iloc[0])}"
    yield Finding(f"{text}.")


def _basis(case: str, rows: pd.DataFrame) -> Iterator[Finding]:
    """How small a basis serves how well."""
    grown = rows[(rows["method"] == BASIS) & rows["sample_error"].notna()]
    if grown.empty:
        return
    good = grown[grown["bound"] <= TARGET]
    told = grown.iloc[-1] if good.empty else good.iloc[0]
    size = int(told["refinement"])
    bounded = (grown["sample_error"] <= grown["bound"] + ROUND_OFF).all()
    honest = "not below" if bounded else "not always above"
    yield Finding(
        f"Case {case_name(case)}: a reduced basis of {size} vectors serves random materials "
        f"(modulus ratios up to 1e8) to {number(told['sample_error'], 2)}, by its own bound "
        f"{number(told['bound'], 2)}, in {quantity(told['seconds'], 's', 2)} a point; at "
        f"each size the largest bound is {honest} the largest true error.",
        f"{size} vectors",
        f"reduced basis good to {number(told['sample_error'], 1)}, {case_name(case)}",
        topic="reduced basis",
    )


def _models(case: str, rows: pd.DataFrame) -> Iterator[Finding]:
    """What the analytic models give for how little."""
    models = rows[rows["level"].isna() & rows["error"].notna()]
    if models.empty:
        return
    best = models.loc[models["error"].idxmin()]
    text = f"Case {case_name(case)}: the closest analytic model is {_model(best)}"
    fsi = models[models["method"] == "fsi"]
    if best["method"] != "fsi" and not fsi.empty:
        text += f"; {_model(fsi.iloc[0])}"
    yield Finding(f"{text}.")


def _failures(case: str, rows: pd.DataFrame) -> Iterator[Finding]:
    failed = rows[rows["stiffness"].isna()]
    if not failed.empty:
        names = ", ".join(f"{row.method}: {row.status}" for row in failed.itertuples())
        yield Finding(f"Without a value in the case {case_name(case)}: {names}.")


def _ladder(rows: pd.DataFrame, method: str) -> pd.DataFrame:
    return rows[(rows["method"] == method) & rows["error"].notna()]


def _cost(row: Any) -> str:
    return f"{row['dof']} unknowns in {quantity(row['seconds'], 's', 2)}"


def _model(row: Any) -> str:
    return (
        f"{model_phrase(row['method'])}, off by {percent(row['error'])} "
        f"in {quantity(row['seconds'], 's', 2)} a point"
    )


def in_order(table: pd.DataFrame) -> pd.DataFrame:
    """The rows of each case with the reference's own ladder first, models last.

    Parameters
    ----------
    table
        See `bondcell.results.convergence.convergence_table`.
    """
    ladders = (STRUCTURED, GRADED, TRIANGLES, BASIS)
    rank = [
        ladders.index(method) if method in ladders else len(ladders) for method in table["method"]
    ]
    known = list(dict.fromkeys(table["case"]))
    keys = list(zip(map(known.index, table["case"]), rank, strict=True))
    return table.iloc[sorted(range(len(keys)), key=keys.__getitem__)]


def convergence_lines(convergence: xr.Dataset) -> list[Table]:
    """A table of all levels for each case.

    Parameters
    ----------
    convergence
        A convergence study on ``(case, method, level)``.
    """
    table = in_order(convergence_table(convergence))
    tables = []
    for case, rows in table.groupby("case", sort=False):
        doubt = float(convergence["reference_error"].sel(case=case))
        caption = (
            f"Case {_case(rows)}. Errors are relative to the finest structured level, which is "
            f"itself sure to about {number(doubt, 2)}. Order: of the element size h (dof^-1/2) "
            "for triangles and graded meshes; gain per order p, or per vector of the basis "
            "(natural logarithm), else. Times are medians of repeats."
        )
        tables.append(Table(caption, _HEADER, [_line(row) for _, row in rows.iterrows()]))
    grown = table[table["sample_error"].notna()]
    return [*tables, _basis_lines(grown)] if not grown.empty else tables


def _basis_lines(grown: pd.DataFrame) -> Table:
    lines = [
        [
            case_name(row["case"]),
            str(int(row["refinement"])),
            number(row["bound"], 2),
            number(row["sample_error"], 2),
            quantity(row["seconds"], "s", 2),
        ]
        for _, row in grown.iterrows()
    ]
    return Table(
        "Reduced basis: largest bound over 400 random materials and largest true error over 40 of "
        "them, against solutions without the basis.",
        ["case", "vectors", "bound", "true error", "time of a point"],
        lines,
    )


_HEADER = [
    "method",
    "p, h or vectors",
    "unknowns",
    "elements",
    "stiffness",
    "error",
    "order",
    "mesh",
    "assembly",
    "solution",
    "total time",
]


def _line(row: Any) -> list[str]:
    is_level = pd.notna(row["level"])
    method = str(row["method"])
    whole = [str(row[name]) if pd.notna(row[name]) else "–" for name in ("dof", "elements")]
    stiffness = (
        f"{row['stiffness']:.8g} {unit_text(row['unit'])}"
        if np.isfinite(row["stiffness"])
        else row["status"]
    )
    return [
        ladder_name(method) if is_level else model_name(method),
        number(row["refinement"], 3),
        *whole,
        stiffness,
        number(row["error"], 2),
        number(row["order"], 2),
        *(quantity(row[stage], "s", 2) if pd.notna(row[stage]) else "–" for stage in STAGES),
        quantity(row["seconds"], "s", 2) if pd.notna(row["seconds"]) else "–",
    ]
