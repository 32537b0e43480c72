"""How every figure looks: a palette that colour-blind readers can tell apart, fonts, files."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import matplotlib as mpl
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from bondcell.results.view import is_reference
from bondcell.storage import replacing

BLACK, GREY, LIGHT = "#1a1a1a", "#6b6b6b", "#d9d9d9"

LINES: dict[str, dict[str, Any]] = {
    "fsi": {"color": "#0072b2", "linestyle": "-", "linewidth": 2.4, "marker": "o"},
    "general": {"color": "#56b4e9", "linestyle": (0, (5, 1.5)), "marker": "s"},
    "generatrix": {"color": "#009e73", "linestyle": "-.", "marker": "^"},
    "slices": {"color": "#e69f00", "linestyle": "-", "marker": "v"},
    "parallel_bond": {
        "color": "#cc79a7",
        "linestyle": (0, (3, 1.2, 1, 1.2, 1, 1.2)),
        "marker": "D",
    },
    "cementation": {"color": "#7a5195", "linestyle": (0, (1, 1.2)), "marker": "P"},
    "film": {"color": "#882255", "linestyle": (0, (8, 2)), "marker": "X"},
    "bounds": {"color": "#4d4d4d", "linestyle": (0, (2, 1)), "marker": "d"},
    "surrogate": {"color": "#3b7d4f", "linestyle": (0, (6, 1, 1, 1)), "marker": "*"},
}
"""Colour (Okabe and Ito's set), line and marker of each analytic model: never colour alone."""

REFERENCES: dict[str, dict[str, Any]] = {
    "fe": {"color": "#d55e00", "marker": "o"},
    "fe_clamped": {"color": BLACK, "marker": "s"},
    "fe_confined": {"color": GREY, "marker": "^"},
}
"""Dots of the finite element references."""

PARTS: dict[str, dict[str, Any]] = {
    "k_int": {"color": BLACK, "linestyle": "-", "linewidth": 0.9},
    "k_i": {"color": GREY, "linestyle": "--", "linewidth": 0.9},
    "k_j": {"color": GREY, "linestyle": ":", "linewidth": 1.4},
}
"""Contributions to the series model."""

_SPARE = ({"color": "#8c6d1f"}, {"color": "#4d4d4d"}, {"color": "#3b7d4f"})

_SETTINGS: dict[Any, Any] = {
    "figure.dpi": 100,
    "savefig.dpi": 160,
    "font.family": "DejaVu Sans",
    "font.size": 9,
    "axes.titlesize": 9.5,
    "axes.labelsize": 9,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.axisbelow": True,
    "axes.grid": True,
    "axes.unicode_minus": True,
    "grid.color": "#e3e3e3",
    "grid.linewidth": 0.6,
    "legend.frameon": False,
    "legend.fontsize": 8,
    "lines.linewidth": 1.6,
    "xtick.labelsize": 8,
    "ytick.labelsize": 8,
    "svg.fonttype": "path",
    "svg.hashsalt": "bondcell",
}


@dataclass(frozen=True)
class Drawing:
    """A figure with what it shows in words.

    Parameters
    ----------
    figure
        The figure.
    name
        File name without suffix.
    caption
        What is drawn, for everybody.
    description
        What is seen in it, for those who cannot see it.
    """

    figure: Figure
    name: str
    caption: str
    description: str


@contextmanager
def drawing_style() -> Iterator[None]:
    """The settings above, for the block only."""
    with mpl.rc_context(_SETTINGS):
        yield


def new_figure(width: float, height: float) -> Figure:
    """A figure of that size [inch] that no window system knows of."""
    figure = Figure(figsize=(width, height), layout="constrained")
    FigureCanvasAgg(figure)
    return figure


def line_style(model: str, position: int = 0) -> dict[str, Any]:
    """Colour and line of an analytic model."""
    chosen = LINES.get(model, _SPARE[position % len(_SPARE)])
    return {key: value for key, value in chosen.items() if key != "marker"}


def marker_style(model: str, position: int = 0) -> dict[str, Any]:
    """Colour and marker of a model or a reference."""
    chosen = REFERENCES.get(model) or LINES.get(model) or _SPARE[position % len(_SPARE)]
    style = {"color": chosen["color"], "marker": chosen.get("marker", "*"), "linestyle": "none"}
    return style | ({"markersize": 4.5} if is_reference(model) else {"markersize": 6})


def mathtext(symbol: str) -> str:
    """A plain symbol as matplotlib sets it.

    Examples
    --------
    >>> mathtext("E_i/E_m"), mathtext("K_n"), mathtext("level")
    ('$E_i/E_m$', '$K_n$', 'level')
    """
    if "_" not in symbol:
        return symbol
    text = symbol.replace("ν", r"\nu")
    return f"${'/'.join(_with_subscript(part) for part in text.split('/'))}$"


def _with_subscript(text: str) -> str:
    head, _, sub = text.partition("_")
    return rf"{head}_{{\mathrm{{{sub}}}}}" if len(sub) > 1 else text


def save(drawing: Drawing, folder: Path) -> list[Path]:
    """Write a drawing as SVG and PNG; the words go into the files' metadata.

    Parameters
    ----------
    drawing
        What to write.
    folder
        Where; made if need be.

    Returns
    -------
    list of pathlib.Path
        The two files. The same data gives the same bytes.
    """
    _settle(drawing.figure)
    words = {"Title": drawing.caption, "Description": drawing.description}
    paths = []
    for suffix, extra in (("svg", {"Date": None, "Creator": None}), ("png", {"Software": None})):
        path = folder / f"{drawing.name}.{suffix}"
        with replacing(path) as temporary:
            drawing.figure.savefig(temporary, format=suffix, metadata=words | extra)
        paths.append(path)
    return paths


def _settle(figure: Figure) -> None:
    """Find the layout once for all files: it is most of the time of a drawing."""
    engine = figure.get_layout_engine()
    if engine is not None:
        engine.execute(figure)
        figure.set_layout_engine(None)  # "none" would leave a placeholder, which costs a dry run
