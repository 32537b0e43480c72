"""Maps of an accuracy atlas: every model's error, and the cheapest formula that is good enough."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
import xarray as xr
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.collections import LineCollection
from matplotlib.colors import BoundaryNorm, Colormap, ListedColormap
from matplotlib.figure import Figure
from matplotlib.patches import Patch, Rectangle

from bondcell.figures.style import LIGHT, Drawing, marker_style, mathtext, new_figure
from bondcell.results.atlas import is_formula, valid_everywhere, worst_errors
from bondcell.results.view import analytic_names
from bondcell.wording import listed, meaning, model_name, number, percent, symbol

BOUNDS = (1e-4, 1e-3, 3e-3, 0.01, 0.03, 0.1, 0.3, 1.0)
"""Sizes of the error between which a colour lasts."""

POISSON_SHOWN = (0.0, 0.3, 0.46, 0.49, 0.5)
"""Poisson's ratios of the matrix that get a column, the nearest on the axis."""

WANTED = (0.1, 0.01)
"""Errors for which the cheapest formula is shown."""

GAP, RATIO, POISSON = "gap_ratio", "modulus_ratio", "poisson_m"

Grid = np.ndarray[Any, Any]


def atlas_maps(loads: Mapping[str, xr.Dataset]) -> Iterator[Drawing]:
    """Error maps of each load, and the cheapest formulas of all loads for each wanted error.

    Parameters
    ----------
    loads
        Load -> result of an atlas.
    """
    for load, study in loads.items():
        yield _error_maps(load, study)
    for wanted in WANTED:
        yield _best_maps(loads, wanted)


def _error_maps(load: str, study: xr.Dataset) -> Drawing:
    names, columns = analytic_names(study), shown_poisson(study)
    figure, rows = _rows([model_name(name) for name in names], columns, study, 1.12)
    colours, norm = _colours()
    for axes, name in zip(rows, names, strict=True):
        error, valid = np.abs(worst_errors(study, name)), valid_everywhere(study, name)
        for place, column in enumerate(columns):
            _draw(axes, place, error[:, :, column], colours, norm)
            axes.add_collection(_outline(valid[:, :, column].T, _left(study, place)))
    bar = figure.colorbar(
        ScalarMappable(norm, colours),
        ax=rows,
        location="top",
        extend="both",
        ticks=BOUNDS,
        aspect=45,
        shrink=0.9,
        pad=0.01,
    )
    bar.ax.set_xticklabels([percent(bound) for bound in BOUNDS], fontsize=7)
    bar.ax.minorticks_off()
    bar.set_label(f"size of the error against finite elements, {load} load", fontsize=8)
    caption = (
        f"Accuracy map, {load} load: size of each model's error over the {meaning(GAP)} "
        f"{symbol(GAP)} and the {meaning(RATIO)} {symbol(RATIO)}, a column for each Poisson's "
        "ratio of the matrix. The frame holds the points inside the model's stated range; "
        f"hatched: no value.{_others(study)}"
    )
    return Drawing(figure, f"atlas_errors_{load}", caption, _errors_in_words(study))


def _others(study: xr.Dataset) -> str:
    axes = [str(dim) for dim in study["stiffness"].dims]
    extra = [symbol(axis) for axis in axes if axis not in ("model", GAP, RATIO, POISSON)]
    return f" The largest over {listed(extra)}." if extra else ""


def shown_poisson(study: xr.Dataset) -> list[int]:
    """Positions of the Poisson's ratios that get a column."""
    values = study[POISSON].values
    return sorted({int(np.abs(values - wanted).argmin()) for wanted in POISSON_SHOWN})


def _rows(
    titles: list[str], columns: list[int], study: xr.Dataset, height: float
) -> tuple[Figure, list[Axes]]:
    """A strip of maps for each title; the maps of a strip share one pair of axes."""
    figure = new_figure(0.9 + 1.55 * len(columns), 1.3 + height * len(titles))
    rows = list(figure.subplots(len(titles), 1, sharex=True, squeeze=False)[:, 0])
    for place, column in enumerate(columns):
        value = number(study[POISSON].values[column])
        title = f"{mathtext(symbol(POISSON))} = {value}"
        middle = _left(study, place) + study.sizes[GAP] / 2
        rows[0].annotate(
            title,
            (middle, study.sizes[RATIO]),
            (0, 4),
            textcoords="offset points",
            ha="center",
            fontsize=8,
        )
    for axes, title in zip(rows, titles, strict=True):
        axes.set_ylabel(title, fontsize=8)
        _scales(axes, study, len(columns))
    figure.supxlabel(f"{meaning(GAP)} {mathtext(symbol(GAP))}", fontsize=9)
    figure.supylabel(f"{meaning(RATIO)} {mathtext(symbol(RATIO))}", fontsize=9)
    return figure, rows


def _left(study: xr.Dataset, place: int) -> float:
    """Where the map at a place of its strip begins."""
    return float(place * 1.1 * study.sizes[GAP])


def _draw(axes: Axes, place: int, values: Grid, colours: Colormap, norm: BoundaryNorm) -> None:
    """One map, values of shape (gaps, ratios); hatched where there is none."""
    gaps, ratios = values.shape
    left = place * 1.1 * gaps
    frame = Rectangle((left, 0), gaps, ratios, facecolor="#f2f2f2", edgecolor="#9a9a9a")
    frame.set(hatch="////", linewidth=0.4)
    axes.add_patch(frame)
    edges = left + np.arange(gaps + 1), np.arange(ratios + 1)
    axes.pcolormesh(*edges, values.T, cmap=colours, norm=norm, rasterized=True)


