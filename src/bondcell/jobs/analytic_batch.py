"""The analytic models of a scene at the points of one batch."""

from __future__ import annotations

import numpy as np
import xarray as xr

from bondcell.cell import Cell
from bondcell.evaluate import evaluate
from bondcell.inputs import cell_from_study
from bondcell.jobs.batch import Batch, cell_at
from bondcell.jobs.batch_results import batch_dataset
from bondcell.outputs import PointResults

REPEATS = 5
"""Timed evaluations of a model that is quick; the median is stored."""

QUICK = 0.2
"""An evaluation shorter than this is repeated, so that its time is no accident [s]."""

CONTRIBUTIONS = ("k_i", "k_int", "k_j")
"""The springs of the series model."""


def compute_analytic(
    study: xr.Dataset,
    batch: Batch,
    models: tuple[str, ...],
    load: str = "normal",
    contributions: bool = False,
) -> xr.Dataset:
    """Stiffness by each model at the batch's points.

    Parameters
    ----------
    study
        Inputs of the whole scene.
    batch
        Which of its points.
    models
        Names in ``bondcell.MODELS``.
    load
        Load name.
    contributions
        Whether to keep the springs ``k_i``, ``k_int`` and ``k_j`` of ``fsi``.
    """
    cell, _ = cell_from_study(study)
    positions = batch.points(cell)
    points = _as_study(cell_at(cell, positions))
    answers = {model: _timed(points, model, load) for model in models}
    results = {model: _results(answer) for model, answer in answers.items()}
    dataset = batch_dataset(positions, results, load)
    if contributions and "fsi" in answers:
        dataset.update(answers["fsi"][list(CONTRIBUTIONS)])
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
