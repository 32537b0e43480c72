"""The finite element reference at many points: points that share a geometry share one assembly."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterator, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from bondcell.cell import GEOMETRY, Cell
from bondcell.errors import (
    BoundExceeded,
    InputError,
    MissingLibrary,
    PointLost,
    UnsupportedLoad,
    Violation,
)
from bondcell.outputs import PointResults, detail_names
from bondcell.reference_options import (
    BOUNDARY_CONDITIONS,
    DEFAULT_TOLERANCE,
    TOLERANCE_RANGE,
    TOLERANCES,
)
from bondcell.status import Status

if TYPE_CHECKING:
    from bondcell.fem.reference import Reference

IntArray = NDArray[np.int64]
Progress = Callable[[int, int], None]
Solver = Callable[..., "Reference"]

DEFAULT_CONDITION = BOUNDARY_CONDITIONS[0]
"""Boundary condition of the normal load when none is said."""


def geometry_groups(cell: Cell) -> Iterator[IntArray]:
    """Positions of the points that share a geometry, in order of first appearance.

    Parameters
    ----------
    cell
        A raveled cell (`Cell.ravel`).

    Examples
    --------
    >>> cell = Cell.from_values(
    ...     radius_i=1.0,
    ...     gap=[0.1, 0.2, 0.1],
    ...     young_i=1.0,
    ...     young_m=[1.0, 2.0, 3.0],
    ...     poisson_i=0.2,
    ...     poisson_m=0.3,
    ... )
    >>> [group.tolist() for group in geometry_groups(cell.ravel())]
    [[0, 2], [1]]
    """
    table = np.column_stack([getattr(cell, name) for name in GEOMETRY])
    _, first, inverse = np.unique(table, axis=0, return_index=True, return_inverse=True)
    order = np.argsort(inverse.ravel(), kind="stable")
    bounds = np.cumsum(np.bincount(inverse.ravel()))[:-1]
    groups = np.split(order, bounds)
    for position in np.argsort(first, kind="stable"):
        yield groups[position]


def solve_points(
    cell: Cell,
    solve: Solver,
    load: str = "normal",
    progress: Progress | None = None,
    **options: Any,
) -> PointResults:
    """Finite element stiffness at every point of a raveled cell, geometry by geometry.

    A geometry that raises costs its own points only: they become NaN with the flag
    ``solver_failed`` (``mesh_failed``, or ``limit_exceeded`` where it was bounded), a warning names
    it, the rest goes on.

    Parameters
    ----------
    cell
        A raveled cell.
    solve
        Solves points of one geometry: `bondcell.fem.reference.solve`.
    load
        Load name.
    progress
        Called as ``progress(points_done, points)`` after each geometry.
    **options
        ``bc`` (of the normal load) and ``tolerance`` of the solver.
    """
    check_options(load, options)
    points = cell.radius_i.size
    results = PointResults.empty(points)
    details = {name: results.detail(name) for name in detail_names(load)}
    done = 0
    for group in geometry_groups(cell):
        try:
            answer = solve(cell.take(group), load=load, **options)
        except (InputError, MissingLibrary, BoundExceeded):
            raise
        except Exception as error:  # one geometry must not lose the sweep
            _record_failure(results, cell, group, error)
        else:
            results.stiffness[group] = answer.stiffness
            results.error_estimate[group] = answer.error_estimate
            results.status[group] = answer.status
            results.dof[group] = answer.dof
            results.seconds[group] = answer.seconds
            for name, found in details.items():
                found[group] = getattr(answer, name)
        done += group.size
        if progress:
            progress(done, points)
    return results


def check_options(load: str, options: Mapping[str, Any]) -> None:
    """Refuse a boundary condition or a tolerance that the reference does not have."""
    _check_condition(load, options)
    _check_tolerance(options)


def _check_condition(load: str, options: Mapping[str, Any]) -> None:
    """Only the normal load has a choice; the default may be said with any load."""
    condition = options.get("bc", DEFAULT_CONDITION)
    if condition not in BOUNDARY_CONDITIONS:
        allowed = f"one of {', '.join(BOUNDARY_CONDITIONS)}"
        raise UnsupportedLoad([Violation("bc", condition, allowed)])
    if load != "normal" and condition != DEFAULT_CONDITION:
        allowed = f"left out for the load {load}: only the load normal has boundary conditions"
        raise UnsupportedLoad([Violation("bc", condition, allowed)])


def _check_tolerance(options: Mapping[str, Any]) -> None:
    tolerance = options.get("tolerance", DEFAULT_TOLERANCE)
    number = isinstance(tolerance, (int, float, np.number)) and not isinstance(tolerance, bool)
    if not number or not TOLERANCES[0] <= tolerance <= TOLERANCES[1]:
        raise InputError([Violation("tolerance", tolerance, TOLERANCE_RANGE)])


def _record_failure(results: PointResults, cell: Cell, group: IntArray, error: Exception) -> None:
    status = Status.mesh_failed if "mesh" in type(error).__name__.lower() else Status.solver_failed
    if isinstance(error, PointLost):
        status = Status.limit_exceeded
    results.status[group] = status
    where = ", ".join(f"{name}={getattr(cell, name)[group[0]]:.9g} m" for name in GEOMETRY)
    line = f"{status.name}: {group.size} points at {where}: {type(error).__name__}: {error}"
    results.failures.append(line)
    warnings.warn(line, RuntimeWarning, stacklevel=3)
