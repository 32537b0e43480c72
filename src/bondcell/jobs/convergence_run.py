"""Climb the ladders of a scene's convergence study and time every level."""

from __future__ import annotations

import time
import warnings
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from statistics import median
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from bondcell.cell import LONG_NAMES, UNITS, FloatArray
from bondcell.errors import BondcellError, InputError
from bondcell.evaluate import evaluate
from bondcell.fem import structured, triangles
from bondcell.fem.level import Level
from bondcell.jobs.basis_ladder import climb_basis
from bondcell.outputs import STIFFNESS_UNITS
from bondcell.results.convergence import (
    BASIS,
    GRADED,
    MODEL,
    ROTATIONAL,
    STAGES,
    STRUCTURED,
    TRIANGLES,
    combine_cases,
    observed_order,
    relative_error,
)
from bondcell.scenes.names import covering
from bondcell.status import Status, cf_flag_attributes
from bondcell.timing import ATTRIBUTES, Timing, timed

if TYPE_CHECKING:
    from bondcell.scenes.blocks import Convergence
    from bondcell.scenes.scene import ConvergenceCase, Scene

GRADED_ORDER = 4
"""Polynomial order of the structured h-ladder."""

_OF_BASIS = ("bound", "sample_error")

_OF_TIMING = ("seconds_spread", "seconds_cpu")

MODEL_POINTS = (100, 10_000)
"""Fewest and most points on which an analytic model is timed: cells of slightly different gaps."""

MODEL_SECONDS = 0.2
"""Time that one evaluation of an analytic model should not exceed [s]."""

Progress = Callable[[int, int], None]


_FAILED = Level(np.nan, 0, 0, np.nan, np.nan, np.nan)
_UNTIMED = Timing(np.nan, np.nan, np.nan)


@dataclass(frozen=True)
class _Rung:
    """A level of a ladder as it came out."""

    refinement: float
    status: Status
    level: Level
    bound: float = np.nan
    sample_error: float = np.nan
    timing: Timing = _UNTIMED


def run_convergence(scene: Scene, progress: Progress | None = None) -> xr.Dataset:
    """Run all cases of a scene's convergence study.

    Parameters
    ----------
    scene
        A scene with a convergence block.
    progress
        Called as ``progress(cases_done, cases)`` after each case.

    Returns
    -------
    xarray.Dataset
        On ``(case, method, level)``: ``refinement`` (order p, ratio of neighbouring elements,
        element size or vectors of a basis), ``stiffness`` [N m-1] or ``rotational_stiffness``
        [N m rad-1], ``dof``, ``elements``, ``seconds_mesh``, ``seconds_assembly``,
        ``seconds_solve``, ``seconds``, ``seconds_spread``, ``seconds_cpu``, ``error``, ``order``,
        ``status``, and of the reduced basis
        ``bound`` and ``sample_error``. On ``(case, analytic_model)``: ``model_stiffness`` (or
        ``model_rotational_stiffness``), ``model_error``, ``model_seconds``, ``model_status``. On
        ``case``: ``reference_error``, ``load``, ``unit``, ``bc`` and the inputs.
    """
    cases = {}
    for number, name in enumerate(scene.cases(), start=1):
        cases[name] = run_case(scene, name)
        if progress:
            progress(number, len(scene.cases()))
    return combine_cases(cases)


def run_case(scene: Scene, name: str) -> xr.Dataset:
    """Run one case; dimensions ``(method, level)`` and models, else as `run_convergence`.

    A level that fails is NaN, ``status`` and a warning say why. Errors are relative to the finest
    level of the first ladder, the structured one; ``reference_error`` is the difference of its two
    finest levels: errors below it say nothing.
    """
    block = scene.convergence
    if block is None or name not in scene.cases():
        raise KeyError(f"no convergence case {name!r} in the scene {scene.name!r}")
    case = scene.cases()[name]
    ladders = _ladders(name, case, block)
    reference, doubt = _reference(ladders)
    result = xr.merge(
        [
            _ladder_dataset(ladders, reference),
            _model_dataset(case, scene.models, block.repeats, reference),
            _case_dataset(case, doubt),
        ]
    )
    if case.load in ("torsion", "bending"):
        names = {"stiffness": ROTATIONAL, "model_stiffness": f"model_{ROTATIONAL}"}
        result = result.rename(names)
        for renamed in names.values():
            result[renamed].attrs["units"] = STIFFNESS_UNITS[case.load]
    return result.assign_attrs(title=f"Convergence study of {scene.name}", repeats=block.repeats)


