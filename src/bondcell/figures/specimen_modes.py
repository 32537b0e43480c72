"""Energy of the lattices by mode of deformation."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes

from bondcell.figures.style import BLACK, GREY, Drawing, new_figure
from bondcell.specimen.names import LATTICES
from bondcell.specimen.view import NAMES, first_walls, rows_of
from bondcell.wording import percent

COLOURS = {
    "normal": "#0072b2",
    "shear": "#e69f00",
    "bending": "#cc79a7",
    "torsion": GREY,
    "pocket": "#009e73",
    "ground": "#56b4e9",
}
MJ = 1e3


def draw_modes(study: xr.Dataset) -> Drawing:
    """A stacked bar a lattice, the solid's energy as a line; a panel for each loading.

    Parameters
    ----------
    study
        Root group.
    """
    walls = first_walls(study)
    lattices = rows_of(study, LATTICES)
    loadings = study["loading"].values.tolist()
    figure = new_figure(7.4, 1.3 + 0.33 * len(lattices))
    panels = figure.subplots(1, len(loadings), sharey=True, squeeze=False)[0]
    words = []
    found: dict[str, Any] = {}
    for axes, loading in zip(panels, loadings, strict=True):
        here = study.sel(loading=loading, walls=walls)
        found |= _bars(axes, here, lattices)
        right = float(here["reference_energy"])
        if np.isfinite(right):
            doubt = MJ * right * float(np.nan_to_num(here["reference_error"]))
            line = axes.axvline(MJ * right, color=BLACK, linewidth=1.2)
            axes.axvspan(MJ * right - doubt, MJ * right + doubt, color=BLACK, alpha=0.12, zorder=0)
            found["3D solid, with uncertainty"] = line
        axes.set(title=f"{loading} loading", xlabel="energy [mJ]")
        axes.grid(visible=False, axis="y")
        axes.margins(x=0.06)
        axes.use_sticky_edges = False
        words.append(f"{loading}: {_words(here, lattices)}")
    panels[0].set_yticks(range(len(lattices)), [NAMES[name] for name in lattices])
    panels[0].invert_yaxis()
    figure.legend(found.values(), found.keys(), loc="outside upper center", ncols=4)
    caption = f"Energy of each lattice by mode of deformation, {walls} walls"
    return Drawing(figure, "energy_modes", f"{caption}.", ". ".join(words) + ".")


def _bars(axes: Axes, here: xr.Dataset, lattices: list[str]) -> dict[str, Any]:
    found = {}
    places = np.arange(len(lattices))
    energies = here["mode_energy"].sel({"method": lattices})
    up, down = np.zeros(len(lattices)), np.zeros(len(lattices))
    for mode in energies["mode"].values:
        values = np.nan_to_num(energies.sel(mode=mode).values)
        if not np.abs(values).max() > 1e-6 * energies.max():
            continue
        # What gives way stands to the left of zero: the bar's sum is the energy.
        left = np.where(values >= 0, up, down + values)
        colour = COLOURS[str(mode)]
        found[str(mode)] = axes.barh(places, MJ * np.abs(values), 0.66, MJ * left, color=colour)
        up, down = up + np.maximum(values, 0), down + np.minimum(values, 0)
    return found


def _words(here: xr.Dataset, lattices: list[str]) -> str:
    parts = []
    for name in lattices:
        one = here.sel({"method": name})
        share = float(one["mode_energy"].sel(mode="normal") / one["energy"])
        parts.append(f"{NAMES[name]} {percent(share)} of its energy in normal springs")
    return ", ".join(parts)
