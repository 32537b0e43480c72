"""What a scene took: points, solutions, seconds, and when its file was written."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import xarray as xr

from bondcell.report.tables import Table
from bondcell.wording import number, quantity

if TYPE_CHECKING:
    from bondcell.report.sections import Section


@dataclass(frozen=True)
class Cost:
    """Values in a file, the seconds they took together, the file's size and time."""

    values: int = 0
    seconds: float = float("nan")
    size: int = 0
    written: datetime | None = None


def scene_cost(loads: Mapping[str, xr.Dataset], file: Path) -> Cost:
    """Read off a scene's results.

    Parameters
    ----------
    loads
        Load -> result.
    file
        The file they came from.
    """
    values, seconds = 0, 0.0
    for study in loads.values():
        for name in ("stiffness", "energy", "relaxation"):
            if name in study:
                values += int(np.isfinite(study[name].values).sum())
        if "seconds" in study:
            seconds += float(np.nansum(study["seconds"].values))
    stat = file.stat()
    when = datetime.fromtimestamp(stat.st_mtime, UTC)
    return Cost(values, seconds if seconds else float("nan"), stat.st_size, when)


def cost_lines(sections: Iterable[Section]) -> Table:
    """The scenes of the page with what they took."""
    lines = []
    for section in sections:
        cost = section.cost
        lines.append(
            [
                section.title,
                number(cost.values, 8),
                quantity(cost.seconds, "s", 3),
                f"{number(cost.size / 1e3, 3)} kB",
                cost.written.strftime("%Y-%m-%d %H:%M UTC") if cost.written else "–",
                section.provenance.get("source_revision", "–"),
            ]
        )
    header = ["scene", "values", "time of its points", "study.nc", "written", "revision"]
    caption = (
        "What each scene took. Time of its points: the wall times of all values together, without "
        "planning, start of interpreters and ladders of convergence studies."
    )
    return Table(caption, header, lines)
