"""Error against run time of the ways to K(t): exact series, stepping, inversion, shortcut."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from bondcell.cell import Cell, FloatArray
from bondcell.errors import BondcellError
from bondcell.fem.full_system import FullSystem, full_systems
from bondcell.fem.laplace_inversion import invert_reference
from bondcell.fem.reference import solve
from bondcell.fem.relaxing_reference import forget, relax
from bondcell.fem.time_stepping import graded_times, step_through
from bondcell.inputs import cell_from_study
from bondcell.jobs.relaxing_points import prony_of, relaxing_study
from bondcell.outputs import STIFFNESS_UNITS, TIME
from bondcell.prony.conventions import Relaxing
from bondcell.results.names import reference_variants
from bondcell.status import Status, cf_flag_attributes
from bondcell.timing import ATTRIBUTES, timed

if TYPE_CHECKING:
    from bondcell.scenes.scene import Scene

METHODS = ("exact_series", "time_stepping", "laplace_inversion", "shortcut")
"""The ways, each with levels of refinement."""

TOLERANCES = (1e-2, 1e-4, 1e-6)
"""Levels of the exact series: tolerances of its discretisation."""

TRUTH = 1e-8
"""Tolerance of the series that all are compared with."""

FIRST_STEP = 0.1
"""Where graded steps begin, over the shortest relaxation time."""

Progress = Callable[[int, int], None]


@dataclass(frozen=True)
class _Run:
    """One level of a method: what is asked, and the values with their unknowns."""

    method: str
    refinement: float
    values: Callable[[], tuple[FloatArray, int]]


@dataclass(frozen=True)
class _Problem:
    matrix: Relaxing
    load: str
    bc: str
    order: int
    times: FloatArray


def run_methods(scene: Scene, progress: Progress | None = None) -> xr.Dataset:
    """Run every way on the scene's cell for the series asked for, under the first convention.

    Parameters
    ----------
    scene
        A scene whose prony block has methods, with a reference.
    progress
        Called as ``progress(cases_done, cases)``.

    Returns
    -------
    xarray.Dataset
        On ``(case, method, level)``: ``refinement`` (tolerance, steps a decade, nodes of the
        contour), ``error`` (largest relative one over the times, against the exact series of a
        discretisation of tolerance `TRUTH`), ``seconds`` (set-up included, median of repeats),
        ``seconds_spread``, ``seconds_cpu``, ``dof``, ``status``, and ``curve`` on
        ``(..., compared_time)``. On ``case``: ``load``, ``bc``, ``unit``, ``reference_error``.
    """
    block = scene.prony
    assert block is not None
    assert block.methods is not None
    asked = block.methods
    cell, _ = cell_from_study(_cell_study(scene))
    times = np.geomspace(block.times.start, block.times.stop, asked.times)
    variant = next(iter(reference_variants(scene, scene.load).values()))
    bc = variant if scene.load == "normal" else "roller"
    chosen = [case for case in block.cases() if case.name in asked.series]
    found = {}
    for case in chosen:
        start, _ = cell_from_study(relaxing_study(cell.ravel(), case))
        matrix = Relaxing.of(start, prony_of(block, case), block.conventions[0])
        problem = _Problem(matrix, scene.load, bc, asked.order, times)
        runs = list(_runs(problem, asked.steps, asked.nodes))
        found[case.name] = _case(problem, runs, asked.repeats)
        if progress:
            progress(len(found), len(chosen))
    about = {"title": f"Methods in time of {scene.name}", "repeats": asked.repeats}
    names = xr.DataArray(list(found), dims="case", attrs={"long_name": "series of the matrix"})
    return xr.concat(list(found.values()), names.rename("case")).assign_attrs(about)


def _cell_study(scene: Scene) -> xr.Dataset:
    cell = Cell.from_values(**scene.cell.given())
    return xr.Dataset({name: float(value.ravel()[0]) for name, value in cell.as_dict().items()})


def _runs(problem: _Problem, steps: tuple[int, ...], nodes: tuple[int, ...]) -> Iterator[_Run]:
    matrix, load, bc = problem.matrix, problem.load, problem.bc
    wanted, chain = problem.times, problem.matrix.prony.shear

    def exact(tolerance: float) -> tuple[FloatArray, int]:
        forget()
        answer = relax(matrix, load, bc, tolerance)
        return answer.series.relaxation(wanted), answer.dof

    def stepping(density: int) -> tuple[FloatArray, int]:
        systems = full_systems(matrix.cell, problem.order, load, bc)
        times = graded_times(wanted, density, FIRST_STEP * float(chain.times.min()))
        values = step_through(matrix, systems, times)
        at = np.searchsorted(times, wanted * (1 - 1e-12))
        return values[1 + at], _unknowns(systems)

    def inversion(count: int) -> tuple[FloatArray, int]:
        systems = full_systems(matrix.cell, problem.order, load, bc)
        return invert_reference(matrix, systems, wanted, count), _unknowns(systems)

    def shortcut() -> tuple[FloatArray, int]:
        options = {"bc": bc} if load == "normal" else {}
        start = solve(matrix.cell, load=load, tolerance=TOLERANCES[-1], **options)
        return start.stiffness[0] * matrix.prony.relaxation_modulus(wanted), int(start.dof[0])

    for tolerance in TOLERANCES:
        yield _Run("exact_series", tolerance, lambda t=tolerance: exact(t))  # type: ignore[misc]
    for density in steps:
        yield _Run("time_stepping", density, lambda n=density: stepping(n))  # type: ignore[misc]
    for count in nodes:
        yield _Run("laplace_inversion", count, lambda n=count: inversion(n))  # type: ignore[misc]
    yield _Run("shortcut", np.nan, shortcut)


def _unknowns(systems: Sequence[FullSystem]) -> int:
    return sum(int(system.free.sum()) for system in systems)


def _case(problem: _Problem, runs: list[_Run], repeats: int) -> xr.Dataset:
    truth = relax(problem.matrix, problem.load, problem.bc, TRUTH)
    curve = truth.series.relaxation(problem.times)
    levels = max(sum(run.method == method for run in runs) for method in METHODS)
    shape = (len(METHODS), levels)
    real = {name: np.full(shape, np.nan) for name in ("refinement", "error", *ATTRIBUTES)}
    whole = {"dof": np.zeros(shape, dtype=np.int64)}
    status = np.full(shape, Status.not_computed, dtype=np.int8)
    curves = np.full((*shape, problem.times.size), np.nan)
    place = dict.fromkeys(METHODS, 0)
    for run in runs:
        at = METHODS.index(run.method), place[run.method]
        place[run.method] += 1
        real["refinement"][at] = run.refinement
        try:
            (values, dof), timing = timed(run.values, repeats)
        except (BondcellError, ArithmeticError, np.linalg.LinAlgError, RuntimeError):
            status[at] = Status.solver_failed
            continue
        good = np.isfinite(values).all()
        status[at] = Status.ok if good else Status.solver_failed
        real["error"][at] = np.abs(values / curve - 1).max()
        whole["dof"][at], curves[at] = dof, values
        for name in ATTRIBUTES:
            real[name][at] = getattr(timing, name)
    dims = ("method", "level")
    variables: dict[str, Any] = {
        name: (dims, values, _ATTRIBUTES[name]) for name, values in (real | whole).items()
    }
    unit = STIFFNESS_UNITS[problem.load]
    variables |= {
        "status": (dims, status, cf_flag_attributes()),
        "curve": (
            (*dims, "compared_time"),
            curves,
            {"units": unit, "long_name": "stiffness after a step"},
        ),
        "truth": (
            "compared_time",
            curve,
            {"units": unit, "long_name": "what the others are compared with"},
        ),
        "reference_error": ((), truth.error_estimate, _ATTRIBUTES["reference_error"]),
        "convention": ((), problem.matrix.convention, {"long_name": "what relaxes"}),
        "load": ((), problem.load, {"long_name": "load"}),
        "bc": ((), problem.bc, {"long_name": "boundary condition"}),
        "unit": ((), unit, {"long_name": "unit of the stiffness"}),
    }
    coords = {
        "method": ("method", list(METHODS), {"long_name": "way to K(t)"}),
        "level": ("level", np.arange(levels), {"long_name": "refinement, from coarse to fine"}),
        "compared_time": ("compared_time", problem.times, TIME),
    }
    return xr.Dataset(variables, coords)


_ATTRIBUTES = {
    "refinement": {"units": "1", "long_name": "tolerance, steps a decade, or nodes"},
    "error": {"units": "1", "long_name": "largest relative error over the times"},
    **ATTRIBUTES,
    "dof": {"units": "1", "long_name": "degrees of freedom"},
    "reference_error": {"units": "1", "long_name": "error estimate of what is compared with"},
}
