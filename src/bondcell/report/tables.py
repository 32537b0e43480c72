"""Tables of the page: cells as text, ready to print."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pandas as pd
import xarray as xr

from bondcell.figures.layout import line_layout
from bondcell.results.particle_influence import RATIO_AXIS, particles_negligible_from
from bondcell.results.view import (
    axis_unit,
    axis_values,
    is_scattered,
    load_name,
    model_names,
    parameters,
    stiffness_unit,
    swept_axes,
)
from bondcell.wording import (
    STIFFNESS_SYMBOLS,
    at,
    meaning,
    model_name,
    number,
    percent,
    quantity,
    symbol,
)

MOST_LINES = 7
"""Lines of the table of values."""


@dataclass(frozen=True)
class Table:
    """A table with its caption; `first` columns are names, the others numbers."""

    caption: str
    header: list[str]
    lines: list[list[str]]
    names: int = 1


def accuracy_lines(study: xr.Dataset, table: pd.DataFrame) -> Table | None:
    """The accuracy table as people read it, or None when it is empty.

    Parameters
    ----------
    study
        A sweep's result.
    table
        Its accuracy table.
    """
    if table.empty:
        return None
    axes = parameters(study)
    several = table["reference"].nunique() > 1
    lines = []
    for _, row in table.iterrows():
        group = "all points"
        if row["group_axis"] != "all":
            axis = row["group_axis"]
            group = at(axis, row["group_value"], axis_unit(study, axis))
        where = ", ".join(at(axis, row[f"at_{axis}"], axis_unit(study, axis)) for axis in axes)
        compared = f"{row['points']} of {row['points'] + row['left_out']}"
        name = model_name(row["model"])
        if several:
            name += f" against {model_name(row['reference'])}"
        if row["points"]:
            span = [percent(row[column], sign=True) for column in ("error_min", "error_max")]
            numbers = [percent(row["abs_error_max"]), percent(row["abs_error_median"]), *span]
        else:
            numbers, where = ["–"] * 4, "–"
        lines.append([name, group, *numbers, where, compared])
    header = [
        "model",
        "points",
        "largest |error|",
        "median |error|",
        "lowest error",
        "highest error",
        "largest at",
        "compared",
    ]
    if not axes:
        header, lines = _without(header, lines, ("points", "largest at", "lowest error"))
    return Table(
        "Error of each model against finite elements, K_n / K_FE − 1: below zero is too soft.",
        header,
        lines,
        names=2 if axes else 1,
    )


def influence_lines(study: xr.Dataset) -> Table | None:
    """Ratios from which the particles do not matter, or None when the sweep does not show them.

    Parameters
    ----------
    study
        A sweep's result.
    """
    found = particles_negligible_from(study)
    axes = [axis for axis in swept_axes(study) if axis != RATIO_AXIS]
    if found["ratio_from"].isna().all() or not 1 <= len(axes) <= 2:
        return None
    down, *across = sorted(axes, key=lambda axis: -study.sizes[axis])
    pivot = found.pivot_table(
        index=down, columns=["method", *across], values="ratio_from", dropna=False, sort=False
    )
    header = [symbol(down)]
    for column in pivot.columns:
        method, *values = column if isinstance(column, tuple) else (column,)
        words = [
            at(axis, v, axis_unit(study, axis)) for axis, v in zip(across, values, strict=True)
        ]
        header.append(", ".join([model_name(method), *words]))
    lines = [
        [quantity(value, axis_unit(study, down)), *(number(ratio, 2) for ratio in row)]
        for value, row in zip(pivot.index, pivot.to_numpy(), strict=True)
    ]
    return Table(
        f"Modulus ratio {symbol(RATIO_AXIS)} from which K_n is within 1 % of what the interface "
        "alone gives: k_int for FSI, rigid particles for finite elements.",
        header,
        lines,
    )


def value_lines(study: xr.Dataset) -> Table | None:
    """Stiffness by each model at some points along the main axis, or None for more than two axes.

    Parameters
    ----------
    study
        A sweep's result.
    """
    axes = swept_axes(study)
    if not model_names(study) or len(axes) > 2 or is_scattered(study):
        return None
    unit = stiffness_unit(study)
    names = model_names(study)
    header = [model_name(name) for name in names]
    kind = STIFFNESS_SYMBOLS.get(load_name(study), "K")
    if not axes:
        values = np.atleast_1d(study["stiffness"].squeeze().values)
        lines = [[name, quantity(value, unit)] for name, value in zip(header, values, strict=True)]
        return Table(f"Stiffness {kind} by each model.", ["model", kind], lines)
    layout = line_layout(study)
    along = axis_values(study, layout.x)
    chosen = np.unique(np.linspace(0, len(along) - 1, min(len(along), MOST_LINES)).round())
    lines = []
    for panel in layout.panels:
        here = study["stiffness"].isel(panel.index)
        for position in chosen.astype(int):
            line = [quantity(along[position], axis_unit(study, layout.x))]
            if layout.panel_axis:
                value = axis_values(study, layout.panel_axis)[panel.index[layout.panel_axis]]
                line.insert(0, quantity(value, axis_unit(study, layout.panel_axis)))
            point = here.isel({layout.x: position})
            line += [quantity(point.sel(model=name).item(), unit) for name in names]
            lines.append(line)
    axis_names = [axis for axis in (layout.panel_axis, layout.x) if axis]
    return Table(
        f"Stiffness {kind} at some values of the {meaning(layout.x)}.{layout.note()}",
        [*(symbol(axis) for axis in axis_names), *header],
        lines,
        names=len(axis_names),
    )


def _without(
    header: list[str], lines: list[list[str]], columns: tuple[str, ...]
) -> tuple[list[str], list[list[str]]]:
    kept = [i for i, name in enumerate(header) if name not in columns]
    return [header[i] for i in kept], [[line[i] for i in kept] for line in lines]
