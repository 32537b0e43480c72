"""What must hold between the keys of a design, and in its table."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from bondcell.errors import Violation
from bondcell.scenes.design import PARAMETERS, Design
from bondcell.scenes.keys import KeyPath
from bondcell.scenes.ranges import MOST_POINTS
from bondcell.scenes.table_files import read_table

if TYPE_CHECKING:
    from bondcell.scenes.scene import Scene


def read_design(design: Design | None, folder: Path | None) -> list[Violation]:
    """Give a design the values of its table.

    Parameters
    ----------
    design
        The block of a scene, None for a scene without.
    folder
        Where the table is, None for nowhere.

    Returns
    -------
    list of Violation
        Everything that is wrong with the table.
    """
    if design is None or design.table is None:
        return []
    if folder is None:
        return [Violation("design.table", design.table, "a file beside the scene's file")]
    values, violations = read_table(folder, design.table, PARAMETERS, MOST_POINTS)
    design.set_values({} if violations else values)
    return [replace(found, field=f"design.table {found.field}") for found in violations]


def design_violations(scene: Scene, bad: Collection[KeyPath]) -> Iterator[Violation]:
    """What a design lacks, and what it cannot stand beside.

    Parameters
    ----------
    scene
        A scene, possibly without its wrong parts.
    bad
        Paths of these parts.
    """
    design = scene.design
    if design is None:
        return
    if design.table is not None:
        for name in ("kind", "points", "seed", "ranges"):
            if name in design.model_fields_set:
                value = str(getattr(design, name))[:60]
                yield Violation(f"design.{name}", value, "left out beside a table")
    else:
        known_bad = {str(path[1]) for path in bad if path[0] == "design" and len(path) > 1}
        if "table" not in known_bad:
            yield from _sampled_violations(design, known_bad)
    for name in ("atlas", "prony", "specimen"):
        if getattr(scene, name):
            yield Violation("design", f"beside {name}", f"left out: {name} needs a sweep alone")


def _sampled_violations(design: Design, bad: Collection[str]) -> Iterator[Violation]:
    needs = {
        "kind": "sobol or latin_hypercube (or a table instead)",
        "points": "the number of points",
        "ranges": "at least one parameter with {start, stop, spacing}",
    }
    for name, allowed in needs.items():
        given = design.spans() if name == "ranges" else getattr(design, name)
        if not given and name not in bad:
            yield Violation(f"design.{name}", None, allowed)
    if design.kind == "sobol" and len(design.points) > 1:
        allowed = "one number: more points of a sequence keep the first ones"
        yield Violation("design.points", list(design.points), allowed)
