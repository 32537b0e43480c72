"""The report: one self-contained page on all scenes of a study."""

from __future__ import annotations

import json
import os
import re
from collections.abc import Iterable, Mapping, Sized
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any
from urllib.parse import quote

from jinja2 import Environment, PackageLoader, StrictUndefined

from bondcell.errors import DataError, Violation
from bondcell.models import MODELS
from bondcell.report.found_scenes import found_scenes
from bondcell.report.front import front
from bondcell.report.interactive.library import drawing_library
from bondcell.report.scene_cost import cost_lines
from bondcell.report.sections import Section, build_section
from bondcell.report.symbols import with_subscripts
from bondcell.storage import replacing
from bondcell.wording import SYMBOLS, listed, model_name

if TYPE_CHECKING:
    from bondcell.scenes.scene import Scene


@dataclass(frozen=True)
class Written:
    """What was put on the page.

    Parameters
    ----------
    path
        The page.
    scenes
        Names of the scenes that have a section.
    sentences
        The main findings, plain text.
    """

    path: Path
    scenes: list[str]
    sentences: list[str]


def write_report(results: Path, path: Path, scenes: Iterable[Scene] | None = None) -> Written:
    """Write the page; it appears under its name when it is complete.

    Parameters
    ----------
    results
        The folder with a folder for each scene.
    path
        The page; its links to the results are relative.
    scenes
        The study's scenes in order, one without results is named as missing; None: all that the
        folder holds.

    Raises
    ------
    DataError
        A file of results is missing, damaged or of another make.
    """
    wanted = found_scenes(results) if scenes is None else list(scenes)
    sections = [section for scene in wanted if (section := _section(scene, results))]
    done = [section.name for section in sections]
    first = front(sections)
    chief = first.chief[1] if first.chief else None
    page = (
        _environment()
        .get_template("report.html.j2")
        .render(
            sections=sections,
            beside=_address(results, path.parent),
            missing=[scene.name for scene in wanted if scene.name not in done],
            front=first,
            chief=chief,
            models=_models(sections),
            provenance=_provenance(sections),
            costs=cost_lines(sections),
            library=drawing_library() if _is_interactive(sections) else "",
            written=datetime.now(UTC).strftime("%Y-%m-%d %H:%M UTC"),
        )
    )
    with replacing(path) as temporary:
        temporary.write_text(page, encoding="utf-8")
    return Written(path, done, first.sentences)


def _section(scene: Scene, results: Path) -> Section | None:
    """A scene's section; what a file lacks is said as an error of the file."""
    try:
        return build_section(scene, results)
    except KeyError as error:
        wanted = "what this version of bondcell writes: compute the scene again"
        found = [Violation("content", str(error.args[0])[:80], wanted)]
        raise DataError(found, str(results / scene.name / "study.nc")) from error


def _address(folder: Path, page_folder: Path) -> str:
    """Relative address of a folder from the page, empty or with a slash at its end."""
    relative = Path(os.path.relpath(folder, page_folder)).as_posix()
    return "" if relative == "." else f"{quote(relative)}/"


def _is_interactive(sections: Iterable[Section]) -> bool:
    return any(section.interactive for section in sections)


def _environment() -> Environment:
    environment = Environment(
        loader=PackageLoader("bondcell.report", "templates"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters["symbols"] = with_subscripts
    environment.globals["counted"] = counted
    return environment


def counted(things: Mapping[str, Sized]) -> str:
    """How many there are of each, those that there are.

    Examples
    --------
    >>> counted({"figure": [1], "table": [1, 2], "finding": []})
    '1 figure and 2 tables'
    """
    words = [
        f"{len(those)} {name}{'s' if len(those) > 1 else ''}"
        for name, those in things.items()
        if those
    ]
    return listed(words)


def _models(sections: Iterable[Section]) -> list[dict[str, str]]:
    """What each model on the page is, from the package's own description."""
    names = dict.fromkeys(name for section in sections for name in section.models)
    return [
        {
            "name": model_name(name),
            "summary": _INPUT.sub(_input_symbol, MODELS[name].summary),
            "valid": _INPUT.sub(_input_symbol, MODELS[name].valid_range),
            "source": MODELS[name].source,
        }
        for name in names
        if name in MODELS
    ]


_INPUT = re.compile(rf"\b({'|'.join(name for name in SYMBOLS if '_' in name)})\b")
"""Names of inputs that only those who use the package know; gap and time are words as well."""


def _input_symbol(match: re.Match[str]) -> str:
    return SYMBOLS[match[1]]


def _provenance(sections: Iterable[Section]) -> list[dict[str, Any]]:
    """Origins, told once for all scenes that share one."""
    shared: dict[str, list[str]] = {}
    for section in sections:
        shared.setdefault(json.dumps(section.provenance), []).append(section.title)
    return [
        {
            "scenes": "All scenes" if len(shared) == 1 else listed(titles),
            "lines": _origin(json.loads(origin)),
        }
        for origin, titles in shared.items()
        if json.loads(origin)
    ]


def _origin(given: dict[str, str]) -> list[tuple[str, str]]:
    lines = []
    for name, value in given.items():
        text = value
        if name == "versions":
            versions = json.loads(value)
            text = ", ".join(f"{package} {version}" for package, version in versions.items())
        lines.append((name.replace("_", " "), text))
    return lines
