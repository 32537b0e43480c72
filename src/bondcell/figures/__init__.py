"""Figures of a scene, drawn from its results alone."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from bondcell.figures.atlas_maps import atlas_maps
from bondcell.figures.atlas_time import draw_error_against_time
from bondcell.figures.bars import draw_bars
from bondcell.figures.convergence import convergence_drawings
from bondcell.figures.curves import draw_curves
from bondcell.figures.error_maps import draw_error_maps
from bondcell.figures.relaxation import relaxation_drawings
from bondcell.figures.relaxation_checks import draw_checks, draw_methods
from bondcell.figures.scatter import draw_scatter
from bondcell.figures.stability import draw_stability
from bondcell.figures.style import Drawing, drawing_style, save
from bondcell.results.atlas import accuracy_by_region, error_against_time
from bondcell.results.view import is_scattered, load_name, model_names, swept_axes

if TYPE_CHECKING:
    import xarray as xr

    from bondcell.scenes.scene import Scene


def draw_scene(
    scene: Scene,
    study: xr.Dataset,
    convergence: xr.Dataset | None,
    folder: Path,
    others: Sequence[xr.Dataset] = (),
    methods: xr.Dataset | None = None,
) -> list[Path]:
    """Draw everything a scene's results have to show.

    Parameters
    ----------
    scene
        The scene.
    study
        Its sweep's result; nothing is drawn of one without ``stiffness(model, ...)``.
    convergence
        Result of its convergence study, if any.
    folder
        Where the figures go.
    others
        Results of the sweep under the scene's other loads.
    methods
        Result of its comparison of methods in time, if any.

    Returns
    -------
    list of pathlib.Path
        Every figure as SVG and PNG, captions and descriptions in the files' metadata.
    """
    with drawing_style():
        loads = {load_name(found): found for found in (study, *others)}
        drawings = []
        if scene.stability:
            drawings.append(draw_stability(loads))
        if scene.atlas:
            drawings += atlas_drawings(loads)
        elif scene.prony is not None:
            for load, found in loads.items():
                drawings += relaxation_drawings(found, "" if found is study else f"_{load}")
            if scene.prony.checks:
                drawings.append(draw_checks(loads))
        elif scene.models or not scene.stability:
            drawings += sweep_drawings(study)
            for load, found in list(loads.items())[1:]:
                drawings += sweep_drawings(found, f"_{load}")
        if convergence is not None:
            drawings += convergence_drawings(convergence)
        if methods is not None:
            drawings.append(draw_methods(methods))
        return [path for drawing in drawings for path in save(drawing, folder)]


def atlas_drawings(loads: Mapping[str, xr.Dataset]) -> Iterator[Drawing]:
    """Error against run time, maps of errors and of the cheapest formulas.

    Parameters
    ----------
    loads
        Load -> result of an atlas.
    """
    yield draw_error_against_time(error_against_time(accuracy_by_region(loads)))
    yield from atlas_maps(loads)


def sweep_drawings(study: xr.Dataset, suffix: str = "") -> Iterator[Drawing]:
    """What a sweep's result has to show: bars at one point, else curves, and maps if there are any.

    Points that are no grid are marks over each of their parameters.

    Parameters
    ----------
    study
        A sweep's result.
    suffix
        End of the figures' names.
    """
    if not model_names(study):
        return
    if not swept_axes(study):
        yield draw_bars(study, f"stiffness{suffix}")
        return
    if is_scattered(study):
        yield draw_scatter(study, f"stiffness{suffix}")
        return
    yield draw_curves(study, f"stiffness{suffix}")
    maps = draw_error_maps(study, f"error_maps{suffix}")
    if maps is not None:
        yield maps
