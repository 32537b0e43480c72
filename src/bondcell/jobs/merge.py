"""The answers of a scene's jobs put together on the dimensions of its sweep."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from bondcell.cell import UNITS, Cell, FloatArray
from bondcell.errors import DataError, Violation
from bondcell.inputs import cell_from_study
from bondcell.jobs.batch_files import batch_of
from bondcell.jobs.point_hash import HashIndex, point_hashes
from bondcell.outputs import DETAILS, OUTPUTS, PointResults


class Canvas:
    """The outputs over all methods and points of a study, filled batch by batch.

    Points find their place by their hashes, so a batch may hold others besides, and a point that
    two batches have is taken from the first.

    Parameters
    ----------
    study
        Inputs on the swept dimensions.
    labels
        Name in the batches -> name in the result's dimension ``model``, in the wanted order.
    """

    def __init__(self, study: xr.Dataset, labels: Mapping[str, str]) -> None:
        self.study = study
        self.labels = labels
        self.cell, self.dims = cell_from_study(study)
        self.places = Places(self.cell)
        self.rows = {method: row for row, method in enumerate(labels)}
        self.results = PointResults.empty((len(labels), self.places.points))
        self.springs: dict[str, FloatArray] = {}
        self.attributes: dict[str, dict[str, Any]] = {}
        self.seen = np.zeros((len(labels), self.places.points), dtype=bool)

    def add(self, batch: xr.Dataset) -> None:
        """Put a batch's values where they belong."""
        inside, where = self.places.of(batch)
        known = set(OUTPUTS) | set(DETAILS) | set(UNITS)
        for row, method in enumerate(batch["model"].values.tolist()):
            if method not in self.rows:
                continue
            new = ~self.seen[self.rows[method], where]
            at = self.rows[method], where[new]
            self.seen[at] = True
            for name in OUTPUTS:
                getattr(self.results, name)[at] = batch[name].values[row, inside][new]
            for name in DETAILS:
                if name in batch:
                    self.results.detail(name)[at] = batch[name].values[row, inside][new]
        for name in sorted({str(name) for name in batch.data_vars} - known):
            whole = self.springs.setdefault(name, np.full(self.seen.shape[1], np.nan))
            whole[where] = batch[name].values[inside]
        for key, variable in batch.data_vars.items():
            self.attributes.setdefault(str(key), variable.attrs)

    def missing(self, method: str) -> NDArray[np.int64]:
        """Positions of the points that a method lacks."""
        return self.places.first[~self.seen[self.rows[method], self.places.first]]

    def dataset(self) -> xr.Dataset:
        """The study with the outputs on ``(model, axes...)`` and the springs on ``(axes...)``.

        Raises
        ------
        DataError
            A point of a method is missing.
        """
        self._check_complete()
        same, shape = self.places.same, self.cell.shape
        names = list(self.labels.values())
        merged = self.study.assign_coords(model=("model", names, {"long_name": "model"}))
        found = {name: getattr(self.results, name) for name in OUTPUTS if names}
        for name, values in (found | self.results.details).items():
            whole = values if same is None else values[:, same]
            unfolded = whole.reshape(-1, *shape)
            merged[name] = (("model", *self.dims), unfolded, self.attributes[name])
        for name in sorted(self.springs):
            spring = self.springs[name] if same is None else self.springs[name][same]
            merged[name] = (self.dims, spring.reshape(shape), self.attributes[name])
        return merged

    def _check_complete(self) -> None:
        """Refuse a result in which a point is missing."""
        points = self.places.first.size
        lacking = {method: self.missing(method).size for method in self.rows}
        wrong = [
            Violation(method, f"{lost} of {points} points missing", "each point")
            for method, lost in lacking.items()
            if lost
        ]
        if wrong:
            raise DataError(wrong)


class Places:
    """Where the points of batches stand in a study.

    Parameters
    ----------
    cell
        The study's points.

    Attributes
    ----------
    points
        Number of points.
    first
        Positions at which a point stands for the first time.
    same
        For each position that of the first equal point; None where all points differ.
    """

    def __init__(self, cell: Cell) -> None:
        hashes = point_hashes(cell)
        self._index = HashIndex(hashes)
        self.points = len(hashes)
        same = self._index.find(hashes)
        everywhere = np.arange(self.points)
        self.first = np.flatnonzero(same == everywhere)
        self.same = None if self.first.size == self.points else same

    def of(self, batch: xr.Dataset) -> tuple[NDArray[np.bool_], NDArray[np.int64]]:
        """Which points of a batch are in the study, and at which positions."""
        at = self._index.find(batch_of(batch).hashes)
        return at >= 0, at[at >= 0]


def merge(
    study: xr.Dataset, batches: Iterable[xr.Dataset], labels: Mapping[str, str]
) -> xr.Dataset:
    """The results of all batches on the study's dimensions.

    Parameters
    ----------
    study
        Inputs on the swept dimensions.
    batches
        Results on ``(model, point)`` with the points' inputs, as
        `bondcell.jobs.batch_results.batch_dataset` gives them; what else is on ``(point,)`` are
        springs. Other models and points than the wanted ones are passed over.
    labels
        Name in the batches -> name in the result's dimension ``model``, in the wanted order.

    Returns
    -------
    xarray.Dataset
        `study` with the outputs on ``(model, axes...)`` and the springs on ``(axes...)``.

    Raises
    ------
    DataError
        A point of a method is missing.
    """
    canvas = Canvas(study, labels)
    for batch in batches:
        canvas.add(batch)
    return canvas.dataset()
