"""The reference's stiffness as a sum of springs in one modulus of the matrix, particles fixed.

For elastic particles, and a matrix whose bulk modulus or whose Poisson's ratio stays, the
discrete stiffness is ``K = K_0 + c x + sum m x/(1 + a x)`` in the share x of the relaxing modulus,
all terms positive: the eigenvalues of a pencil with thousands of terms, of which few count. They
are found from solutions at few moduli (`positive_fit`), chosen until others are met.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import lru_cache

import numpy as np

from bondcell.cell import Cell, FloatArray
from bondcell.fem.cell_mesh import Geometry
from bondcell.fem.materials import Materials
from bondcell.fem.reference import solve as solve_reference
from bondcell.fem.structured import CellSolver, find_load, geometry_of
from bondcell.fem.threads import one_thread
from bondcell.prony.bank import Bank
from bondcell.prony.chain import Chain, decade_below
from bondcell.prony.conventions import Relaxing
from bondcell.prony.positive_fit import PositiveFit, positive_fit
from bondcell.status import Status

FIRST, MORE, ROUNDS = 9, 3, 7
"""Moduli solved at first, added in each round, and rounds at most."""

REDUCTION = 1e-10
"""Relative error that the reduction may leave at moduli it has not seen."""

REACH = 3.0
"""Moduli are sampled up to this factor beyond the range of relaxation."""

FLAT = 1e-2
"""A film of a gap g is linear in x below this times g/R: no modulus below is needed."""

TIME_FACTOR = 10.0
"""Error of K(t) over that in the modulus, tests/verification/test_time_stepping.py."""


_NOTHING = Chain(np.asarray(np.nan), np.empty(0), np.empty(0))


@dataclass(frozen=True)
class RelaxingReference:
    """Series of one bond by finite elements.

    Parameters
    ----------
    series
        A single chain [N/m; N m/rad].
    error_estimate, reduction_error
        Relative, of K at any time; the second is part of the first.
    status
        Flag, see `bondcell.status.Status`.
    order, dof
        Of the discretisation.
    seconds
        Wall time [s].
    """

    series: Chain
    error_estimate: float
    reduction_error: float
    status: Status
    order: int
    dof: int
    seconds: float


@one_thread()
def relax(
    matrix: Relaxing, load: str = "normal", bc: str = "roller", tolerance: float = 1e-6
) -> RelaxingReference:
    """Exact series of one cell's reduced model.

    Parameters
    ----------
    matrix
        One cell and how its matrix relaxes, with ``constant_bulk`` or ``constant_poisson``.
    load, bc, tolerance
        See `reference.solve`; the discretisation is the one that meets a third of the tolerance at
        both ends.
    """
    started = time.perf_counter()
    end = decade_below(float(matrix.prony.shear.equilibrium))
    state = np.concatenate([*matrix.cell.as_dict().values()]).tobytes()
    reduced = _reduced(_Asked(state, matrix.convention, end, load, bc, tolerance, matrix))
    known = reduced.fit is not None
    series = _series(reduced.fit, matrix) if reduced.fit is not None else _NOTHING
    return RelaxingReference(
        series=series,
        error_estimate=reduced.discretisation + reduced.reduction if known else np.nan,
        reduction_error=reduced.reduction,
        status=reduced.status,
        order=reduced.order,
        dof=reduced.dof,
        seconds=time.perf_counter() - started,
    )


@dataclass(frozen=True)
class _Asked:
    """What a reduced model depends on: of the series only its end, not its terms."""

    state: bytes
    convention: str
    end: float
    load: str
    bc: str
    tolerance: float
    matrix: Relaxing = field(compare=False, repr=False)


@dataclass(frozen=True)
class _Reduced:
    """The stiffness in the relaxing modulus, None without a value."""

    fit: PositiveFit | None
    discretisation: float
    reduction: float
    status: Status
    order: int
    dof: int


@lru_cache(maxsize=16)
def _reduced(asked: _Asked) -> _Reduced:
    matrix, end, load, bc = asked.matrix, asked.end, asked.load, asked.bc
    lowest = max(end / REACH, FLAT * _gap_ratio(matrix.cell))
    states = _stacked(matrix.at(1.0), matrix.at(max(end, lowest)))
    ends = solve_reference(states, load=load, bc=bc, tolerance=max(asked.tolerance / 3, 1e-12))
    if not np.isfinite(ends.stiffness).all():
        worst = Status(int(ends.status[~np.isfinite(ends.stiffness)].max()))
        return _Reduced(None, np.nan, np.nan, worst, 0, 0)
    order = int(ends.order.max())
    solver = _solver(geometry_of(matrix.cell), load, bc, _is_half(matrix.cell), order)

    def stiffness(share: float) -> float:
        return solver.stiffness(Materials.of(matrix.at(share)).constants(0))

    fit, missed = _fit(stiffness, lowest, _carries_pressure(matrix, load, bc))
    known = np.array([1.0, max(end, lowest)])
    discretisation = float((ends.error_estimate + np.abs(fit(known) / ends.stiffness - 1)).max())
    reduction = TIME_FACTOR * missed
    good = discretisation + reduction <= asked.tolerance
    status = Status.ok if good else Status.tolerance_not_met
    return _Reduced(fit, discretisation, reduction, status, order, solver.dof)


def forget() -> None:
    """Give up the reduced models and solvers that are kept, for timings of a first call."""
    _reduced.cache_clear()
    _solver.cache_clear()


def _carries_pressure(matrix: Relaxing, load: str, bc: str) -> bool:
    """Whether a matrix without shear stiffness still bears load: a fluid that nothing lets out."""
    keeps_bulk = matrix.convention == "constant_bulk" or bool(matrix.cell.poisson_m[0] == 0.5)
    return (load, bc) == ("normal", "confined") and keeps_bulk


def _fit(
    stiffness: Callable[[float], float], lowest: float, has_constant: bool
) -> tuple[PositiveFit, float]:
    """The fit, and its largest relative error at moduli that it has not seen."""
    x = np.geomspace(lowest, REACH, FIRST)
    values = np.array([stiffness(float(share)) for share in x])
    for attempt in range(ROUNDS):
        fit = positive_fit(x, values, has_constant)
        fresh = _doubtful(fit, positive_fit(x[::2], values[::2], has_constant), x)
        found = np.array([stiffness(float(share)) for share in fresh])
        missed = float(np.abs(fit(fresh) / found - 1).max())
        if missed <= REDUCTION or attempt == ROUNDS - 1:
            break
        order = np.argsort(np.concatenate((x, fresh)))
        x = np.concatenate((x, fresh))[order]
        values = np.concatenate((values, found))[order]
    return fit, max(missed, fit.error, REDUCTION)


def _doubtful(fit: PositiveFit, other: PositiveFit, x: FloatArray) -> FloatArray:
    """Moduli between the known ones where fits of all and of half of the values differ most."""
    between = np.sqrt(x[:-1] * x[1:])
    differ = np.abs(fit(between) / other(between) - 1)
    return np.asarray(between[np.sort(np.argsort(-differ, kind="stable")[:MORE])])


def _series(fit: PositiveFit, matrix: Relaxing) -> Chain:
    strength, softness = np.append(fit.strength, fit.bare), np.append(fit.softness, 0.0)
    bank = Bank(strength[None], softness[None], np.array([fit.constant]))
    series = bank.relaxation(matrix.prony.shear, np.ones(1), np.zeros(1))
    return Chain(series.equilibrium[0], series.strengths[0], series.times[0])


@lru_cache(maxsize=4)
def _solver(geometry: Geometry, load: str, bc: str, half: bool, order: int) -> CellSolver:
    return CellSolver(geometry, find_load(load, bc), half, order)


def _is_half(cell: Cell) -> bool:
    return bool(geometry_of(cell).is_mirrored and Materials.of(cell).is_mirrored[0])


def _gap_ratio(cell: Cell) -> float:
    return float(min(1.0, (cell.gap / np.maximum(cell.radius_i, cell.radius_j))[0]))


def _stacked(one: Cell, other: Cell) -> Cell:
    pairs = one.as_dict(), other.as_dict()
    values: dict[str, FloatArray] = {
        name: np.concatenate((pairs[0][name], pairs[1][name])) for name in pairs[0]
    }
    return Cell(**values)
