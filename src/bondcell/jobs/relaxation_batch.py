"""Relaxation of a scene at the points of one batch: curves, complex stiffness, series."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from bondcell.by_geometry import geometry_groups
from bondcell.cell import Cell, FloatArray
from bondcell.correspondence import correspondence
from bondcell.inputs import cell_from_study
from bondcell.jobs.batch import Batch
from bondcell.jobs.batch_results import about_batch
from bondcell.jobs.relaxation_layout import laid_out
from bondcell.jobs.relaxing_points import prony_of, relaxing_study
from bondcell.jobs.rows import RELAXING_REFERENCE, Row
from bondcell.models import MODELS
from bondcell.prony.chain import Chain
from bondcell.prony.conventions import Relaxing
from bondcell.relaxation import relaxation_series
from bondcell.results.relaxation_names import (
    with_equal_terms,
)
from bondcell.scenes.prony_block import PronyBlock
from bondcell.scenes.series_cases import SeriesCase
from bondcell.status import Status

Progress = Callable[[int, int], None]


@dataclass(frozen=True)
class Asked:
    """A model with its options, and what its row of the result is called."""

    label: str
    model: str
    options: Mapping[str, Any]


def asked_of(rows: tuple[Row, ...]) -> list[Asked]:
    """What the rows of a batch ask for."""
    return [_asked_fe(row) if row.kind == RELAXING_REFERENCE else _asked(row) for row in rows]


def _asked(row: Row) -> Asked:
    return Asked(row.model, row.model, {})


def _asked_fe(row: Row) -> Asked:
    tolerance = dict(row.options)["tolerance"]
    return Asked(row.model, "fe", {"tolerance": tolerance, **row.condition})


def compute_relaxation(
    batch: Batch, block: PronyBlock, progress: Progress | None = None
) -> xr.Dataset:
    """Every series under every convention at the batch's points, by every model.

    Parameters
    ----------
    batch
        Rows of relaxation.
    block
        What relaxes, and at which times.
    progress
        Called as ``progress(geometries_done, geometries)``.

    Returns
    -------
    xarray.Dataset
        `VARIABLES` on ``(model, convention, series, point, ...)``, and what
        `bondcell.jobs.batch_results.about_batch` gives.
    """
    models = asked_of(batch.rows)
    groups = [np.arange(len(batch.hashes))]
    if any(MODELS[model.model].is_reference for model in models):
        groups = list(geometry_groups(batch.points))  # all that shares a mesh, one after the other
    parts = []
    for done, group in enumerate(groups, start=1):
        parts.append(_group(batch.points.take(group), block, models, batch.load))
        if progress:
            progress(done, len(groups))
    found = xr.concat(with_equal_terms(parts), "point", data_vars="minimal")
    back = np.argsort(np.concatenate(groups))
    return about_batch(batch).merge(found.isel(point=back), combine_attrs="override")


def _group(cell: Cell, block: PronyBlock, asked: list[Asked], load: str) -> xr.Dataset:
    cases = block.cases()
    found = [
        [_relax(cell, block, case, convention, asked, load) for case in cases]
        for convention in block.conventions
    ]
    return laid_out(found, block, cases, [model.label for model in asked], load)


def _relax(
    cell: Cell,
    block: PronyBlock,
    case: SeriesCase,
    convention: str,
    asked: list[Asked],
    load: str,
) -> dict[str, Any]:
    """One series under one convention: variable -> values, models first."""
    prony = prony_of(block, case)
    points = relaxing_study(cell, case)
    start, _ = cell_from_study(points)
    matrix = Relaxing.of(start.ravel(), prony, convention)
    times = np.concatenate(([0.0], block.times.values()))
    states = matrix.states(times)
    rows: dict[str, list[Any]] = {}
    for model in asked:
        series = relaxation_series(
            points, prony, model.model, convention, load, **dict(model.options)
        )
        row = _row(series, times, block.dynamic_frequencies)
        row["relaxation_status"] = _flags(model.model, series, states)
        if block.checks:
            row |= correspondence(row["chain"], series, matrix, model, load, block.checks)
        for name, value in row.items():
            rows.setdefault(name, []).append(value)
    return {
        **rows,
        "shear_share": prony.relaxation_modulus(times),
        "poisson_t": np.stack([state.poisson_m for state in states], axis=-1),
    }


def _row(series: xr.Dataset, times: FloatArray, frequencies: FloatArray) -> dict[str, Any]:
    strengths, tau = (series[name].values for name in ("K_k", "tau_k"))
    used = np.isfinite(strengths)
    filled = np.where(used, strengths, 0.0), np.where(used, tau, 1.0)
    chain = Chain(series["K_inf"].values, *filled)
    dynamic = np.moveaxis(chain.dynamic(frequencies), 0, -1)
    return {
        "chain": chain,
        "relaxation": np.moveaxis(chain.relaxation(times), 0, -1),
        "storage": dynamic.real,
        "loss": dynamic.imag,
        "K_inf": series["K_inf"].values,
        "K_k": strengths,
        "tau_k": tau,
        "series_error": series["error_estimate"].values,
        "series_status": series["status"].values,
        "series_terms": used.sum(axis=-1),
        "series_seconds": series["seconds"].values,
    }


def _flags(model: str, series: xr.Dataset, states: list[Cell]) -> NDArray[np.int8]:
    """Flags over time: as Poisson's ratio rises a model's valid range may end."""
    always = series["status"].values
    if MODELS[model].is_reference:
        return np.repeat(always[:, None], len(states), axis=1).astype(np.int8)
    known = np.isfinite(series["K_inf"].values)
    inside = np.stack(
        [np.broadcast_to(MODELS[model].is_valid(state), always.shape) for state in states], axis=1
    )
    own = np.where(inside, Status.ok, Status.outside_valid_range)
    return np.where(known[:, None], own, always[:, None]).astype(np.int8)
