"""Relaxation of every model over time, the series, convention and cell set by controls."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import altair as alt
import numpy as np
import xarray as xr

from bondcell.report.interactive.explorer import (
    Quantity,
    Way,
    chosen,
    explorer_chart,
    explorer_controls,
    switches,
)
from bondcell.report.interactive.figure import Axis, InteractiveFigure, numbers, texts
from bondcell.report.interactive.look import PERCENT, unit_label
from bondcell.report.interactive.sweep_explorer import LEAST_ERROR, SIZE_TITLE
from bondcell.results.relaxation_tables import error_over_time, relaxation_axes
from bondcell.results.relaxation_view import convention_words, series_words, shown_series
from bondcell.results.view import axis_unit, axis_values, is_reference
from bondcell.status import Status
from bondcell.wording import meaning, model_name, percent, quantity, symbol, unit_text

MOST_GENERATED = 3
"""Generated series that can be chosen."""

MOST_TIMES = 25


def relaxation_explorer(
    study: xr.Dataset, name: str, replaces: Sequence[str] = ()
) -> InteractiveFigure | None:
    """The figure, or None where nothing relaxes.

    Parameters
    ----------
    study
        Result with ``relaxation(model, convention, series, axes..., time)``.
    name
        Unique on the page.
    replaces
        Names of static figures that show the same.
    """
    if "relaxation" not in study:
        return None
    here = _chosen(study)
    names = [str(m) for m in here["model"].values]
    names = [n for n in names if here["relaxation"].sel(model=n).notnull().any()]
    if not names:
        return None
    here = here.sel(model=names)
    points = relaxation_axes(here)
    axes = [_axis(here, axis) for axis in points]
    series = Axis("series", [series_words(str(s)) for s in here["series"].values])
    convention = Axis("convention", [convention_words(str(c)) for c in here["convention"].values])
    moments = here["time"].values.astype(float)
    time = Axis("time", [quantity(t, "s", 2) for t in moments], moments.tolist())
    labels = [model_name(n) for n in names]
    menus = [chosen("menu", series, "Series of the matrix"), chosen("menu", convention, "Constant")]
    sliders = [(a, f"{meaning(a.name)} {symbol(a.name)}", len(a.texts) // 2) for a in axes]
    unit = unit_text(str(study["stiffness"].attrs.get("units", "N m-1")))
    reference = next((n for n in names if is_reference(n)), None)
    tooltip = [alt.Tooltip("name_text:N", title="model"), alt.Tooltip("time_text:N", title="t")]
    tooltip.append(alt.Tooltip("K_text:N", title="K(t)"))
    if reference:
        tooltip.append(alt.Tooltip("e:Q", title="error", format="+.2~%"))
    tooltip.append(alt.Tooltip("flag_text:N", title="flag"))
    derived = {
        "size": "isValid(datum.e) ? abs(datum.e) : null",
        "K_text": f"isValid(datum.K) ? format(datum.K, '.4~s') + '{unit}' : 'none'",
        "flag_text": "isValid(datum.flag) ? datum.flag : 'ok'",
    }
    ways = [Way("time", "time t [s]", (float(moments.min()), float(moments.max())), True, True)]
    values, error = _values(here, names, points, reference)
    return InteractiveFigure(
        name=name,
        caption="Stiffness K(t) of the bond after a step of displacement and the error of each "
        "model against finite elements, by series of the matrix and what stays constant as it "
        "relaxes. Hollow markers carry a flag. Some series and times are drawn; the file has all.",
        description=_description(names, error),
        chart=explorer_chart(names, [series, convention, *axes], ways, tooltip, derived),
        axes=[Axis("name", labels, names), convention, series, *axes, time],
        columns={
            "K": numbers(values, 4),
            "e": numbers(error, 3),
            "flag": texts(_flags(here, points)),
        },
        controls=explorer_controls(
            sliders, ways, _quantities(values, unit, compared=bool(reference)), menus
        ),
        switches=switches(names, labels),
        replaces=tuple(replaces),
    )


def _chosen(study: xr.Dataset) -> xr.Dataset:
    """Some series and times: those of materials, some generated ones; t > 0."""
    own = shown_series(study)
    kinds = study["series_kind"].values
    made = [
        str(s) for s, kind in zip(study["series"].values, kinds, strict=True) if kind == "generated"
    ]
    count = min(len(made), MOST_GENERATED)
    more = [made[i] for i in np.unique(np.linspace(0, len(made) - 1, count).round().astype(int))]
    positive = np.flatnonzero(study["time"].values > 0)
    count = min(len(positive), MOST_TIMES)
    times = positive[np.unique(np.linspace(0, len(positive) - 1, count).round().astype(int))]
    return study.sel(series=list(dict.fromkeys([*own, *more]))).isel(time=times)


def _axis(study: xr.Dataset, axis: str) -> Axis:
    values = axis_values(study, axis)
    return Axis(axis, [quantity(value, axis_unit(study, axis)) for value in values])


def _values(
    here: xr.Dataset, names: Sequence[str], points: Sequence[str], reference: str | None
) -> tuple[Any, Any]:
    """K(t) and its error on ``(model, convention, series, axes..., time)``."""
    order = ("model", "convention", "series", *points, "time")
    values = here["relaxation"].transpose(*order).values
    error = np.full_like(values, np.nan)
    if reference is not None:
        for position, name in enumerate(names):
            if name != reference:
                found = error_over_time(here, name, reference)
                error[position] = found.transpose(*order[1:]).values
    return values, error


def _flags(here: xr.Dataset, points: Sequence[str]) -> list[str]:
    order = ("model", "convention", "series", *points, "time")
    if "relaxation_status" not in here:
        return [""] * here["relaxation"].size
    status = here["relaxation_status"].broadcast_like(here["relaxation"]).transpose(*order).values
    codes = np.where(np.isfinite(status.astype(float)), status, Status.not_computed).astype(int)
    words = {s.value: "" if s == Status.ok else s.name.replace("_", " ") for s in Status}
    return [words[code] for code in codes.ravel().tolist()]


def _quantities(values: Any, unit: str, *, compared: bool) -> list[Quantity]:
    known = values[np.isfinite(values) & (values > 0)]
    low, high = (known.min() / 1.3, 1.3 * known.max()) if known.size else (1.0, 10.0)
    low = max(low, high / 1e8)
    stiffness = Quantity(
        "K", "stiffness K(t)", f"stiffness K(t) [{unit}]", (low, high), unit_label("")
    )
    if not compared:
        return [stiffness]
    size = Quantity("size", "size of the error", SIZE_TITLE, (LEAST_ERROR, 10.0), PERCENT, 0.01)
    return [size, stiffness]


def _description(names: Sequence[str], error: Any) -> str:
    said = []
    for position, name in enumerate(names):
        known = error[position][np.isfinite(error[position])]
        if known.size:
            low, high = percent(known.min(), sign=True), percent(known.max(), sign=True)
            said.append(f"{model_name(name)}: error {low} to {high}")
    return f"{'; '.join(said)}." if said else ""
