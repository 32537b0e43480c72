"""Figures of the specimen."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from bondcell.figures.specimen_contours import draw_contours
from bondcell.figures.specimen_forces import draw_forces
from bondcell.figures.specimen_modes import draw_modes
from bondcell.figures.specimen_more import draw_finite_strain, draw_relaxation
from bondcell.figures.specimen_pair import draw_pair
from bondcell.figures.specimen_time import draw_time
from bondcell.figures.style import Drawing, drawing_style, save
from bondcell.specimen.view import Results


def draw_specimen(results: Results, folder: Path) -> list[Path]:
    """Draw everything a specimen's results have to show.

    Parameters
    ----------
    results
        See `bondcell.specimen.view.read_specimen`.
    folder
        Where the figures go.
    """
    with drawing_style():
        return [path for drawing in _drawings(results) for path in save(drawing, folder)]


def _drawings(results: Results) -> Iterator[Drawing]:
    study = results[""]
    yield draw_modes(study)
    if "ladder" in results:
        yield draw_time(results)
    for loading in study["loading"].values:
        if "midplane" in results:
            yield draw_contours(study, results["midplane"], str(loading))
        yield draw_forces(study, results["bonds"], str(loading))
    if "midplane" in results:
        yield draw_pair(study, results["midplane"])
    if "relaxation" in results:
        yield draw_relaxation(results["relaxation"])
    if "finite_strain" in results:
        yield draw_finite_strain(results["finite_strain"])