def _scales(axes: Axes, study: xr.Dataset, maps: int) -> None:
    """Points stand at equal distances; every second power of ten has a label, and rigid."""
    at, labels = _labelled(study[GAP].values)
    places = [_left(study, place) + k + 0.5 for place in range(maps) for k in at]
    axes.xaxis.set_ticks(places, labels * maps)
    at, labels = _labelled(study[RATIO].values)
    axes.yaxis.set_ticks([k + 0.5 for k in at], labels)
    axes.tick_params(labelsize=6.5, length=2)
    axes.grid(visible=False)
    for spine in axes.spines.values():
        spine.set_visible(False)
    axes.set_xlim(-0.3, _left(study, maps - 1) + study.sizes[GAP] + 0.3)
    axes.set_ylim(-0.2, study.sizes[RATIO] + 0.2)


def _labelled(values: Grid) -> tuple[list[int], list[str]]:
    powers = np.log10(values, where=np.isfinite(values), out=np.full(values.shape, 0.5))
    even = np.isclose(powers % 2, 0) | np.isclose(powers % 2, 2)
    rigid = np.isinf(values)
    crowded = np.roll(rigid, -1) | np.roll(rigid, -2)
    at = [int(k) for k in np.flatnonzero((even & ~crowded) | rigid)]
    return at, [_power(values[k]) for k in at]


def _power(value: float) -> str:
    return "rigid" if np.isinf(value) else f"$10^{{{round(np.log10(value))}}}$"


def _outline(mask: Grid, left: float) -> LineCollection:
    """Border between points that are inside a range and those that are not."""
    padded = np.pad(mask, 1)
    upright = np.argwhere(padded[1:-1, 1:] != padded[1:-1, :-1])
    level = np.argwhere(padded[1:, 1:-1] != padded[:-1, 1:-1])
    segments = [[(left + x, y), (left + x, y + 1)] for y, x in upright]
    segments += [[(left + x, y), (left + x + 1, y)] for y, x in level]
    return LineCollection(segments, colors="black", linewidths=1.1, clip_on=False, zorder=3)


def _colours() -> tuple[Colormap, BoundaryNorm]:
    classes = len(BOUNDS) + 1
    inner = ListedColormap(colormaps["magma_r"](np.linspace(0.0, 0.92, classes))[1:-1])
    ends = colormaps["magma_r"](np.array([0.0, 0.99]))
    colours = inner.with_extremes(under=ends[0], over=ends[1], bad=(0, 0, 0, 0))
    return colours, BoundaryNorm(list(BOUNDS), colours.N)


def _errors_in_words(study: xr.Dataset) -> str:
    sentences = []
    for name in analytic_names(study):
        error = np.abs(worst_errors(study, name))
        known = error[np.isfinite(error)]
        if not known.size:
            sentences.append(f"{model_name(name)}: no value")
            continue
        parts = [f"{percent(np.mean(known <= bound))} within {percent(bound)}" for bound in WANTED]
        inside = error[valid_everywhere(study, name) & np.isfinite(error)]
        end = f", at most {percent(inside.max())} inside its range" if inside.size else ""
        sentences.append(f"{model_name(name)}: of the points {listed(parts)}{end}")
    return ". ".join(sentences) + "."


def best_formula(study: xr.Dataset, wanted: float) -> tuple[list[str], Grid]:
    """Formulas from the cheapest on, and which is the first within an error at each point.

    Parameters
    ----------
    study
        Result of an atlas under one load.
    wanted
        Largest error.

    Returns
    -------
    tuple
        Names, and positions in them on the axes of the map; their number where none serves.
    """
    names = [name for name in analytic_names(study) if is_formula(name)]
    cost = {name: float(np.nanmedian(study["seconds"].sel(model=name))) for name in names}
    names.sort(key=lambda name: cost[name])
    serves = [
        (np.abs(worst_errors(study, name)) <= wanted) & valid_everywhere(study, name)
        for name in names
    ]
    return names, np.argmax([*serves, np.ones_like(serves[0])], axis=0)


def _best_maps(loads: Mapping[str, xr.Dataset], wanted: float) -> Drawing:
    first = next(iter(loads.values()))
    columns = shown_poisson(first)
    figure, rows = _rows(list(loads), columns, first, 1.25)
    found: dict[str, Any] = {}
    for axes, study in zip(rows, loads.values(), strict=True):
        names, best = best_formula(study, wanted)
        palette = [marker_style(name, k)["color"] for k, name in enumerate(names)] + [LIGHT]
        norm = BoundaryNorm(np.arange(len(palette) + 1) - 0.5, len(palette))
        for place, column in enumerate(columns):
            _draw(axes, place, best[:, :, column], ListedColormap(palette), norm)
        for k in np.unique(best[:, :, columns]):
            label = model_name(names[k]) if k < len(names) else "no formula"
            found[label] = Patch(facecolor=palette[k])
    found["no formula"] = found.pop("no formula", Patch(facecolor=LIGHT))
    figure.legend(found.values(), found.keys(), loc="outside upper center", ncols=5)
    caption = (
        f"The cheapest formula within {percent(wanted)} of finite elements, inside its stated "
        f"range, a row for each load; where there is none, the surrogate or finite elements."
        f"{_others(first)}"
    )
    words = " ".join(_best_in_words(load, study, wanted) for load, study in loads.items())
    return Drawing(figure, f"best_formula_{round(1000 * wanted):03d}", caption, words)


def _best_in_words(load: str, study: xr.Dataset, wanted: float) -> str:
    names, best = best_formula(study, wanted)
    shares = [
        f"{model_name(name)} {percent(np.mean(best == k))}"
        for k, name in enumerate(names)
        if (best == k).any()
    ]
    none = f"none {percent(np.mean(best == len(names)))}"
    return f"Load {load}, share of the points: {listed([*shares, none])}."
