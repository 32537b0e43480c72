"""The specimen in time and at finite strain."""

from __future__ import annotations

import numpy as np
import xarray as xr

from bondcell.figures.specimen_style import METHODS
from bondcell.figures.style import BLACK, Drawing, new_figure
from bondcell.specimen.view import NAMES
from bondcell.wording import number, percent, quantity


def draw_relaxation(group: xr.Dataset) -> Drawing:
    """Reaction over time; a panel for each loading.

    Parameters
    ----------
    group
        Group ``relaxation``; methods without values are left out.
    """
    known = group.dropna("method", how="all", subset=["reaction"])
    loadings = known["loading"].values.tolist()
    figure = new_figure(7.4, 3.9)
    panels = figure.subplots(1, len(loadings), squeeze=False)[0]
    later = known["time"].values > 0
    words = []
    for axes, loading in zip(panels, loadings, strict=True):
        for method in known["method"].values:
            force = known["reaction"].sel({"method": method, "loading": loading}).values
            style = {**METHODS[str(method)], "markevery": 6, "markersize": 4}
            axes.plot(known["time"].values[later], force[later], label=NAMES[method], **style)
            share = percent(force[-1] / force[0])
            words.append(f"{loading}, {NAMES[method]}: {number(force[0], 3)} N, {share} are left")
        axes.set(xscale="log", yscale="log", xlabel="time [s]", title=f"{loading} loading")
    panels[0].set_ylabel("reaction [N]")
    handles, labels = panels[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside upper center", ncols=3)
    span = quantity(float(known["time"][-1]), "s", 1)
    caption = f"Force on the displaced particles while the matrix relaxes, up to {span}"
    return Drawing(figure, "reaction_over_time", f"{caption}.", "; ".join(words) + ".")


def draw_finite_strain(group: xr.Dataset) -> Drawing:
    """Energy at finite strain over the linear one, a group of bars for each direction.

    Parameters
    ----------
    group
        Group ``finite_strain``; methods without values are left out.
    """
    known = group.dropna("method", how="all", subset=["ratio"])
    methods = known["method"].values.tolist()
    directions = known["direction"].values.tolist()
    figure = new_figure(7.4, 3.4)
    axes = figure.subplots()
    width = 0.8 / len(methods)
    words = []
    for k, method in enumerate(methods):
        change = known["ratio"].sel({"method": method}).values - 1
        places = np.arange(len(directions)) + width * (k - (len(methods) - 1) / 2)
        colour = METHODS[method]["color"]
        axes.bar(places, 100 * change, 0.92 * width, color=colour, label=NAMES[method])
        told = [
            f"{percent(value, sign=True)} ({str(way).replace('-', '−')})"
            for way, value in zip(directions, change, strict=True)
        ]
        words.append(f"{NAMES[method]}: {', '.join(told)}")
    axes.axhline(0, color=BLACK, linewidth=0.8)
    for level in (-3, 3):
        axes.axhline(level, color=BLACK, linewidth=0.8, linestyle=":")
    axes.set_xticks(range(len(directions)), [name.replace("-", "−") for name in directions])
    axes.set_ylabel("energy beside linear theory [%]")
    axes.grid(visible=False, axis="x")
    figure.legend(loc="outside upper center", ncols=3)
    caption = (
        "Energy at finite strain beside that of the linear theory, by the direction of the "
        "displacement of 0.5 mm; dotted: the paper's 3 %"
    )
    return Drawing(figure, "finite_strain", f"{caption}.", "; ".join(words) + ".")
