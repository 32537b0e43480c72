"""The report: one self-contained page on all scenes of a study."""

from __future__ import annotations

import json
import os
import re
from collections.abc import Iterable
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any
from urllib.parse import quote

from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup, escape

from bondcell.models import MODELS
from bondcell.report.findings import Finding
from bondcell.report.found_scenes import found_scenes
from bondcell.report.sections import Section, build_section
from bondcell.storage import replacing
from bondcell.wording import SYMBOLS, listed, model_name

if TYPE_CHECKING:
    from bondcell.scenes.scene import Scene

HEADLINES = 6
"""Most findings on the first screen."""

SENTENCES = 3
"""Most of them in words."""

_SYMBOL = re.compile(
    r"(?<![\w/])([A-Za-zν])_(int|FE|[a-z]{1,2})(?![\w])|(?<=/)([A-Za-z])_([a-z])\b"
)


_POWER = re.compile(r"(?<![\w.])(\d(?:\.\d+)?)e(-?\d+)\b")

_TIED = re.compile(r" (?=[%=≥])|(?<=[=≥]) ")
"""Blanks at which a line does not break: before a per cent sign, around an equals sign."""


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
    sections = [section for scene in wanted if (section := build_section(scene, results))]
    done = [section.name for section in sections]
    shown = headlines(sections)
    page = (
        _environment()
        .get_template("report.html.j2")
        .render(
            sections=sections,
            beside=_address(results, path.parent),
            missing=[scene.name for scene in wanted if scene.name not in done],
            headlines=shown,
            models=_models(sections),
            provenance=_provenance(sections),
            written=datetime.now(UTC).strftime("%Y-%m-%d %H:%M UTC"),
        )
    )
    with replacing(path) as temporary:
        temporary.write_text(page, encoding="utf-8")
    return Written(path, done, [finding.text for _, finding in shown[:SENTENCES]])


def _address(folder: Path, page_folder: Path) -> str:
    """Relative address of a folder from the page, empty or with a slash at its end."""
    relative = Path(os.path.relpath(folder, page_folder)).as_posix()
    return "" if relative == "." else f"{quote(relative)}/"


def headlines(sections: Iterable[Section]) -> list[tuple[Section, Finding]]:
    """Findings for the first screen: of each topic the one that comes first on the page.

    Parameters
    ----------
    sections
        The page's sections in order.
    """
    chosen = [
        (section, finding) for section in sections for finding in section.findings if finding.key
    ]
    first = {finding.topic: (section, finding) for section, finding in reversed(chosen)}
    return [pair for pair in chosen if pair in first.values()][:HEADLINES]


def with_subscripts(text: str) -> Markup:
    """Set the symbols in a text with italics and subscripts, its numbers with powers of ten.

    Examples
    --------
    >>> str(with_subscripts("E_i/E_m < 12"))
    '<i>E</i><sub>i</sub>/<i>E</i><sub>m</sub> &lt; 12'
    >>> str(with_subscripts("4.9e-7, 1e6"))
    '4.9·10<sup>−7</sup>, 10<sup>6</sup>'
    """

    def symbol(match: re.Match[str]) -> str:
        head, sub = match[1] or match[3], match[2] or match[4]
        return f"<i>{head}</i><sub>{sub}</sub>"

    def power(match: re.Match[str]) -> str:
        mantissa = "" if match[1] == "1" else f"{match[1]}·"
        return f"{mantissa}10<sup>{match[2].replace('-', '−')}</sup>"

    unbroken = _TIED.sub("\u00a0", text)
    return Markup(_POWER.sub(power, _SYMBOL.sub(symbol, str(escape(unbroken)))))


def _environment() -> Environment:
    environment = Environment(
        loader=PackageLoader("bondcell.report", "templates"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters["symbols"] = with_subscripts
    environment.filters["model_name"] = model_name
    return environment


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
        {"scenes": listed(titles), "lines": _origin(json.loads(origin))}
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
