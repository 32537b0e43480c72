"""The parts of the page: one section for each scene that has results."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING

import xarray as xr

from bondcell.report.atlas_part import atlas_part
from bondcell.report.convergence_part import convergence_findings, convergence_lines
from bondcell.report.figure_files import EmbeddedFigure, embedded_figures
from bondcell.report.findings import Finding
from bondcell.report.flag_table import flag_lines
from bondcell.report.interactive.figure import InteractiveFigure
from bondcell.report.relaxation_part import (
    read_relaxing,
    relaxation_findings,
    relaxation_lines,
)
from bondcell.report.scene_cost import Cost, scene_cost
from bondcell.report.scene_figures import (
    atlas_figures,
    ladder_figures,
    relaxing_figures,
    specimen_figures,
    sweep_figures,
)
from bondcell.report.setup_table import Line, setup_lines
from bondcell.report.specimen_part import specimen_part
from bondcell.report.stability_part import stability_findings, stability_lines
from bondcell.report.sweep_findings import sweep_findings
from bondcell.report.tables import Table, accuracy_lines, influence_lines, value_lines
from bondcell.results.accuracy import accuracy_table
from bondcell.results.load_groups import read_loads
from bondcell.results.stability import stability_table
from bondcell.results.view import model_names
from bondcell.specimen.view import error_table, read_specimen
from bondcell.storage import read_dataset

if TYPE_CHECKING:
    from bondcell.scenes.scene import Scene

FILES = (
    "study.nc",
    "accuracy.csv",
    "stability.csv",
    "convergence.csv",
    "accuracy_by_region.csv",
    "best_models.csv",
    "error_against_time.csv",
    "accuracy_over_time.csv",
    "relaxation_stability.csv",
    "bond_series.csv",
    "bond_series.nc",
)
"""Files of a scene that the page links."""


FINDINGS = 5
"""Findings of a scene that are not folded away."""

SPECIMEN_PICTURES = 3
"""Pictures of a specimen that are not folded away."""


@dataclass(frozen=True)
class Link:
    """A file beside the page."""

    address: str
    text: str


@dataclass(frozen=True)
class Section:
    """What the page says about a scene.

    Parameters
    ----------
    name, title, question, setup
        The scene and what it was asked.
    findings
        What it shows, most important first.
    interactive, figures
        Figures with controls, and static ones that these do not replace; main ones first.
    tables
        The main one first.
    links
        Files.
    models
        Names of the models in it.
    loads, ladders
        Its results by load, and its convergence study.
    is_atlas, is_specimen
        What kind of scene it is.
    provenance, cost
        Where it comes from, and what it took.
    """

    name: str
    title: str
    question: str
    setup: list[Line]
    findings: list[Finding]
    interactive: list[InteractiveFigure]
    figures: list[EmbeddedFigure]
    tables: list[Table]
    links: list[Link]
    models: list[str]
    loads: Mapping[str, xr.Dataset]
    ladders: xr.Dataset | None = None
    is_atlas: bool = False
    is_specimen: bool = False
    provenance: dict[str, str] = field(default_factory=dict)
    cost: Cost = field(default_factory=Cost)

    @property
    def open_findings(self) -> int:
        """Findings that are not folded away: the first ones, or all where few are left."""
        return len(self.findings) if len(self.findings) <= FINDINGS + 2 else FINDINGS

    @property
    def open_figures(self) -> int:
        """Static figures that are not folded away: without others the main one."""
        if self.is_specimen:  # its pictures are what it is about
            return SPECIMEN_PICTURES
        return 0 if self.interactive and not self.is_atlas else 1


@dataclass
class _Content:
    """What is gathered for a section."""

    findings: list[Finding] = field(default_factory=list)
    tables: list[Table | None] = field(default_factory=list)
    interactive: list[InteractiveFigure | None] = field(default_factory=list)

    def add(
        self,
        findings: Iterable[Finding],
        tables: Iterable[Table | None],
        interactive: Iterable[InteractiveFigure | None] = (),
    ) -> None:
        self.findings += findings
        self.tables += tables
        self.interactive += interactive


def build_section(scene: Scene, results: Path) -> Section | None:
    """The section of a scene, or None when it has no results.

    Parameters
    ----------
    scene
        The scene.
    results
        The folder with a folder for each scene.
    """
    folder = results / scene.name
    file = folder / "study.nc"
    if not file.is_file():
        return None
    loads = read_loads(file)
    study = next(iter(loads.values()))
    ladders = read_dataset(file, group="convergence") if scene.convergence else None
    content = _Content()
    if ladders is not None:
        figures = ladder_figures(scene.name, ladders)
        content.add(convergence_findings(ladders), convergence_lines(ladders), figures)
    if scene.stability:
        points = stability_table(loads)
        content.add(stability_findings(points, study), stability_lines(points, study))
    _add_main(content, scene, folder, loads)
    content.tables.append(flag_lines(loads))
    interactive = [figure for figure in content.interactive if figure is not None]
    replaced = {name for figure in interactive for name in figure.replaces}
    return Section(
        name=scene.name,
        title=scene.title,
        question=scene.question or "",
        setup=setup_lines(scene),
        findings=content.findings,
        interactive=interactive,
        figures=embedded_figures(folder / "figures", without=replaced),
        tables=[table for table in content.tables if table is not None],
        links=_links(folder),
        models=list(dict.fromkeys(name for found in loads.values() for name in model_names(found))),
        loads=loads,
        ladders=ladders,
        is_atlas=scene.atlas,
        is_specimen=scene.specimen is not None,
        provenance=_provenance(study),
        cost=scene_cost(loads, file),
    )


def _add_main(
    content: _Content, scene: Scene, folder: Path, loads: Mapping[str, xr.Dataset]
) -> None:
    """What the scene is about: an atlas, relaxation, the specimen or a sweep."""
    if scene.atlas:
        content.add(*atlas_part(loads), atlas_figures(scene.name, loads))
    elif scene.prony is not None:
        relaxing = read_relaxing(folder, loads, with_methods=scene.prony.methods is not None)
        figures = relaxing_figures(scene.name, relaxing.study, relaxing.methods)
        content.add(relaxation_findings(relaxing), relaxation_lines(relaxing), figures)
    elif scene.specimen is not None:
        results = read_specimen(folder / "study.nc")
        figures = specimen_figures(scene.name, error_table(results))
        content.add(*specimen_part(results), figures)
    elif scene.models or not scene.stability:
        for load, found in loads.items():
            table = accuracy_table(found)
            said = _under(load, sweep_findings(found, table), several=len(loads) > 1)
            shown = [accuracy_lines(found, table), influence_lines(found), value_lines(found)]
            content.add(said, shown)
        content.interactive += sweep_figures(scene.name, loads)


def _under(load: str, findings: list[Finding], *, several: bool) -> list[Finding]:
    """Say the load with each finding where there are several; only one load makes headlines."""
    if not several:
        return findings
    said = [replace(finding, text=f"Load {load}: {finding.text}") for finding in findings]
    return said if load == "normal" else [replace(finding, key="") for finding in said]


def _links(folder: Path) -> list[Link]:
    found = [Link(f"{folder.name}/{name}", name) for name in FILES if (folder / name).is_file()]
    figures = sorted((folder / "figures").glob("*.svg")) if (folder / "figures").is_dir() else []
    return found + [
        Link(f"{folder.name}/figures/{path.name}", path.name.replace("_", " ")) for path in figures
    ]


def _provenance(study: xr.Dataset) -> dict[str, str]:
    known = ("source", "source_revision", "versions", "machine", "cores", "platform")
    return {name: str(study.attrs[name]) for name in known if name in study.attrs}
