"""Displacement magnitude in the mid-plane, solid and lattice on one colour scale."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.ticker import MaxNLocator
from matplotlib.tri import LinearTriInterpolator, Triangulation

from bondcell.cell import FloatArray
from bondcell.figures.specimen_style import MM, centres, draw_particles, frame
from bondcell.figures.style import BLACK, Drawing, new_figure
from bondcell.lattice.specimen_geometry import BOX, RADIUS
from bondcell.specimen.view import NAMES, best_solid, first_walls, fullest
from bondcell.wording import percent, quantity

PIXEL = 0.2e-3
"""Spacing of the points on which the lattice's field is drawn [m]."""


def draw_contours(study: xr.Dataset, plane: xr.Dataset, loading: str) -> Drawing:
    """Two panels: the solid, and the lattice with the most springs.

    Parameters
    ----------
    study, plane
        Root group and group ``midplane``.
    loading
        One of its loadings.
    """
    method, walls = fullest(study), plane.attrs.get("walls") or first_walls(study)
    solid = plane["displacement"].sel(loading=loading).transpose("vertex", "component").values
    size = np.linalg.norm(solid, axis=1)
    one = study.sel({"method": method, "loading": loading, "walls": walls})
    x, y, field = lattice_field(one)
    highest = MM * max(size.max(), np.nanmax(field))
    levels = np.linspace(0, highest, 21)
    figure = new_figure(7.4, 4.7)
    upper, lower = figure.subplots(2, 1)
    place = MM * plane["place"].values
    mesh = Triangulation(place[:, 0], place[:, 1], plane["triangle"].values)
    upper.tricontourf(mesh, MM * size, levels, cmap="viridis").set_rasterized(True)
    shown = lower.contourf(MM * x, MM * y, MM * field, levels, cmap="viridis")
    shown.set_rasterized(True)
    for axes, name in ((upper, best_solid(study)), (lower, method)):
        draw_particles(axes, centres(), facecolor="none", edgecolor=BLACK, linewidth=0.6)
        frame(axes)
        axes.set_title(NAMES[name])
    figure.colorbar(shown, ax=[upper, lower], label="displacement [mm]", ticks=MaxNLocator(7))
    at_centres = np.linalg.norm(one["displacement"].values, axis=1)
    error = percent(one["displacement_error"]) if "displacement_error" in one else "–"
    caption = (
        f"Displacement magnitude in the mid-plane, {loading} loading, {walls} walls, one colour "
        "scale: particles of the lattice move rigidly, between them its field is interpolated "
        "linearly; outside the centres it says nothing"
    )
    description = (
        f"Largest displacement: solid {quantity(size.max(), 'm')}, lattice "
        f"{quantity(at_centres.max(), 'm')} at a centre. Displacement vectors of the free "
        f"particles differ by {error}."
    )
    return Drawing(figure, f"displacement_{loading}", f"{caption}.", description)


def lattice_field(one: xr.Dataset) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Displacement magnitude of a lattice on a grid [m], NaN outside.

    Parameters
    ----------
    one
        Root group at one method, loading and kind of walls.

    Returns
    -------
    tuple
        x and y of the grid [m], and the field, shape (y, x).
    """
    points, moved = centres(), one["displacement"].values
    turned = np.nan_to_num(one["rotation"].values)
    x = np.arange(BOX[0][0], BOX[0][1] + PIXEL, PIXEL)
    y = np.arange(0.0, BOX[1][1] + PIXEL, PIXEL)
    where = np.stack(np.meshgrid(x, y), axis=-1)
    mesh = Triangulation(*points.T)
    parts = [
        np.ma.filled(LinearTriInterpolator(mesh, moved[:, k])(where[..., 0], where[..., 1]), np.nan)
        for k in range(2)
    ]
    field = np.stack(parts, axis=-1)
    for centre, shift, turn in zip(points, moved, turned, strict=True):
        arm = where - centre
        inside = (arm**2).sum(axis=-1) <= RADIUS**2
        field[inside] = shift + turn * np.stack([-arm[..., 1], arm[..., 0]], axis=-1)[inside]
    return x, y, np.linalg.norm(field, axis=-1)
