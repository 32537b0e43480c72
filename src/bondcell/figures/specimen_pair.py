"""Particles 6 and 7: where they go, and the stress around them."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.tri import Triangulation

from bondcell.cell import FloatArray
from bondcell.figures.specimen_style import MM, centres, draw_particles
from bondcell.figures.style import BLACK, GREY, Drawing, new_figure
from bondcell.lattice.specimen_geometry import RADIUS
from bondcell.specimen.view import NAMES, best_solid, first_walls, fullest
from bondcell.wording import number, quantity

PAIR = (6, 7)
MAGNIFIED = 5
AROUND = 2.5e-3
"""How far beyond the particles the stress is drawn [m]."""

_LATTICE = "#009e73"
_SOLID = "#d55e00"


def draw_pair(study: xr.Dataset, plane: xr.Dataset) -> Drawing:
    """A row for each loading: initial and final positions, largest principal stress.

    Parameters
    ----------
    study, plane
        Root group and group ``midplane``.
    """
    walls = plane.attrs.get("walls") or first_walls(study)
    loadings = study["loading"].values.tolist()
    figure = new_figure(7.4, 2.3 * len(loadings) + 0.5)
    grid = figure.subplots(len(loadings), 2, squeeze=False)
    words = []
    for row, loading in zip(grid, loadings, strict=True):
        here = study.sel(loading=loading, walls=walls)
        words.append(f"{loading}: {_positions(row[0], here, best_solid(study), fullest(study))}")
        row[0].set_title(f"{loading}: motion {MAGNIFIED} times enlarged")
        shown = _stress(row[1], plane.sel(loading=loading))
        row[1].set_title("largest principal stress")
        figure.colorbar(shown, ax=row[1], label="MPa", extend="both", shrink=0.85)
    handles, labels = grid[0, 0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside upper center", ncols=3)
    caption = (
        f"Particles 6 and 7, {walls} walls: initial and final positions with a radius that shows "
        "the rotation, and the largest principal stress of the solid in the mid-plane"
    )
    return Drawing(figure, "particles_6_and_7", f"{caption}.", " ".join(words))


def _positions(axes: Axes, here: xr.Dataset, solid: str, lattice: str) -> str:
    chosen = [number - 1 for number in PAIR]
    start = centres()[chosen]
    draw_particles(axes, start, facecolor="#eeeeee", edgecolor=GREY, linestyle="--")
    words = []
    # The wide line below shows on both sides of the narrow one where they agree.
    for method, colour, width in ((solid, _SOLID, 4.0), (lattice, _LATTICE, 1.2)):
        one = here.sel({"method": method, "particle": list(PAIR)})
        moved, turned = one["displacement"].values, one["rotation"].values
        where = start + MAGNIFIED * moved
        draw_particles(axes, where, facecolor="none", edgecolor=colour, linewidth=width)
        for place, turn in zip(where, MAGNIFIED * np.nan_to_num(turned), strict=True):
            tip = place + RADIUS * np.array([-np.sin(turn), np.cos(turn)])
            axes.plot(*(MM * np.array([place, tip])).T, "-", color=colour, linewidth=width)
        axes.plot([], [], "-", color=colour, linewidth=width, label=NAMES[method])
        told = [
            f"{name} by {quantity(np.linalg.norm(shift), 'm', 3)} and {number(1e3 * turn, 3)} mrad"
            for name, shift, turn in zip(PAIR, moved, turned, strict=True)
        ]
        words.append(f"{NAMES[method]} moves {' and '.join(told)}.")
    axes.plot([], [], "--", color=GREY, label="initial")
    _window(axes, start)
    return " ".join(words)


def _stress(axes: Axes, plane: xr.Dataset) -> Any:
    start = centres()[[number - 1 for number in PAIR]]
    place = plane["place"].values
    high = plane["principal_stress"].sel(end="largest").values / 1e6
    low, top = start.min(axis=0) - RADIUS - AROUND, start.max(axis=0) + RADIUS + AROUND
    near = ((place >= low - AROUND) & (place <= top + AROUND)).all(axis=1)
    triangles = plane["triangle"].values
    triangles = triangles[near[triangles].any(axis=1)]
    mesh = Triangulation(MM * place[:, 0], MM * place[:, 1], triangles)
    # Few vertices in the narrowest gaps and at interfaces must not decide the scale.
    limit = np.quantile(np.abs(high[near]), 0.97)
    shown = axes.tripcolor(
        mesh, high, shading="gouraud", cmap="RdBu_r", vmin=-limit, vmax=limit, rasterized=True
    )
    draw_particles(axes, start, facecolor="none", edgecolor=BLACK, linewidth=0.7)
    _window(axes, start)
    return shown


def _window(axes: Axes, start: FloatArray) -> None:
    for name, (x, y) in zip(PAIR, MM * start, strict=True):
        axes.annotate(str(name), (x, y - 2), ha="center", va="top", color=GREY)
    low = MM * (start.min(axis=0) - RADIUS - AROUND)
    high = MM * (start.max(axis=0) + RADIUS + AROUND)
    axes.set_aspect("equal")
    axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), xticks=[], yticks=[])
    axes.grid(visible=False)
    for side in axes.spines.values():
        side.set_visible(False)
