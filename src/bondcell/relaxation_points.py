"""Series of all points of a study and what became of each, by any model."""

from __future__ import annotations

import time as clock
import warnings
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from bondcell.by_geometry import check_options, geometry_groups
from bondcell.cell import Cell, FloatArray
from bondcell.errors import InputError, MissingLibrary
from bondcell.models.asked import ask
from bondcell.models.model import Model
from bondcell.prony.bond_series import bond_series
from bondcell.prony.chain import Chain
from bondcell.prony.conventions import Relaxing
from bondcell.reference_options import DEFAULT_TOLERANCE
from bondcell.status import Status

if TYPE_CHECKING:
    from bondcell.fem.relaxing_reference import RelaxingReference


@dataclass(frozen=True)
class Answer:
    """Series of all points and what is known of them, arrays of shape (points,)."""

    series: Chain
    error: FloatArray
    status: NDArray[np.int8]
    dof: NDArray[np.int64]
    seconds: FloatArray


@dataclass(frozen=True)
class Question:
    """A study with its matrix relaxing."""

    study: xr.Dataset
    model: Model
    load: str
    options: dict[str, Any]
    matrix: Relaxing
    shape: tuple[int, ...]
    dims: tuple[str, ...]

    @property
    def coords(self) -> dict[Any, Any]:
        """Coordinates of the study that belong to the result."""
        own = set(self.dims)
        return {n: c for n, c in self.study.coords.items() if set(c.dims) <= own}

    @property
    def attributes(self) -> dict[str, Any]:
        """Attributes of every result."""
        return {
            "model": self.model.name,
            "load": self.load,
            "convention": self.matrix.convention,
            "relative_to": self.matrix.prony.relative_to,
            **self.options,
        }


def solve(question: Question) -> Answer:
    """The series of every point, by the formula or by the reference."""
    if question.model.is_reference:
        return _solve_reference(question)
    started = clock.perf_counter()
    matrix, count = question.matrix, question.matrix.cell.radius_i.size
    series, error = bond_series(question.model, question.load, matrix, **question.options)
    springs, status = ask(question.model, question.load, matrix.cell, **question.options)
    known = np.isfinite(series.instantaneous)
    missing = ~known & (status < Status.limit_exceeded)
    status = np.where(missing, Status.not_computed, status).astype(np.int8)
    error = np.where(known, np.maximum(error, 0) + springs.relative_error, np.nan)
    seconds = np.full(count, (clock.perf_counter() - started) / count)
    return Answer(series, error, status, np.zeros(count, dtype=np.int64), seconds)


def states(question: Question, points: FloatArray) -> list[Cell | None]:
    """The cells at each time, as far as a valid range may depend on it."""
    if question.model.is_reference:
        return [None] * points.size
    return [*question.matrix.states(points)]


def flags(question: Question, answer: Answer, state: Cell | None) -> NDArray[np.int8]:
    """Flags of all points when the matrix is in a state: as it relaxes a model's range may end."""
    if state is None:
        return answer.status
    outside = ~np.broadcast_to(question.model.is_valid(state), answer.status.shape)
    own = np.where(outside, Status.outside_valid_range, Status.ok)
    free = answer.status <= Status.outside_valid_range
    return np.where(free, own, answer.status).astype(np.int8)


def flags_for_all_times(question: Question, answer: Answer) -> NDArray[np.int8]:
    """Flags that hold for all times: the worse of the first and the last."""
    ends = states(question, np.array([0.0, np.inf]))
    return np.max([flags(question, answer, state) for state in ends], axis=0)


def _solve_reference(question: Question) -> Answer:
    """Point by point, geometry by geometry, so that neighbours share their operators."""
    from bondcell.fem.relaxing_reference import relax

    matrix = question.matrix
    bc = question.options.get("bc", "roller")
    tolerance = question.options.get("tolerance", DEFAULT_TOLERANCE)
    check_options(question.load, question.options)
    answers: list[RelaxingReference | None] = [None] * matrix.cell.radius_i.size
    for group in geometry_groups(matrix.cell):
        for point in group.tolist():
            own = Relaxing(matrix.prony, matrix.convention, matrix.cell.take([point]))
            try:
                answers[point] = relax(own, question.load, bc, tolerance)
            except (InputError, MissingLibrary):
                raise
            except Exception as error:  # one point must not lose the sweep
                line = f"solver_failed: point {point}: {type(error).__name__}: {error}"
                warnings.warn(line, RuntimeWarning, stacklevel=4)
    return _collected(answers)


def _collected(answers: list[RelaxingReference | None]) -> Answer:
    count = len(answers)
    width = max((answer.series.count for answer in answers if answer), default=0)
    result = Answer(
        Chain(np.full(count, np.nan), np.zeros((count, width)), np.ones((count, width))),
        np.full(count, np.nan),
        np.full(count, Status.solver_failed, dtype=np.int8),
        np.zeros(count, dtype=np.int64),
        np.full(count, np.nan),
    )
    for point, answer in enumerate(answers):
        if answer is None:
            continue
        own = answer.series
        result.series.equilibrium[point] = own.equilibrium
        result.series.strengths[point, : own.count] = own.strengths
        result.series.times[point, : own.count] = own.times
        result.error[point], result.status[point] = answer.error_estimate, answer.status
        result.dof[point], result.seconds[point] = answer.dof, answer.seconds
    return result
