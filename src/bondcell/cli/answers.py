"""One model's stiffness of one bond cell, without labels: what the command line prints."""

from __future__ import annotations

import math
import time
from collections.abc import Mapping
from dataclasses import dataclass, field
from statistics import median
from typing import Any

from bondcell.cell import Cell
from bondcell.models import MODELS
from bondcell.models.asked import ask
from bondcell.models.model import Model
from bondcell.outputs import WAYS
from bondcell.status import Status

REPEATS = 5
"""Timed evaluations of an analytic model, of which the median is told."""

INTERPOLATED = "to the finite elements"
"""What the estimate of a model that interpolates the reference is about: its whole error."""


@dataclass(frozen=True)
class Answer:
    """What a model says about one cell.

    Parameters
    ----------
    model
        Name in ``bondcell.MODELS``.
    stiffness
        Stiffness [N/m; N m/rad for torsion and bending], NaN without a value.
    error_estimate
        Relative numerical error of that value.
    error_kind
        What the estimate is made from.
    status
        What became of it.
    seconds
        Wall time [s].
    dof
        Unknowns, 0 for a closed form.
    parts
        The model's own springs.
    order, way
        Polynomial order of the finest solve and how it was done; 0 and nothing for a closed form.
    coupling
        Force across the axis for a unit rotation of end plane j, of the reference under bending
        [N/rad]; else NaN.
    """

    model: str
    stiffness: float
    error_estimate: float
    error_kind: str
    status: Status
    seconds: float
    dof: int = 0
    parts: Mapping[str, float] = field(default_factory=dict)
    order: int = 0
    way: str = ""
    coupling: float = math.nan


def answer(cell: Cell, name: str, load: str, options: Mapping[str, Any]) -> Answer:
    """Ask one model.

    Parameters
    ----------
    cell
        A single cell.
    name
        Name in ``bondcell.MODELS``.
    load
        One of the model's loads.
    options
        ``bc`` and ``tolerance`` of the reference; analytic models take none.
    """
    model = MODELS[name]
    return _solved(cell, name, load, options) if model.is_reference else _closed(cell, model, load)


def _solved(cell: Cell, name: str, load: str, options: Mapping[str, Any]) -> Answer:
    from bondcell.by_geometry import solve_points
    from bondcell.fem.reference import solve

    found = solve_points(cell.ravel(), solve, load=load, **options)
    return Answer(
        model=name,
        stiffness=float(found.stiffness[0]),
        error_estimate=float(found.error_estimate[0]),
        error_kind="discretisation, from the orders p",
        status=Status(int(found.status[0])),
        seconds=float(found.seconds[0]),
        dof=int(found.dof[0]),
        order=int(found.detail("order")[0]),
        way=WAYS[int(found.detail("way")[0])],
        coupling=float(found.detail("coupling")[0]),
    )


def _closed(cell: Cell, model: Model, load: str) -> Answer:
    seconds = []
    for _ in range(REPEATS):
        start = time.perf_counter()
        springs, status = ask(model, load, cell)
        seconds.append(time.perf_counter() - start)
    return Answer(
        model=model.name,
        stiffness=float(springs.stiffness),
        error_estimate=float(springs.relative_error),
        error_kind=INTERPOLATED if model.from_reference else "evaluation of the formula",
        status=Status(int(status)),
        seconds=median(seconds),
        parts={name: float(part) for name, part in springs.parts.items()},
    )
