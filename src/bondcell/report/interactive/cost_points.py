"""Points of error against cost: of an atlas, a sweep, ladders, methods in time, the specimen."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr

from bondcell.report.convergence_part import in_order
from bondcell.report.interactive.cost_chart import COLUMNS
from bondcell.results.atlas import accuracy_by_region, error_against_time
from bondcell.results.convergence import convergence_table
from bondcell.results.relaxation_view import series_words
from bondcell.specimen.view import NAMES
from bondcell.wording import METHODS, case_name, ladder_name, model_name, number


def atlas_points(loads: Mapping[str, xr.Dataset]) -> pd.DataFrame:
    """Of each model under each load the median error, and the largest inside its stated range."""
    table = error_against_time(accuracy_by_region(loads))
    return _frame(
        {
            "group": row.load,
            "name": row.model,
            "label": model_name(row.model),
            "error": row.abs_error_median,
            "highest": row.abs_error_max_inside,
            "seconds": row.seconds,
            "note": f"median of {row.points} cells",
        }
        for row in table.itertuples()
    )


def ladder_points(convergence: xr.Dataset, *, models: bool = True) -> pd.DataFrame:
    """Every level of every discretisation by case, and the models of the case."""
    table = in_order(convergence_table(convergence))
    known = table[table["error"].notna()]
    if not models:
        known = known[known["level"].notna()]
    return _frame(_level(row) for row in known.itertuples())


def _level(row: Any) -> dict[str, Any]:
    is_level = pd.notna(row.level)
    return {
        "group": case_name(row.case),
        "load": row.load,
        "name": row.method,
        "label": ladder_name(row.method) if is_level else model_name(row.method),
        "error": row.error,
        "seconds": row.seconds,
        "dof": float(row.dof) if is_level and pd.notna(row.dof) else np.nan,
        "order": row.order,
        "note": f"level {number(row.refinement, 3)}" if is_level else "",
    }


def cost_points(
    atlas: Mapping[str, xr.Dataset] | None, convergence: xr.Dataset | None
) -> pd.DataFrame:
    """Models over a whole atlas beside the ladders of finite elements, by load.

    Parameters
    ----------
    atlas
        Load -> result of an atlas.
    convergence
        A convergence study; of each load its first case counts.
    """
    parts = [] if atlas is None else [atlas_points(atlas)]
    if convergence is not None:
        ladders = ladder_points(convergence, models=atlas is None)
        first = ladders.drop_duplicates("load").set_index("load")["group"]
        ladders = ladders[ladders["group"] == ladders["load"].map(first)]
        note = ladders["note"] + ", case " + ladders["group"]
        parts.append(ladders.assign(group=ladders["load"], note=note))
    return pd.concat(parts, ignore_index=True) if parts else _frame([])


def method_points(table: pd.DataFrame) -> pd.DataFrame:
    """Every level of every way to K(t), by series.

    Parameters
    ----------
    table
        See `bondcell.results.relaxation_tables.methods_table`.
    """
    return _frame(
        {
            "group": series_words(str(row.case)),
            "name": row.method,
            "label": METHODS[str(row.method)],
            "error": row.error,
            "seconds": row.seconds,
            "dof": float(row.dof),
            "note": f"level {number(row.refinement, 3)}",
        }
        for row in table.itertuples()
    )


def specimen_points(table: pd.DataFrame) -> pd.DataFrame:
    """Error of the energy of each method, by loading and walls.

    Parameters
    ----------
    table
        See `bondcell.specimen.view.error_table`.
    """
    return _frame(
        {
            "group": f"{row.loading} loading, {row.walls} walls",
            "name": row.method,
            "label": NAMES[row.method],
            "error": abs(row.energy_error),
            "seconds": row.seconds,
            "dof": float(row.dof),
            "note": f"h/gap {number(row.per_gap, 2)}" if np.isfinite(row.per_gap) else "",
        }
        for row in table.itertuples()
    )


def _frame(rows: Iterable[Mapping[str, Any]]) -> pd.DataFrame:
    """The points, with every column that a figure may ask for."""
    found = pd.DataFrame(list(rows))
    for name in COLUMNS:
        if name not in found:
            found[name] = "" if name in ("group", "name", "label", "note") else np.nan
    return found.fillna({"note": ""})