def _ladders(name: str, case: ConvergenceCase, block: Convergence) -> dict[str, list[_Rung]]:
    """Climb what the scene asks for; only the normal load has triangles."""
    ladders: dict[str, list[_Rung]] = {}
    options: dict[str, Any] = {"bc": case.bc} if case.load == "normal" else {"load": case.load}
    if block.orders:
        solve = partial(structured.solve_level, case.cell, **options)
        ladders[STRUCTURED] = _climb(name, solve, "order", block.orders, block.repeats)
    if block.gradings:
        solve = partial(_solve_graded, case)
        ladders[GRADED] = _climb(name, solve, "growth", block.gradings, block.repeats)
    if block.sizes and case.load == "normal":
        solve = partial(triangles.solve_level, case.cell, bc=case.bc)
        ladders[TRIANGLES] = _climb(name, solve, "size", block.sizes, block.repeats)
    if block.basis_order:
        ladders[BASIS] = _grow(name, case, block.basis_order, block.repeats)
    return ladders


def _solve_graded(case: ConvergenceCase, growth: float) -> Level:
    """The structured mesh with neighbouring elements of that ratio, order `GRADED_ORDER`."""
    usual = structured.find_load(case.load, case.bc).grading
    grading = replace(usual, growth=growth, foot_growth=growth, corner_growth=2 * growth)
    return structured.solve_level(
        case.cell, GRADED_ORDER, bc=case.bc, load=case.load, grading=grading
    )


def _grow(name: str, case: ConvergenceCase, order: int, repeats: int) -> list[_Rung]:
    try:
        rungs = list(climb_basis(case.cell, order, case.bc, case.load, repeats))
    except (BondcellError, ArithmeticError, np.linalg.LinAlgError, RuntimeError) as error:
        warnings.warn(f"case {name}, reduced basis of order {order}: {error}", stacklevel=2)
        return [_Rung(0, _failure(error), _FAILED)]
    return [_Rung(r.size, Status.ok, r.level, r.bound, r.error, r.timing) for r in rungs]


def _climb(
    case: str,
    solve: Callable[..., Level],
    parameter: str,
    values: Sequence[float],
    repeats: int,
) -> list[_Rung]:
    """Solve every level `repeats` times, after a first run that is not timed: it warms caches."""
    rungs = []
    for number, value in enumerate(values):
        level = partial(solve, **{parameter: value})
        try:
            if number == 0:
                level()
            rungs.append(_measured(value, level, repeats))
        except (BondcellError, ArithmeticError, np.linalg.LinAlgError, RuntimeError) as error:
            warnings.warn(f"case {case}, {parameter} = {value}: {error}", stacklevel=2)
            rungs.append(_Rung(value, _failure(error), _FAILED))
    return rungs


def _measured(value: float, level: Callable[[], Level], repeats: int) -> _Rung:
    """Median of the repeats by stage, with their timing as a whole."""
    runs, cpu = [], []
    for _ in range(repeats):
        started = time.process_time()
        runs.append(level())
        cpu.append(time.process_time() - started)
    timing = Timing.of([run.seconds for run in runs], cpu)
    return _Rung(value, Status.ok, _median(runs), timing=timing)


def _failure(error: Exception) -> Status:
    if isinstance(error, InputError):
        return Status.limit_exceeded
    return Status.mesh_failed if isinstance(error, BondcellError) else Status.solver_failed


def _median(runs: Sequence[Level]) -> Level:
    times = {stage: median(getattr(run, stage) for run in runs) for stage in STAGES}
    return Level(runs[0].stiffness, runs[0].dof, runs[0].elements, **times)


def _reference(ladders: Mapping[str, Sequence[_Rung]]) -> tuple[float, float]:
    """Finest stiffness of the first ladder that has one, and its relative distance to the next."""
    for rungs in ladders.values():
        values = [rung.level.stiffness for rung in rungs if np.isfinite(rung.level.stiffness)]
        if values:
            finest = values[-1]
            return finest, abs(values[-2] / finest - 1) if len(values) > 1 else np.nan
    return np.nan, np.nan


def _ladder_dataset(ladders: Mapping[str, Sequence[_Rung]], reference: float) -> xr.Dataset:
    methods = list(ladders)
    levels = max((len(rungs) for rungs in ladders.values()), default=0)
    shape = (len(methods), levels)
    names = (
        "refinement",
        "stiffness",
        "error",
        "order",
        *STAGES,
        "seconds",
        *_OF_BASIS,
        *_OF_TIMING,
    )
    real = {name: np.full(shape, np.nan) for name in names}
    count = {name: np.zeros(shape, dtype=np.int64) for name in ("dof", "elements")}
    status = np.full(shape, Status.not_computed, dtype=np.int8)
    for row, (method, rungs) in enumerate(ladders.items()):
        here = row, slice(len(rungs))
        values = {
            name: np.array([getattr(rung.level, name) for rung in rungs])
            for name in ("stiffness", "dof", "elements", *STAGES, "seconds")
        }
        for name in ("refinement", *_OF_BASIS):
            values[name] = np.array([getattr(rung, name) for rung in rungs])
        for name in _OF_TIMING:
            values[name] = np.array([getattr(rung.timing, name) for rung in rungs])
        values["error"] = relative_error(values["stiffness"], reference)
        values["order"] = observed_order(values["error"], _work(method, values))
        status[here] = [rung.status for rung in rungs]
        for name, data in values.items():
            (count if name in count else real)[name][here] = data
    arrays = real | count | {"status": status}
    dims = ("method", "level")
    return xr.Dataset(
        {name: (dims, data, _LADDER_ATTRIBUTES[name]) for name, data in arrays.items()},
        {
            "method": ("method", methods, {"long_name": "discretisation"}),
            "level": ("level", np.arange(levels), {"long_name": "level, from coarse to fine"}),
        },
    )


