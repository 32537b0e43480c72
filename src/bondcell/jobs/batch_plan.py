"""What is left to compute of a scene, cut into jobs of a useful size by an explicit cost model."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from math import ceil
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from bondcell.by_geometry import geometry_groups
from bondcell.cell import Cell
from bondcell.jobs.batch import Batch
from bondcell.jobs.cell_points import cell_at
from bondcell.jobs.manifest import Entry
from bondcell.jobs.point_hash import Hashes, HashIndex, point_hashes
from bondcell.jobs.rows import ANALYTIC, REFERENCE, RELAXING_MODELS, Row, wanted_rows
from bondcell.scenes.points import scene_cell

if TYPE_CHECKING:
    from bondcell.scenes.scene import Scene

JOB_SECONDS = 40.0
"""Work a job should have at most: far more than the second or two that its start costs."""

MOST_JOBS = 100
"""Jobs for the new points of a row at most: beyond, jobs grow."""

WORTH_A_JOB = 3.0
"""Analytic work below this is done where the scene is collected: no job of its own [s]."""

SECONDS_PER_FORMULA = 2e-7
"""Cost of a formula at a point [s]."""

SECONDS_PER_POINT = {"cementation": 2e-5, "surrogate": 1.5e-5, "film": 3e-4, "bounds": 1.5e-3}
"""Cost of the models that are more than a formula, at a point [s]."""

SECONDS_PER_MODEL_GEOMETRY = {"film": 4e-3, "bounds": 0.15}
"""What some of them cost at every other geometry besides [s]."""

LARGEST_ANALYTIC_BATCH = 500_000
"""Points of an analytic batch at most: bounds the memory of its job."""

SECONDS_PER_GEOMETRY = 0.5
"""Cost of meshing and assembling the finite element ladder of one geometry [s]."""

SECONDS_PER_STATE = 0.015
"""Cost of solving the ladder at one set of moduli of an assembled geometry [s]."""

SOFT_RATIO, SECONDS_PER_SOFT_STATE = 1e-2, 0.4
"""Modulus ratio of particles to matrix below which a state costs more, and how much more [s]."""

LARGEST_REFERENCE_BATCH = 50_000
"""Points of one geometry that are kept together: bounds the memory of its job."""

SECONDS_PER_RELAXING_MODEL = 0.02
"""Cost of one series of one model under one convention [s], some more of each point."""

SECONDS_PER_RELAXING_STATE = 0.4
"""Cost of the reference's reduced model of one point and convention [s]."""

Positions = NDArray[np.int64]


@dataclass(frozen=True)
class Plan:
    """Batches of a scene: those that are known and needed, and new ones.

    Parameters
    ----------
    needed
        Names of all batches that hold points of the scene, the new ones among them.
    new
        Batches that the manifest does not have.
    """

    needed: list[str] = field(default_factory=list)
    new: list[Batch] = field(default_factory=list)

    def names(self, kind: str) -> list[str]:
        """Names of the needed batches whose methods begin with a word."""
        return [name for name in self.needed if name.split("_")[0] == kind]


def plan(
    scene: Scene, known: Sequence[Entry] = (), is_there: Callable[[str], bool] = lambda _: False
) -> Plan:
    """The batches of a scene's points; only points that no batch has make new ones.

    Parameters
    ----------
    scene
        A checked scene.
    known
        Its manifest.
    is_there
        Whether the file of a batch is there and whole. A batch that is still to be computed counts
        only if every row and point of it is wanted.

    Returns
    -------
    Plan
        The same for the same scene, manifest and files. Without a reference there is no finite
        element batch; analytic points make a batch only where there is enough to do.
    """
    rows = wanted_rows(scene)
    if not rows:
        return Plan()
    cell = scene_cell(scene)
    hashes = point_hashes(cell)
    coverage = _Coverage(rows, hashes)
    coverage.add_all(known, is_there)
    new = [
        Batch(group, cell_at(cell, positions))
        for group, left in coverage.missing()
        for positions in _cut(scene, group, cell, left)
    ]
    needed = coverage.owners + [batch.name for batch in new]
    found = {entry.name for entry in known}
    return Plan(sorted(dict.fromkeys(needed)), [batch for batch in new if batch.name not in found])


class _Coverage:
    """Which points of which rows some batch has."""

    def __init__(self, rows: Sequence[Row], hashes: Hashes) -> None:
        self._index = HashIndex(hashes)
        is_first = self._index.find(hashes) == np.arange(len(hashes))
        self._left = {row: is_first.copy() for row in rows}  # a point that comes twice counts once
        self.owners: list[str] = []

    def add_all(self, known: Sequence[Entry], is_there: Callable[[str], bool]) -> None:
        """Take what is there, then what is planned already and overlaps with nothing."""
        planned = []
        for entry in known:
            rows = [row for row in entry.rows if row in self._left]
            at = self._index.find(entry.hashes) if rows else np.empty(0, dtype=np.int64)
            inside = at[at >= 0]
            if not any(self._left[row][inside].any() for row in rows):
                continue
            if is_there(entry.name):
                self._take(entry, rows, inside)
            elif len(rows) == len(entry.rows) and inside.size == at.size:
                planned.append((entry, rows, inside))
        for entry, rows, inside in planned:
            if all(self._left[row][inside].all() for row in rows):
                self._take(entry, rows, inside)

    def missing(self) -> Iterator[tuple[tuple[Row, ...], Positions]]:
        """Rows that go together, and the points that they lack."""
        groups: dict[tuple[str, bytes], list[Row]] = {}
        for row, left in self._left.items():
            if left.any():
                groups.setdefault((row.file_prefix, left.tobytes()), []).append(row)
        for rows in groups.values():
            yield tuple(rows), np.flatnonzero(self._left[rows[0]])

    def _take(self, entry: Entry, rows: Iterable[Row], at: Positions) -> None:
        for row in rows:
            self._left[row][at] = False
        self.owners.append(entry.name)


