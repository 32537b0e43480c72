"""Figures as the page embeds them: one picture a figure, with the words it carries."""

from __future__ import annotations

import base64
from dataclasses import dataclass
from pathlib import Path
from xml.etree import ElementTree

LARGEST_SVG = 700_000
"""A larger SVG [bytes] is embedded as its PNG."""

ORDER = (
    "relaxation",
    "error_over_time",
    "complex_stiffness",
    "relaxation_checks",
    "relaxation_methods",
    "stability",
    "energy_modes",
    "displacement_horizontal",
    "displacement_vertical",
    "particles_6_and_7",
    "forces_horizontal",
    "forces_vertical",
    "error_against_time",
    "best_formula_100",
    "best_formula_010",
    "atlas_errors_normal",
    "error_maps",
    "convergence_time",
    "convergence_dof",
    "convergence_basis",
)
"""Figures that come first, by name."""

_DUBLIN_CORE = "{http://purl.org/dc/elements/1.1/}"


@dataclass(frozen=True)
class EmbeddedFigure:
    """A figure on the page.

    Parameters
    ----------
    name
        File name without suffix.
    source
        Data address of the picture.
    caption, description
        What is drawn, and what is seen in it.
    path
        The file, for a link.
    width
        Natural width [px].
    """

    name: str
    source: str
    caption: str
    description: str
    path: Path
    width: int


def embedded_figures(folder: Path) -> list[EmbeddedFigure]:
    """All figures of a folder, the main one first; none if there is no folder.

    Parameters
    ----------
    folder
        Where `bondcell.figures.draw_scene` wrote.
    """
    paths = sorted(folder.glob("*.svg"), key=lambda path: (_rank(path.stem), path.stem))
    return [_embedded(path) for path in paths]


def _rank(name: str) -> int:
    return ORDER.index(name) if name in ORDER else len(ORDER)


def _embedded(path: Path) -> EmbeddedFigure:
    content = path.read_bytes()
    root = ElementTree.fromstring(content)
    picture = path.with_suffix(".png")
    if len(content) > LARGEST_SVG and picture.is_file():
        kind, content = "image/png", picture.read_bytes()
    else:
        kind = "image/svg+xml"
    return EmbeddedFigure(
        name=path.stem,
        source=f"data:{kind};base64,{base64.b64encode(content).decode()}",
        caption=root.findtext(f".//{_DUBLIN_CORE}title", default=path.stem.replace("_", " ")),
        description=root.findtext(f".//{_DUBLIN_CORE}description", default=""),
        path=path,
        width=round(float(root.get("width", "600pt").removesuffix("pt")) * 4 / 3),
    )