def _work(method: str, values: Mapping[str, FloatArray]) -> FloatArray:
    """Logarithm of what grows with refinement, see `observed_order`."""
    if method in (STRUCTURED, BASIS):
        return values["refinement"]
    return np.log(np.maximum(values["dof"], 1)) / 2


def _model_dataset(
    case: ConvergenceCase, models: Sequence[str], repeats: int, reference: float
) -> xr.Dataset:
    """Stiffness of each analytic model at the cell, and its time per point on many such cells."""
    able, load = covering([case.load]), case.load
    inputs = {name: float(value.ravel()[0]) for name, value in case.cell.as_dict().items()}
    fewest, most = MODEL_POINTS
    spread = inputs.pop("gap") * (1 + 1e-3 * np.linspace(0, 1, most))
    cells = xr.Dataset(inputs).assign(gap=("point", spread))
    stiffness, timings = np.full(len(models), np.nan), [_UNTIMED] * len(models)
    status = np.full(len(models), Status.not_computed, dtype=np.int8)
    for row, model in enumerate(models):
        if model not in able:
            continue
        first = evaluate(cells.isel(point=slice(fewest)), model, load).isel(point=0)
        stiffness[row], status[row] = first["stiffness"], first["status"]
        count = int(np.clip(MODEL_SECONDS / float(first["seconds"]), fewest, most))
        points = cells.isel(point=slice(count))
        _, timing = timed(partial(evaluate, points, model, load), repeats)
        timings[row] = timing.per(count)
    values = {
        "model_stiffness": stiffness,
        "model_error": np.abs(stiffness / reference - 1),
        "model_status": status,
    } | {f"model_{name}": [getattr(timing, name) for timing in timings] for name in ATTRIBUTES}
    return xr.Dataset(
        {name: (MODEL, data, _MODEL_ATTRIBUTES[name]) for name, data in values.items()},
        {MODEL: (MODEL, list(models), {"long_name": "analytic model"})},
    )


def _case_dataset(case: ConvergenceCase, doubt: float) -> xr.Dataset:
    inputs = {
        name: ((), float(value.ravel()[0]), {"units": UNITS[name], "long_name": LONG_NAMES[name]})
        for name, value in case.cell.as_dict().items()
    }
    condition = case.bc if case.load == "normal" else "none"
    about = {
        "reference_error": ((), doubt, _number("relative difference of the two finest levels")),
        "load": ((), case.load, {"long_name": "load"}),
        "unit": ((), STIFFNESS_UNITS[case.load], {"long_name": "unit of the stiffness"}),
        "bc": ((), condition, {"long_name": "boundary condition"}),
    }
    return xr.Dataset(about | inputs)


def _stiffness(long_name: str) -> dict[str, Any]:
    return {"units": STIFFNESS_UNITS["normal"], "long_name": long_name}


def _number(long_name: str) -> dict[str, Any]:
    return {"units": "1", "long_name": long_name}


def _time(long_name: str) -> dict[str, Any]:
    return {"units": "s", "long_name": long_name}


_LADDER_ATTRIBUTES: Mapping[str, Mapping[str, Any]] = {
    "refinement": _number("order, ratio of neighbours, relative element size or basis vectors"),
    "stiffness": _stiffness("stiffness of the bond"),
    "error": _number("error relative to the finest structured level"),
    "order": _number("observed order in dof^(-1/2) of triangles, exponential rate in p else"),
    "seconds_mesh": _time("wall time of meshing, median of repeats"),
    "seconds_assembly": _time("wall time of assembly, median of repeats"),
    "seconds_solve": _time("wall time of the solution, median of repeats"),
    "seconds": _time("wall time of all stages"),
    "seconds_spread": ATTRIBUTES["seconds_spread"],
    "seconds_cpu": ATTRIBUTES["seconds_cpu"],
    "dof": _number("degrees of freedom"),
    "elements": _number("elements of the mesh"),
    "status": cf_flag_attributes(),
    "bound": _number("largest bound of the reduced basis over random materials"),
    "sample_error": _number("largest true error of the reduced basis over a sample of them"),
}

_MODEL_ATTRIBUTES: Mapping[str, Mapping[str, Any]] = {
    "model_stiffness": _stiffness("stiffness by an analytic model"),
    "model_error": _number("error of an analytic model relative to the finest structured level"),
    "model_seconds": _time("wall time per point among many, median of the runs"),
    "model_seconds_spread": _time("time per point of the slowest run less that of the quickest"),
    "model_seconds_cpu": _time("processor time per point among many, median of the runs"),
    "model_status": cf_flag_attributes(),
}
