"""The analytic models of a scene at the points of one batch."""

from __future__ import annotations

import numpy as np
import xarray as xr

from bondcell.cell import Cell
from bondcell.evaluate import evaluate
from bondcell.jobs.batch import Batch
from bondcell.jobs.batch_results import batch_dataset
from bondcell.outputs import PointResults

REPEATS = 5
"""Timed evaluations of a model that is quick; the median is stored."""

QUICK = 0.2
"""An evaluation shorter than this is repeated, so that its time is no accident [s]."""

CONTRIBUTIONS = ("k_i", "k_int", "k_j")
"""The springs of the series model."""


def compute_analytic(batch: Batch) -> xr.Dataset:
    """Stiffness by each model of a batch at its points.

    Parameters
    ----------
    batch
        Rows of analytic models; one with the option ``contributions`` keeps its springs.
    """
    points = _as_study(batch.points)
    answers = {row.model: _timed(points, row.model, row.load) for row in batch.rows}
    results = {model: _results(answer) for model, answer in answers.items()}
    dataset = batch_dataset(batch, results)
    for row in batch.rows:
        if dict(row.options).get("contributions"):
            dataset.update(answers[row.model][list(CONTRIBUTIONS)])
    return dataset


def _as_study(cell: Cell) -> xr.Dataset:
    return xr.Dataset({name: ("point", values) for name, values in cell.as_dict().items()})


def _results(answer: xr.Dataset) -> PointResults:
    return PointResults(
        stiffness=answer["stiffness"].values,
        error_estimate=answer["error_estimate"].values,
        status=answer["status"].values,
        dof=answer["dof"].values,
        seconds=answer["seconds"].values,
    )


def _timed(points: xr.Dataset, model: str, load: str) -> xr.Dataset:
    answer = evaluate(points, model, load)
    seconds = [float(answer["seconds"].values[0])]
    while len(seconds) < REPEATS and seconds[0] * points.sizes["point"] < QUICK:
        seconds.append(float(evaluate(points, model, load)["seconds"].values[0]))
    answer["seconds"][...] = np.median(seconds)
    return answer
