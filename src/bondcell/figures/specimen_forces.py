"""Forces of the bonds, drawn on the lattice."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection

from bondcell.cell import FloatArray
from bondcell.figures.specimen_style import MM, centres, draw_particles, frame
from bondcell.figures.style import GREY, LIGHT, Drawing, new_figure
from bondcell.specimen.view import NAMES, first_walls, fullest
from bondcell.wording import number

WIDEST = 6.0
_LABEL = {"boxstyle": "circle,pad=0.15", "facecolor": "white", "linewidth": 0}


def draw_forces(study: xr.Dataset, bonds: xr.Dataset, loading: str) -> Drawing:
    """Normal and shear force of every bond of the lattice with the most springs.

    Parameters
    ----------
    study, bonds
        Root group and group ``bonds``.
    loading
        One of its loadings.
    """
    method, walls = fullest(study), first_walls(study)
    forces = bonds["bond_force"].sel({"method": method, "loading": loading, "walls": walls})
    ends = bonds["bond_nodes"].values - 1
    inside = ((ends >= 0) & (ends < study.sizes["particle"])).all(axis=1)
    inside &= np.isfinite(forces.sel(force="normal").values)
    ends, chosen = ends[inside], forces.values[inside]
    kinds = [kind for kind in ("normal", "shear") if np.isfinite(forces.sel(force=kind)).any()]
    figure = new_figure(7.4, 0.3 + 2.3 * len(kinds))
    panels = figure.subplots(len(kinds), 1, squeeze=False)[:, 0]
    for k, (axes, kind) in enumerate(zip(panels, kinds, strict=True)):
        lines = _lines(axes, ends, chosen[:, k])
        axes.set_title(f"{kind} force" + (", tension above zero" if kind == "normal" else ""))
        figure.colorbar(lines, ax=axes, label="N", shrink=0.9)
    caption = (
        f"Forces of the bonds ({NAMES[method]}), {loading} loading, {walls} walls; lines are as "
        "wide as the force is large, each panel has a scale of its own"
    )
    return Drawing(
        figure, f"forces_{loading}", f"{caption}.", _description(ends, chosen[:, : len(kinds)])
    )


def _lines(axes: Axes, ends: FloatArray, force: FloatArray) -> Any:
    points, most = centres(), np.abs(force).max()
    draw_particles(axes, points, facecolor="white", edgecolor=LIGHT, linewidth=0.8)
    axes.add_collection(LineCollection(list(MM * points[ends]), linewidths=0.6, colors=GREY))
    lines = LineCollection(
        list(MM * points[ends]),
        linewidths=WIDEST * np.abs(force) / most,
        cmap="RdBu_r",
        capstyle="round",
    )
    lines.set_array(force)
    lines.set_clim(-most, most)
    axes.add_collection(lines)
    for k, (x, y) in enumerate(MM * points, start=1):
        axes.annotate(str(k), (x, y), ha="center", va="center", fontsize=6.5, bbox=_LABEL)
    frame(axes)
    return lines


def _description(ends: FloatArray, forces: FloatArray) -> str:
    sentences = []
    for kind, values in zip(("normal", "shear"), forces.T, strict=False):
        low, high = int(values.argmin()), int(values.argmax())
        words = [
            f"{number(values[at], 3)} N between {ends[at][0] + 1} and {ends[at][1] + 1}"
            for at in (low, high)
        ]
        sentences.append(f"The {kind} forces go from {words[0]} to {words[1]}.")
    return " ".join(sentences)
