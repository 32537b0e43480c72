"""Builds the file of the accuracy map: errors from the atlas, margins and times measured."""

from __future__ import annotations

import json
import time
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from bondcell.results.accuracy_map import AXES, LOADS, AccuracyMap, delta, encode, from_arrays
from bondcell.results.atlas import worst_errors
from bondcell.cell import Cell, FloatArray
from bondcell.fem.reference import solve
from bondcell.models import MODELS
from bondcell.models.asked import ask
from bondcell.results.view import REFERENCE, analytic_names

CHECKS, SEED = 1000, 20260715
"""Random cells a load at which the map is compared with the surrogate, and their seed."""

MANY, SOLVES = 100, 5
"""Cells of the timed call with many, and of the timed reference."""

REPEATS = 7
"""Timed calls of one cell; the median is stored."""


def random_cells(axes: Mapping[str, FloatArray], count: int, seed: int) -> Cell:
    """Cells all over the map, more of them near an incompressible matrix [m, Pa]."""
    rng = np.random.default_rng(seed)
    gaps, ratios = np.log(axes["gap_ratio"]), np.log(axes["modulus_ratio"][:-1])
    return Cell.from_values(
        radius_i=1.0,
        gap=np.exp(rng.uniform(gaps[0], gaps[-1], count)),
        young_i=np.exp(rng.uniform(ratios[0], ratios[-1], count)),
        young_m=1.0,
        poisson_i=rng.uniform(0, 0.45, count),
        poisson_m=0.5 - 0.5 * rng.random(count) ** rng.choice([1, 4, 12], count),
    )


def exceedance(found: AccuracyMap, load: str, model: str, cells: Cell) -> FloatArray:
    """True error over the expected one at each cell, the surrogate being the truth.

    The surrogate's own error is granted; a cell without a value on either side counts as 0.
    """
    truth, _ = ask(MODELS["surrogate"], load, cells)
    answer, _ = ask(MODELS[model], load, cells)
    actual = np.abs(answer.stiffness / truth.stiffness - 1) - truth.relative_error
    expected = found.expected(load, model, cells).error
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.nan_to_num(np.maximum(actual, 0) / expected, posinf=np.inf)


def measure_margins(found: AccuracyMap, cells: Cell) -> dict[str, dict[str, float]]:
    """Load -> model -> largest excess of the true error over the expected one, at least 1."""
    margins: dict[str, dict[str, float]] = {}
    for load, models in found.codes.items():
        for model in models:
            worst = 1.0
            if model != "surrogate":
                worst = max(1.0, float(exceedance(found, load, model, cells).max()))
            margins.setdefault(load, {})[model] = round(worst, 3)
    return margins


def measure_seconds(load: str, models: list[str], cells: Cell) -> dict[str, dict[str, float]]:
    """Model -> CPU time a cell [s] alone and among many of different geometry."""
    times = {}
    for model in models:
        one = [_clocked(ask, MODELS[model], load, _one(cells, k)) for k in range(REPEATS)]
        many = _clocked(ask, MODELS[model], load, cells) / cells.gap.size
        times[model] = {"one": float(np.median(one)), "many": many}
    solves = [_clocked(solve, _one(cells, k), load) for k in range(SOLVES)]
    times[REFERENCE] = dict.fromkeys(("one", "many"), float(np.median(solves)))
    return times


def _one(cells: Cell, k: int) -> Cell:
    return cells.take(slice(k, k + 1))


def _clocked(function: Callable[..., Any], *arguments: Any) -> float:
    """CPU time of a call after one that warms it up."""
    function(*arguments)
    start = time.process_time()
    calls = 0
    while calls == 0 or time.process_time() - start < 2e-3:
        function(*arguments)
        calls += 1
    return (time.process_time() - start) / calls


def build(path: Path, loads: Mapping[str, xr.Dataset], provenance: Mapping[str, str]) -> None:
    """Write the file.

    Parameters
    ----------
    path
        Where.
    loads
        Load -> result of the atlas.
    provenance
        What to store on versions and machine.
    """
    first = next(iter(loads.values()))
    arrays: dict[str, Any] = {axis: first[axis].values.astype(float) for axis in AXES}
    for load in LOADS:
        for model in analytic_names(loads[load]):
            arrays[f"{load}_{model}"] = delta(encode(worst_errors(loads[load], model)))
    poisson = np.atleast_1d(first["poisson_i"].values)
    about: dict[str, Any] = {
        "quantity": "K / K_fe - 1, signed, coded by bondcell.results.accuracy_map.encode; differences",
        "poisson_particle": [float(poisson.min()), float(poisson.max())],
        "reference_error": max(_largest_estimate(study) for study in loads.values()),
        "checks": CHECKS,
        "seed": SEED,
        "many": MANY,
        "margins": {load: dict.fromkeys(analytic_names(loads[load]), 1.0) for load in LOADS},
        **provenance,
    }
    plain = from_arrays({**arrays, "about": json.dumps(about)})
    about["margins"] = measure_margins(plain, random_cells(plain.axes, CHECKS, SEED).ravel())
    timed = random_cells(plain.axes, MANY, SEED).ravel()
    about["seconds"] = {load: measure_seconds(load, [*plain.codes[load]], timed) for load in LOADS}
    with path.open("wb") as stream:
        np.savez_compressed(stream, **arrays, about=np.array(json.dumps(about)))


def _largest_estimate(study: xr.Dataset) -> float:
    return float(study["error_estimate"].sel(model=REFERENCE).max())
