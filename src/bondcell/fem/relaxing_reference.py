"""Series of one bond cell by finite elements: an exact one of a reduced model, error and flag."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import lru_cache

import numpy as np

from bondcell.cell import Cell, FloatArray
from bondcell.fem.cell_mesh import Geometry
from bondcell.fem.condensed_system import without_insides
from bondcell.fem.full_system import full_systems
from bondcell.fem.materials import Materials
from bondcell.fem.one_modulus import REACH, reduce_one
from bondcell.fem.reference import Reference
from bondcell.fem.reference import solve as solve_reference
from bondcell.fem.structured import CellSolver, find_load, geometry_of
from bondcell.fem.threads import one_thread
from bondcell.fem.two_moduli import laplace_path, reduce_two, shares
from bondcell.prony.chain import Chain, decade_below
from bondcell.prony.conventions import Relaxing
from bondcell.status import Status

REDUCTION = 1e-10
"""Relative error that the reduction may leave at states it has not seen."""

FLAT = 1e-2
"""A film of a gap g is linear in x below this times g/R: no modulus below is needed."""

TIME_FACTOR = 10.0
"""Error of K(t) over that in the modulus, tests/verification/test_time_stepping.py."""

LOOKED_AT = 40
"""Laplace variables among which the states of the discretisation's estimate are chosen."""

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
        One cell and how its matrix relaxes.
    load, bc, tolerance
        See `reference.solve`; the discretisation is the one that meets a third of the tolerance at
        both ends of relaxation.
    """
    started = time.perf_counter()
    reduced = (_of_two if matrix.prony.bulk is not None else _of_one)(matrix, load, bc, tolerance)
    known = reduced.series is not None
    good = known and reduced.discretisation + reduced.reduction <= tolerance
    flag = Status.ok if good else Status.tolerance_not_met
    return RelaxingReference(
        series=reduced.series(matrix) if reduced.series is not None else _NOTHING,
        error_estimate=reduced.discretisation + reduced.reduction if known else np.nan,
        reduction_error=reduced.reduction,
        status=flag if known else reduced.status,
        order=reduced.order,
        dof=reduced.dof,
        seconds=time.perf_counter() - started,
    )


@dataclass(frozen=True)
class _Reduced:
    """A reduced model: its series for a matrix, None without a value, and its errors."""

    series: Callable[[Relaxing], Chain] | None
    discretisation: float = np.nan
    reduction: float = np.nan
    status: Status = Status.ok
    order: int = 0
    dof: int = 0


def _of_one(matrix: Relaxing, load: str, bc: str, tolerance: float) -> _Reduced:
    """One modulus relaxes: the model serves every series that ends in the same decade."""
    end = decade_below(float(matrix.prony.shear.equilibrium))
    state = np.concatenate([*matrix.cell.as_dict().values()]).tobytes()
    return _reduced(_Asked(state, matrix.convention, end, load, bc, tolerance, matrix))


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


@lru_cache(maxsize=16)
def _reduced(asked: _Asked) -> _Reduced:
    matrix, load, bc = asked.matrix, asked.load, asked.bc
    lowest = max(asked.end / REACH, FLAT * _gap_ratio(matrix.cell))
    known = np.array([1.0, max(asked.end, lowest)])
    ends = _solved([matrix.at(float(x)) for x in known], load, bc, asked.tolerance)
    if not np.isfinite(ends.stiffness).all():
        return _without_value(ends)
    order = int(ends.order.max())
    solver = _solver(geometry_of(matrix.cell), load, bc, _is_half(matrix.cell), order)

    def stiffness(share: float) -> float:
        return solver.stiffness(Materials.of(matrix.at(share)).constants(0))

    model = reduce_one(stiffness, lowest, _carries_pressure(matrix, load, bc), REDUCTION)
    return _Reduced(
        series=lambda own: model.series(own.prony.shear),
        discretisation=_discretisation(ends, model.stiffness(known)),
        reduction=TIME_FACTOR * model.missed,
        order=order,
        dof=solver.dof,
    )


def _of_two(matrix: Relaxing, load: str, bc: str, tolerance: float) -> _Reduced:
    """Shear and bulk modulus relax by a series each."""
    lowest = FLAT * _gap_ratio(matrix.cell)
    slow, fast = laplace_path(matrix, lowest)
    s = np.append(np.geomspace(slow, fast, LOOKED_AT), np.inf)
    x, y = shares(matrix, s)
    # Both ends, and the states where the matrix is least and most compressible.
    chosen = np.unique([0, s.size - 1, (x / y).argmin(), (x / y).argmax()])
    x, y = x[chosen], y[chosen]
    cells = [matrix.at(float(g), float(k)) for g, k in zip(x, y, strict=True)]
    ends = _solved(cells, load, bc, tolerance)
    if not np.isfinite(ends.stiffness).all():
        return _without_value(ends)
    order = int(ends.order.max())
    systems = full_systems(matrix.cell, order, load, bc)
    bears = _carries_pressure(matrix, load, bc)
    matrices = tuple(without_insides(system) for system in systems)
    model = reduce_two(matrix, matrices, lowest, bears, REDUCTION)
    return _Reduced(
        series=model.series,
        discretisation=_discretisation(ends, model.stiffness(x, y)),
        reduction=TIME_FACTOR * max(model.missed, REDUCTION),
        order=order,
        dof=sum(int(system.free.sum()) for system in systems),
    )


def _solved(cells: list[Cell], load: str, bc: str, tolerance: float) -> Reference:
    """The elastic reference of some states."""
    return solve_reference(_stacked(cells), load=load, bc=bc, tolerance=max(tolerance / 3, 1e-12))


def _without_value(ends: Reference) -> _Reduced:
    return _Reduced(None, status=Status(int(ends.status[~np.isfinite(ends.stiffness)].max())))


def _discretisation(ends: Reference, reduced: FloatArray) -> float:
    """Error of the elastic values, and what the reduced model differs from them."""
    return float((ends.error_estimate + np.abs(reduced / ends.stiffness - 1)).max())


def forget() -> None:
    """Give up the reduced models and solvers that are kept, for timings of a first call."""
    _reduced.cache_clear()
    _solver.cache_clear()


def _carries_pressure(matrix: Relaxing, load: str, bc: str) -> bool:
    """Whether a matrix without shear stiffness still bears load: a fluid that nothing lets out."""
    keeps_bulk = matrix.convention != "constant_poisson" or bool(matrix.cell.poisson_m[0] == 0.5)
    return (load, bc) == ("normal", "confined") and keeps_bulk


@lru_cache(maxsize=4)
def _solver(geometry: Geometry, load: str, bc: str, half: bool, order: int) -> CellSolver:
    return CellSolver(geometry, find_load(load, bc), half, order)


def _is_half(cell: Cell) -> bool:
    return bool(geometry_of(cell).is_mirrored and Materials.of(cell).is_mirrored[0])


def _gap_ratio(cell: Cell) -> float:
    return float(min(1.0, (cell.gap / np.maximum(cell.radius_i, cell.radius_j))[0]))


def _stacked(cells: list[Cell]) -> Cell:
    values = [cell.as_dict() for cell in cells]
    return Cell(**{name: np.concatenate([own[name] for own in values]) for name in values[0]})
