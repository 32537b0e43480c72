"""Files of batches: sealed with what they were computed for, refused if that is another thing."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import xarray as xr

from bondcell import provenance
from bondcell.cell import UNITS, Cell
from bondcell.errors import DataError, Violation
from bondcell.jobs.batch import Batch
from bondcell.jobs.rows import Row
from bondcell.sealed_files import is_whole
from bondcell.status import Status
from bondcell.storage import read_dataset, write_dataset

SEAL = "digest"


def write_batch(dataset: xr.Dataset, path: str | Path, digest: str) -> None:
    """Store a batch with the digest of its parameters and the machine that computed it.

    Parameters
    ----------
    dataset
        Results of the batch.
    path
        The file.
    digest
        Identity of the parameters.
    """
    about = {SEAL: digest, **provenance.machine()}
    write_dataset(dataset.assign_attrs(about), path, sealed=True)


def read_batch(path: str | Path, digest: str) -> xr.Dataset:
    """Read a batch that was computed for these parameters, every bit as it was written.

    Raises
    ------
    DataError
        The file is damaged, or was computed for other parameters.
    """
    if Path(path).is_file() and not is_whole(path):
        allowed = "a batch that matches its checksum: run again, it will be computed again"
        raise DataError([Violation("file", str(path), allowed)], str(path))
    batch = read_dataset(path)
    sealed = batch.attrs.get(SEAL)
    if sealed != digest:
        allowed = f"{digest}: delete the file to compute it again"
        raise DataError([Violation(SEAL, sealed, allowed)], str(path))
    return batch


def read_point_batch(path: str | Path) -> xr.Dataset:
    """Read a batch of points, which is sealed with its name."""
    return read_batch(path, Path(path).stem)


def batch_of(results: xr.Dataset) -> Batch:
    """The batch that a file's content answers.

    Parameters
    ----------
    results
        With the inputs and the attribute ``rows``, see `bondcell.jobs.batch_results.about_batch`.
    """
    rows = tuple(Row.from_list(row) for row in json.loads(results.attrs["rows"]))
    return Batch(rows, Cell(**{name: results[name].values for name in UNITS}))


def recovered(path: str | Path) -> Batch | None:
    """The batch of a file whose entry in the manifest was lost; None if the file is no such."""
    try:
        batch = batch_of(read_point_batch(path))
    except (DataError, KeyError, ValueError):
        return None
    return batch if batch.name == Path(path).stem else None


def describe(batch: xr.Dataset) -> str:
    """How many of a batch's points have a value, and what became of the others.

    Examples
    --------
    >>> describe(xr.Dataset({"status": (("model", "point"), np.array([[0, 0, 6, 1]]))}))
    '3/4 points, diverges: 1'
    """
    status = batch["status"].values
    codes, counts = np.unique(status, return_counts=True)
    found = dict(zip((Status(int(code)) for code in codes), counts.tolist(), strict=True))
    good = sum(count for flag, count in found.items() if flag.has_value)
    failed = [f"{flag.name}: {count}" for flag, count in found.items() if not flag.has_value]
    return ", ".join([f"{good}/{status.size} points", *failed])
