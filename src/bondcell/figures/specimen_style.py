"""Colours and marks of the specimen's methods, and its particles as circles."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PatchCollection
from matplotlib.patches import Circle

from bondcell.cell import FloatArray
from bondcell.figures.style import BLACK, GREY
from bondcell.lattice.specimen_geometry import BOX, RADIUS, specimen_packing

METHODS: dict[str, dict[str, Any]] = {
    "fe_elastic": {"color": "#d55e00", "marker": "o"},
    "fe_rigid": {"color": BLACK, "marker": "s"},
    "lattice_paper": {"color": GREY, "marker": "*"},
    "lattice_fsi": {"color": "#0072b2", "marker": "o"},
    "lattice_film": {"color": "#882255", "marker": "X"},
    "lattice_fe_normal": {"color": "#e69f00", "marker": "v"},
    "lattice_fe_shear": {"color": "#56b4e9", "marker": "^"},
    "lattice_fe_beam": {"color": "#cc79a7", "marker": "D"},
    "lattice_full": {"color": "#009e73", "marker": "P"},
}

MM = 1e3


def centres() -> FloatArray:
    """Centres of the particles in the plane [m], shape (18, 2)."""
    return specimen_packing().centres[:, :2]


def draw_particles(axes: Axes, where: FloatArray, **style: Any) -> None:
    """Circles at places [m] on axes in millimetres."""
    circles = [Circle((MM * x, MM * y), MM * RADIUS) for x, y in where]
    axes.add_collection(PatchCollection(circles, **style))


def frame(axes: Axes) -> None:
    """The box on axes in millimetres, no ticks."""
    (left, right), (bottom, top) = MM * np.array(BOX[:2])
    axes.plot([left, right, right, left, left], [bottom, bottom, top, top, bottom], "-", c=GREY)
    axes.set_aspect("equal")
    axes.set(xlim=(left - 1, right + 1), ylim=(bottom - 0.3, top + 1), xticks=[], yticks=[])
    axes.grid(visible=False)
    for side in axes.spines.values():
        side.set_visible(False)
