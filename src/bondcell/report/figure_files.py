"""Figures as the page embeds them: one picture a figure, with the words it carries."""

from __future__ import annotations

import base64
import re
from collections.abc import Container
from dataclasses import dataclass
from io import BytesIO
from itertools import groupby
from pathlib import Path
from xml.etree import ElementTree

from markupsafe import Markup
from PIL import Image

SMALL_SVG, SAVING = 80_000, 2.0
"""A drawing above so many bytes is embedded as its PNG if that is so many times smaller."""

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
    width, height
        Natural size [px].
    """

    name: str
    source: Markup
    caption: str
    description: str
    path: Path
    width: int
    height: int


def embedded_figures(folder: Path, without: Container[str] = ()) -> list[EmbeddedFigure]:
    """The figures of a folder, the main one first; none if there is no folder.

    Parameters
    ----------
    folder
        Where `bondcell.figures.draw_scene` wrote.
    without
        Names of figures that are not wanted.
    """
    paths = sorted(folder.glob("*.svg"), key=lambda path: (_rank(path.stem), path.stem))
    return [_embedded(path) for path in paths if path.stem not in without]


def _pixels(length: str) -> int:
    return round(float(length.removesuffix("pt")) * 4 / 3)


def shortened(svg: str) -> str:
    r"""A drawing without what nobody sees: metadata, blanks, digits beyond a hundredth of a point.

    Parameters
    ----------
    svg
        What matplotlib wrote.

    Examples
    --------
    >>> shortened('<path d="M 1.23456 2.000001\nL 3.5 4 " id="a"/>\n')
    '<path d="M1.23 2L3.5 4" id="a"/>'
    """
    body = svg[svg.index("<svg") :] if "<svg" in svg else svg
    body = re.sub(r"<metadata>.*?</metadata>|<!--.*?-->", "", body, flags=re.DOTALL)
    body = re.sub(r"scale\([^)]*\)|-?\d+\.\d{3,}", _rounded, body)
    body = re.sub(r'(?<= d=")[^"]+', _path, body)
    body = re.sub(r">\s+<", "><", body).strip()
    body = _RASTER.sub(_repainted, body)
    return _MARKERS.sub(_styled_once, body)


def with_palette(png: bytes) -> bytes:
    """The picture with the 256 colours that serve it best, if that makes it smaller.

    Parameters
    ----------
    png
        A picture.
    """
    with Image.open(BytesIO(png)) as picture:
        few = picture.convert("RGBA").quantize(256, Image.Quantize.FASTOCTREE)
    made = BytesIO()
    few.save(made, format="PNG", optimize=True)
    return min(png, made.getvalue(), key=len)


_RASTER = re.compile(r"(?<=data:image/png;base64,)[A-Za-z0-9+/=\s]+")


def _repainted(match: re.Match[str]) -> str:
    """A picture inside a drawing, with a palette."""
    return base64.b64encode(with_palette(base64.b64decode(match[0]))).decode()


_MARKER = r'<use xlink:href="#[^"]+" x="[^"]+" y="[^"]+" style="[^"]+"/>'
_MARKERS = re.compile(f"(?:{_MARKER}){{3,}}")


def _styled_once(match: re.Match[str]) -> str:
    """Markers in a row share their style instead of repeating it."""
    found = []
    markers = (marker.rpartition(' style="') for marker in re.findall(_MARKER, match[0]))
    for style, same in groupby(markers, key=lambda parts: parts[2].removesuffix('"/>')):
        found.append(f'<g style="{style}">{"".join(parts[0] + "/>" for parts in same)}</g>')
    return "".join(found)


def address(svg: str) -> Markup:
    """A drawing as a data address that may stand between double quotes, almost as short as itself.

    Parameters
    ----------
    svg
        The drawing.

    Examples
    --------
    >>> address('<svg id="a">100 % &amp;</svg>')
    Markup("data:image/svg+xml,<svg id='a'>100 %25 &amp;amp;</svg>")
    """
    plain = " ".join(svg.split()).replace("%", "%25").replace("#", "%23")
    quoted = plain.replace('"', "%22" if "'" in plain else "'")
    return Markup(f"data:image/svg+xml,{quoted.replace('&', '&amp;')}")


def _rounded(match: re.Match[str]) -> str:
    if match[0].startswith("scale"):
        return match[0]
    return f"{float(match[0]):.2f}".rstrip("0").rstrip(".")


def _path(match: re.Match[str]) -> str:
    return re.sub(r"\s*([A-Za-z])\s*", r"\1", " ".join(match[0].split()))


def _rank(name: str) -> int:
    return ORDER.index(name) if name in ORDER else len(ORDER)


def _embedded(path: Path) -> EmbeddedFigure:
    drawn = path.read_text(encoding="utf-8")
    root = ElementTree.fromstring(drawn)
    source = address(shortened(drawn))
    picture = path.with_suffix(".png")
    if len(source) > SMALL_SVG and picture.is_file():
        content = base64.b64encode(with_palette(picture.read_bytes())).decode()
        if len(source) > SAVING * len(content):
            source = Markup(f"data:image/png;base64,{content}")
    return EmbeddedFigure(
        name=path.stem,
        source=source,
        caption=root.findtext(f".//{_DUBLIN_CORE}title", default=path.stem.replace("_", " ")),
        description=root.findtext(f".//{_DUBLIN_CORE}description", default=""),
        path=path,
        width=_pixels(root.get("width", "600pt")),
        height=_pixels(root.get("height", "400pt")),
    )
