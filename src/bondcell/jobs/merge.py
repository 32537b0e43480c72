"""The answers of a scene's jobs put together on the dimensions of its sweep."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from bondcell.cell import FloatArray
from bondcell.errors import DataError, Violation
from bondcell.inputs import cell_from_study
from bondcell.outputs import DETAILS, OUTPUTS, PointResults

INDEX = "point_index"


def merge(
    study: xr.Dataset, batches: Iterable[xr.Dataset], labels: Mapping[str, str]
) -> xr.Dataset:
    """The results of all batches on the study's dimensions.

    Parameters
    ----------
    study
        Inputs on the swept dimensions.
    batches
        Results on ``(model, point)`` with the points' positions in the raveled study, as
        `bondcell.jobs.batch_results.batch_dataset` gives them; what else is on ``(point,)`` are
        springs.
    labels
        Name in the batches -> name in the result's dimension ``model``, in the wanted order.

    Returns
    -------
    xarray.Dataset
        `study` with the outputs on ``(model, axes...)`` and the springs on ``(axes...)``.

    Raises
    ------
    DataError
        A point of a method is missing, comes twice, or is none of the study's.
    """
    cell, dims = cell_from_study(study)
    canvas = _Canvas(list(labels), int(np.prod(cell.shape)))
    for batch in batches:
        canvas.add(batch)
    canvas.check_complete()
    merged = study.assign_coords(model=("model", list(labels.values()), {"long_name": "model"}))
    for name in OUTPUTS if labels else ():
        values = getattr(canvas.results, name).reshape(-1, *cell.shape)
        merged[name] = (("model", *dims), values, canvas.attributes[name])
    for name, detail in canvas.results.details.items():
        values = detail.reshape(-1, *cell.shape)
        merged[name] = (("model", *dims), values, canvas.attributes[name])
    for name in sorted(canvas.springs):
        values = canvas.springs[name].reshape(cell.shape)
        merged[name] = (dims, values, canvas.attributes[name])
    return merged


class _Canvas:
    """Arrays over all methods and points, filled batch by batch."""

    def __init__(self, methods: list[str], points: int) -> None:
        self.rows = {method: row for row, method in enumerate(methods)}
        self.results = PointResults.empty((len(methods), points))
        self.springs: dict[str, FloatArray] = {}
        self.attributes: dict[str, dict[str, Any]] = {}
        self.seen = np.zeros((len(methods), points), dtype=np.int8)

    def add(self, batch: xr.Dataset) -> None:
        """Put a batch's values where they belong."""
        where = self._positions(batch)
        for method in batch["model"].values.tolist():
            row = self._row(method)
            self.seen[row, where] += 1
            for name in OUTPUTS:
                getattr(self.results, name)[row, where] = batch[name].sel(model=method).values
            for name in DETAILS:
                if name in batch:
                    self.results.detail(name)[row, where] = batch[name].sel(model=method).values
        for name in sorted({str(name) for name in batch.data_vars} - {*OUTPUTS, *DETAILS, INDEX}):
            whole = self.springs.setdefault(name, np.full(self.seen.shape[1], np.nan))
            whole[where] = batch[name].values
        for key, variable in batch.data_vars.items():
            self.attributes.setdefault(str(key), variable.attrs)

    def check_complete(self) -> None:
        """Refuse a result in which a point is missing or comes twice."""
        wrong = [
            Violation(method, f"{np.count_nonzero(seen != 1)} of {seen.size} points", "each once")
            for method, seen in zip(self.rows, self.seen, strict=True)
            if np.any(seen != 1)
        ]
        if wrong:
            raise DataError(wrong)

    def _positions(self, batch: xr.Dataset) -> NDArray[np.int64]:
        where = batch[INDEX].values
        outside = where[(where < 0) | (where >= self.seen.shape[1])]
        if outside.size:
            allowed = f"[0, {self.seen.shape[1]})"
            raise DataError([Violation(INDEX, int(outside[0]), allowed)])
        if np.any(np.diff(where) <= 0):
            raise DataError([Violation(INDEX, "unordered", "ascending positions, each once")])
        return where

    def _row(self, method: str) -> int:
        if method not in self.rows:
            raise DataError([Violation("model", method, f"one of {', '.join(self.rows)}")])
        return self.rows[method]