def _cut(
    scene: Scene, rows: tuple[Row, ...], cell: Cell, positions: Positions
) -> Iterator[Positions]:
    """Shares of the points, each a batch; strided, so that costly corners are spread."""
    kind = rows[0].kind
    models = [row.model for row in rows]
    if kind == ANALYTIC and not any(model in SECONDS_PER_MODEL_GEOMETRY for model in models):
        yield from analytic_parts(positions[:, None], models)
        return
    geometries = [positions[group] for group in geometry_groups(cell_at(cell, positions))]
    if kind == ANALYTIC:
        yield from analytic_parts(geometries, models)
        return
    if kind == REFERENCE:
        yield from reference_parts(geometries, _soft(cell_at(cell, positions)))
    else:
        yield from _parts(geometries, _relaxing_seconds(scene, rows, positions.size))


def analytic_parts(
    pieces: Sequence[Positions] | Positions, models: Sequence[str]
) -> list[Positions]:
    """Shares of analytic points; none where the models are quicker than a job starts.

    Parameters
    ----------
    pieces
        Positions of the points of each geometry; where no model gains from a common geometry,
        each point alone, shape (points, 1).
    models
        Names of the models.

    Examples
    --------
    >>> points = np.arange(1_000_000)[:, None]
    >>> analytic_parts(points[:1000], ["fsi", "surrogate"])
    []
    >>> [part.size for part in analytic_parts(points, ["fsi", "surrogate"])]
    [500000, 500000]
    """
    points = _joined(pieces).size
    seconds = points * sum(SECONDS_PER_POINT.get(name, SECONDS_PER_FORMULA) for name in models)
    seconds += len(pieces) * sum(SECONDS_PER_MODEL_GEOMETRY.get(name, 0.0) for name in models)
    most = ceil(points / LARGEST_ANALYTIC_BATCH)
    if seconds < WORTH_A_JOB and most == 1:
        return []
    parts = max(most, min(len(pieces), MOST_JOBS, ceil(seconds / JOB_SECONDS)))
    return [_joined(pieces[part::parts]) for part in range(parts)]


def _joined(pieces: Sequence[Positions] | Positions) -> Positions:
    """All positions of some pieces, ascending."""
    whole = pieces.ravel() if isinstance(pieces, np.ndarray) else np.concatenate(pieces)
    return np.sort(whole)


def _soft(cell: Cell) -> int:
    """Points whose particles are so soft that the reference has to follow a cusp far."""
    softest = np.minimum(cell.young_i, cell.young_j) / cell.young_m
    return int((softest < SOFT_RATIO).sum())


def reference_parts(geometries: Sequence[Positions], soft: int = 0) -> list[Positions]:
    """Shares of finite element points, those of a geometry together unless they are very many.

    Parameters
    ----------
    geometries
        Positions of the points of each geometry.
    soft
        How many of all these points have particles far softer than the matrix.

    Examples
    --------
    >>> parts = reference_parts([np.arange(50) + 50 * geometry for geometry in range(40)])
    >>> [part.size for part in parts]
    [1000, 1000]
    >>> len(reference_parts([np.arange(50) + 50 * k for k in range(40)], soft=500))
    7
    """
    pieces = [
        geometry[start : start + LARGEST_REFERENCE_BATCH]
        for geometry in geometries
        for start in range(0, geometry.size, LARGEST_REFERENCE_BATCH)
    ]
    states = sum(geometry.size for geometry in geometries)
    seconds = len(pieces) * SECONDS_PER_GEOMETRY + states * SECONDS_PER_STATE
    seconds += soft * SECONDS_PER_SOFT_STATE
    return list(_parts(pieces, seconds))


def _parts(pieces: Sequence[Positions], seconds: float) -> Iterator[Positions]:
    parts = max(1, min(len(pieces), MOST_JOBS, ceil(seconds / JOB_SECONDS)))
    for part in range(parts):
        yield _joined(pieces[part::parts])


def _relaxing_seconds(scene: Scene, rows: tuple[Row, ...], points: int) -> float:
    """Cost of relaxation at points; checks come on top."""
    block = scene.prony
    assert block is not None
    if rows[0].kind == RELAXING_MODELS:
        series = len(block.cases()) * len(block.conventions)
        seconds = len(rows) * SECONDS_PER_RELAXING_MODEL * series * (1 + points / 50)
    else:
        ends = len({round(case.relaxing_share, 12) for case in block.cases()})
        seconds = points * ends * len(block.conventions) * SECONDS_PER_RELAXING_STATE
    return seconds * (1 + block.checks / 10)
