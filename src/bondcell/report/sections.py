"""The parts of the page: one section for each scene that has results."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING

import xarray as xr

from bondcell.report.atlas_part import atlas_part
from bondcell.report.convergence_part import convergence_findings, convergence_lines
from bondcell.report.figure_files import EmbeddedFigure, embedded_figures
from bondcell.report.findings import Finding
from bondcell.report.relaxation_part import (
    read_relaxing,
    relaxation_findings,
    relaxation_lines,
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
from bondcell.specimen.view import read_specimen
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


@dataclass(frozen=True)
class Link:
    """A file beside the page."""

    address: str
    text: str


@dataclass(frozen=True)
class Section:
    """What the page says about a scene."""

    name: str
    title: str
    question: str
    setup: list[Line]
    findings: list[Finding]
    figures: list[EmbeddedFigure]
    tables: list[Table]
    links: list[Link]
    models: list[str]
    provenance: dict[str, str] = field(default_factory=dict)


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
    if not (folder / "study.nc").is_file():
        return None
    loads = read_loads(folder / "study.nc")
    study = next(iter(loads.values()))
    ladders = None
    if scene.convergence is not None:
        ladders = read_dataset(folder / "study.nc", group="convergence")
    findings: list[Finding] = []
    tables: list[Table | None] = []
    if scene.stability:
        points = stability_table(loads)
        findings += stability_findings(points, study)
        tables += stability_lines(points, study)
    if scene.atlas:
        said, shown = atlas_part(loads)
        findings += said
        tables += shown
    elif scene.prony is not None:
        relaxing = read_relaxing(folder, loads, with_methods=scene.prony.methods is not None)
        findings += relaxation_findings(relaxing)
        tables += relaxation_lines(relaxing)
    elif scene.specimen is not None:
        said, shown = specimen_part(read_specimen(folder / "study.nc"))
        findings += said
        tables += shown
    elif scene.models or not scene.stability:
        for load, found in loads.items():
            table = accuracy_table(found)
            findings += _under(load, sweep_findings(found, table), several=len(loads) > 1)
            tables += [accuracy_lines(found, table), influence_lines(found), value_lines(found)]
    if ladders is not None:
        findings = [*convergence_findings(ladders), *findings]
        tables = [*convergence_lines(ladders), *tables]
    return Section(
        name=scene.name,
        title=scene.title,
        question=scene.question or "",
        setup=setup_lines(scene),
        findings=findings,
        figures=embedded_figures(folder / "figures"),
        tables=[table for table in tables if table is not None],
        links=_links(folder),
        models=list(dict.fromkeys(name for found in loads.values() for name in model_names(found))),
        provenance=_provenance(study),
    )


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
