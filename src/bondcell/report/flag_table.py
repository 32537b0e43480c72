"""Flags that a scene's points carry, and what they mean."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import xarray as xr

from bondcell.report.tables import Table
from bondcell.results.stability import FLAGS
from bondcell.results.view import is_reference, model_names
from bondcell.status import Status
from bondcell.wording import model_name


def flag_lines(loads: Mapping[str, xr.Dataset]) -> Table | None:
    """Points of each model by flag, or None where every point is good.

    Parameters
    ----------
    loads
        Load -> result.
    """
    lines = []
    for load, study in loads.items():
        if "status" not in study:
            continue
        for name in model_names(study):
            values = study["status"].sel(model=name).values.astype(float)
            codes, counts = np.unique(values[np.isfinite(values)], return_counts=True)
            for code, count in zip(codes, counts, strict=True):
                flag = Status(int(code))
                if flag != Status.ok:
                    words = flag.name.replace("_", " ")
                    points = f"{count} of {values.size}"
                    lines.append([model_name(name), load, words, _meaning(name, flag), points])
    if not lines:
        return None
    caption = "Points with a flag, and what it means; the status of every point is in study.nc."
    return Table(caption, ["model", "load", "flag", "which means", "points"], lines, names=4)


def _meaning(name: str, flag: Status) -> str:
    if flag == Status.outside_valid_range and not is_reference(name):
        return "a value, but outside the range for which the model is made: see the models below"
    return FLAGS[flag]
