"""Stiffness and error of every model of a sweep over any of its axes, under any of its loads."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import altair as alt
import numpy as np
import xarray as xr

from bondcell.figures.layout import FAVOURITES, is_logarithmic
from bondcell.report.interactive.explorer import (
    Quantity,
    Way,
    chosen,
    explorer_chart,
    explorer_controls,
    switches,
)
from bondcell.report.interactive.figure import Axis, InteractiveFigure, numbers, plotted, texts
from bondcell.report.interactive.look import PERCENT, POWERS, plain, unit_label
from bondcell.results.accuracy import signed_error
from bondcell.results.view import (
    SAMPLE,
    analytic_names,
    axis_unit,
    axis_values,
    is_scattered,
    model_names,
    parameters,
    reference_names,
    stiffness_unit,
    swept_axes,
)
from bondcell.status import Status
from bondcell.wording import (
    listed,
    meaning,
    model_name,
    percent,
    quantity,
    symbol,
    unit_text,
)

MOST_ROWS = 16_000
"""Longer data are thinned: the file has all."""

SIZE_TITLE = "size of the error against finite elements"
RATIO_TITLE = "K / K by finite elements"

LEAST_ERROR = 1e-6
"""Smaller errors are drawn at the lower edge."""


def sweep_explorer(
    loads: Mapping[str, xr.Dataset], name: str, replaces: Sequence[str] = ()
) -> InteractiveFigure | None:
    """The figure, or None where there is no axis to draw along or no value to draw.

    Parameters
    ----------
    loads
        Load -> result.
    name
        Unique on the page.
    replaces
        Names of static figures that show the same.
    """
    names = list(dict.fromkeys(n for study in loads.values() for n in model_names(study)))
    first = next(iter(loads.values()))
    if not names or not swept_axes(first) or not any(map(_has_values, loads.values())):
        return None
    kept = thinned(first, len(names) * len(loads))
    studies = {load: study.isel(kept) for load, study in loads.items()}
    thin = next(iter(studies.values()))
    dims = [_dimension(thin, axis) for axis in swept_axes(first)]
    axes = [axis for axis in dims if axis.name != SAMPLE]
    varied = [*axes, *(known for axis in dims for known in axis.companions)]
    compared = any(reference_names(s) and analytic_names(s) for s in studies.values())
    ways = [_way(first, axis) for axis in sorted(varied, key=lambda axis: _preference(axis.name))]
    load_axis = Axis("load", list(studies))
    menus = [chosen("menu", load_axis, "Load")] if len(studies) > 1 else []
    labels = [model_name(each) for each in names]
    chart = explorer_chart(
        names,
        [load_axis, *axes] if menus else axes,
        ways,
        _tooltip(varied, compared=compared),
        _derived(studies),
        with_lines=not is_scattered(first),
    )
    sliders = [(axis, f"{meaning(axis.name)} {symbol(axis.name)}", _start(axis)) for axis in axes]
    quantities = _quantities(studies, compared=compared)
    return InteractiveFigure(
        name=name,
        caption=_caption(first, dims, compared=compared),
        description=_description(studies),
        chart=chart,
        axes=[load_axis, Axis("name", labels, names), *dims],
        columns=_columns(studies, names, [axis.name for axis in dims]),
        controls=explorer_controls(sliders if len(varied) > 1 else [], ways, quantities, menus),
        switches=switches(names, labels),
        replaces=tuple(replaces),
    )


def _has_values(study: xr.Dataset) -> bool:
    return bool(np.isfinite(study["stiffness"].values).any())


def thinned(study: xr.Dataset, curves: int) -> dict[str, Any]:
    """Positions to keep along each axis so that the figure stays small, both ends among them.

    Parameters
    ----------
    study
        A sweep's result.
    curves
        Values at each point.

    Returns
    -------
    dict
        Dimension -> positions; a dimension of one value is dropped.
    """
    sizes = {str(dim): size for dim, size in study["stiffness"].sizes.items() if dim != "model"}
    kept = {dim: np.arange(size) for dim, size in sizes.items()}
    while curves * np.prod([len(places) for places in kept.values()]) > MOST_ROWS:
        longest = max(kept, key=lambda dim: len(kept[dim]))
        count = max(2, int(0.8 * len(kept[longest])))
        kept[longest] = np.unique(np.linspace(0, sizes[longest] - 1, count).round().astype(int))
        if all(len(places) <= 2 for places in kept.values()):
            break
    return {dim: places if sizes[dim] > 1 else 0 for dim, places in kept.items()}


def _preference(axis: str) -> int:
    return FAVOURITES.index(axis) if axis in FAVOURITES else len(FAVOURITES)


def _axis(study: xr.Dataset, axis: str) -> Axis:
    given = axis_values(study, axis)
    unit = axis_unit(study, axis)
    if given.dtype.kind not in "iuf":
        return Axis(axis, [str(value) for value in given], list(range(len(given))))
    words = ["rigid" if np.isinf(v) else quantity(v, unit) for v in given.astype(float)]
    return Axis(axis, words, plotted(given.astype(float).tolist()))


def _dimension(study: xr.Dataset, name: str) -> Axis:
    """A dimension of the results; samples of a design bring their parameters along."""
    if name != SAMPLE:
        return _axis(study, name)
    known = [parameter for parameter in parameters(study) if parameter not in study.dims]
    texts = [str(place) for place in range(study.sizes[SAMPLE])]
    return Axis(SAMPLE, texts, companions=tuple(_axis(study, name) for name in known))


def _way(study: xr.Dataset, axis: Axis) -> Way:
    values = np.asarray(axis.values, dtype=float)
    unit = unit_text(axis_unit(study, axis.name))
    words, sign = meaning(axis.name), symbol(axis.name)
    title = (words if words == sign else f"{words} {sign}") + (f" [{unit}]" if unit else "")
    end = (float(values.max()), "rigid") if "rigid" in axis.texts else None
    bounds = (float(values.min()), float(values.max()))
    positive = bool((values > 0).all())
    return Way(axis.name, plain(title), bounds, is_logarithmic(values), positive, end)


def _start(axis: Axis) -> int:
    """The middle of an axis, of Poisson's ratio the value nearest to the paper's."""
    if axis.name == "poisson_m" and axis.values:
        return int(np.abs(np.asarray(axis.values) - 0.46).argmin())
    return len(axis.texts) // 2


def _columns(
    studies: Mapping[str, xr.Dataset], names: Sequence[str], axes: Sequence[str]
) -> dict[str, Any]:
    found: dict[str, list[Any]] = {key: [] for key in ("K", "e", "t", "flag")}
    for study in studies.values():
        reference = next(iter(reference_names(study)), None)
        own = set(model_names(study))
        shape = tuple(study.sizes[axis] for axis in axes)
        for name in names:
            nothing = np.full(shape, np.nan)
            if name not in own:
                values, error, status = nothing, nothing, np.zeros(shape, int)
            else:
                here = study.sel(model=name)
                values = here["stiffness"].transpose(*axes).values
                status = here["status"].transpose(*axes).values if "status" in here else 0 * values
                error = nothing
                if reference is not None and name != reference:
                    error = signed_error(study, name, reference).transpose(*axes).values
            found["K"].append(values)
            found["e"].append(error)
            found["t"].append(_seconds(study, name))
            found["flag"] += [_flag(code) for code in np.ravel(status)]
    points = int(np.prod(shape))
    return {
        "K": numbers(np.array(found["K"]), 4),
        "e": numbers(np.array(found["e"]), 3),
        "t": texts([text for text in found["t"] for _ in range(points)]),
        "flag": texts(found["flag"]),
    }


def _seconds(study: xr.Dataset, name: str) -> str:
    if "seconds" not in study or name not in model_names(study):
        return ""
    seconds = study["seconds"].sel(model=name).values
    return quantity(np.nanmedian(seconds), "s", 2) if np.isfinite(seconds).any() else ""


def _flag(code: Any) -> str:
    status = Status(int(code)) if np.isfinite(code) else Status.not_computed
    return "" if status == Status.ok else status.name.replace("_", " ")


def _quantities(studies: Mapping[str, xr.Dataset], *, compared: bool) -> list[Quantity]:
    values = np.concatenate([s["stiffness"].values.ravel() for s in studies.values()])
    values = values[np.isfinite(values) & (values > 0)]
    low, high = (values.min() / 1.3, 1.3 * values.max()) if values.size else (1.0, 10.0)
    units = listed(dict.fromkeys(unit_text(stiffness_unit(s)) for s in studies.values()), "or")
    stiffness = Quantity("K", "stiffness K", f"stiffness K [{units}]", (low, high), unit_label(""))
    if not compared:
        return [stiffness]
    return [
        Quantity("size", "size of the error", SIZE_TITLE, (LEAST_ERROR, 10.0), PERCENT, 0.01),
        Quantity("ratio", "K over K by finite elements", RATIO_TITLE, (0.1, 10.0), POWERS, 1.0),
        stiffness,
    ]


def _tooltip(axes: Sequence[Axis], *, compared: bool) -> list[alt.Tooltip]:
    parts = [alt.Tooltip("name_text:N", title="model")]
    parts += [alt.Tooltip(f"{axis.name}_text:N", title=plain(symbol(axis.name))) for axis in axes]
    parts.append(alt.Tooltip("K_text:N", title="K"))
    if compared:
        parts.append(alt.Tooltip("e:Q", title="error", format="+.2~%"))
    parts.append(alt.Tooltip("t_text:N", title="time a point"))
    return [*parts, alt.Tooltip("flag_text:N", title="flag")]


def _derived(studies: Mapping[str, xr.Dataset]) -> dict[str, str]:
    """Fields that follow from a row."""
    units = [unit_text(stiffness_unit(study)) for study in studies.values()]
    return {
        "size": "isValid(datum.e) ? abs(datum.e) : null",
        "ratio": "isValid(datum.e) ? 1 + datum.e : null",
        "K_text": f"isValid(datum.K) ? format(datum.K, '.4~s') + {units}[datum.load_at] : 'none'",
        "t_text": "isValid(datum.t) ? datum.t : 'unknown'",
        "flag_text": "isValid(datum.flag) ? datum.flag : 'ok'",
    }


def _caption(study: xr.Dataset, axes: Sequence[Axis], *, compared: bool) -> str:
    words = "Each model over any axis of the sweep; the sliders set the others."
    if is_scattered(study):
        words = "Each model at every point of the design, over any of its parameters."
    if compared:
        words += " Errors are those against finite elements; the dashed line is 1 %, or equality."
    words += " Hollow markers carry a flag, such as outside the model's valid range."
    if any(len(axis.texts) < study.sizes[axis.name] for axis in axes):
        words += " Not every value of the sweep is drawn; the file has all."
    return words


def _description(studies: Mapping[str, xr.Dataset]) -> str:
    """Range of each model's error under each load, in words."""
    said = []
    for load, study in studies.items():
        for reference in reference_names(study)[:1]:
            for model in analytic_names(study):
                error = signed_error(study, model, reference).values
                if np.isfinite(error).any():
                    low, high = (percent(f(error), sign=True) for f in (np.nanmin, np.nanmax))
                    middle = percent(np.nanmedian(np.abs(error)))
                    name = model_name(model)
                    said.append(f"{load}, {name}: error {low} to {high}, median size {middle}")
    return f"{'; '.join(said)}." if said else ""
