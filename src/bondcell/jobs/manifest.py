"""The manifest of a scene's batches: which points are in which file, also before they are computed.

One small file a batch, written once under the batch's name and never changed: adding to the study
adds files. The name follows from the content, so an entry that was damaged is noticed; one that was
lost comes back from the batch's own file, which carries its points.
"""

from __future__ import annotations

import json
import zipfile
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from bondcell.cell import UNITS, Cell
from bondcell.errors import DataError, Violation
from bondcell.jobs.batch import NAME, Batch, batch_name
from bondcell.jobs.point_hash import Hashes
from bondcell.jobs.rows import Row
from bondcell.replacing import replacing

FOLDER = "manifest"
"""Folder of the entries, beside the batches."""

_UNREADABLE = (OSError, ValueError, KeyError, EOFError, zipfile.BadZipFile)


@dataclass(frozen=True)
class Entry:
    """What the manifest knows of a batch."""

    name: str
    rows: tuple[Row, ...]
    hashes: Hashes


def entry_path(batches: str | Path, name: str) -> Path:
    """File of a batch's entry."""
    return Path(batches) / FOLDER / f"{name}.npz"


def read_manifest(batches: str | Path) -> list[Entry]:
    """Every sound entry, sorted by name.

    Parameters
    ----------
    batches
        Folder of the batches.
    """
    return list(_sound(sorted((Path(batches) / FOLDER).glob("[!.]*.npz"))))


def record(batches: str | Path, new: Iterable[Batch]) -> None:
    """Add batches to the manifest; what is there stays as it is.

    Parameters
    ----------
    batches
        Folder of the batches.
    new
        Batches; one that is known already is left alone.
    """
    for batch in new:
        path = entry_path(batches, batch.name)
        if next(_sound([path]), None) is None:
            with replacing(path) as temporary, temporary.open("wb") as file:
                np.savez(file, **_arrays(batch))


def read_entry(path: str | Path) -> Batch:
    """The batch of an entry, all of it.

    Parameters
    ----------
    path
        See `entry_path`.

    Raises
    ------
    DataError
        There is no such entry, or it is damaged.
    """
    entry = next(_sound([Path(path)]), None)
    if entry is None:
        allowed = "a sound entry of the manifest: run snakemake again, it is written again"
        raise DataError([Violation("file", str(path), allowed)], str(path))
    with np.load(path) as content:
        size = (len(entry.hashes),)
        inputs = {name: np.broadcast_to(content[name], size) for name in UNITS}
    batch = Batch(entry.rows, Cell(**inputs))
    if batch.name != entry.name:
        raise DataError([Violation("points", batch.name, f"those of {entry.name}")], str(path))
    return batch


def lost_entries(batches: str | Path, entries: Iterable[Entry]) -> list[Path]:
    """Files of batches that the entries do not tell of, sorted.

    Parameters
    ----------
    batches
        Folder of the batches.
    entries
        What is known.
    """
    known = {entry.name for entry in entries}
    files = sorted(Path(batches).glob("*.nc"))
    return [path for path in files if NAME.fullmatch(path.stem) and path.stem not in known]


def _arrays(batch: Batch) -> dict[str, Any]:
    """Rows, hashes and inputs, of an input that does not vary a single value."""
    values = {name: getattr(batch.points, name) for name in UNITS}
    inputs = {
        name: value[:1] if value.size and np.all(value == value[0]) else value
        for name, value in values.items()
    }
    return {"rows": np.array(batch.rows_json.encode()), "hashes": batch.hashes, **inputs}


def _sound(paths: Iterable[Path]) -> Iterator[Entry]:
    for path in paths:
        try:
            with path.open("rb") as file, np.load(file) as content:
                rows = tuple(Row.from_list(row) for row in json.loads(content["rows"].item()))
                entry = Entry(path.stem, rows, content["hashes"])
        except _UNREADABLE:
            continue
        if batch_name(entry.rows, entry.hashes) == entry.name:
            yield entry
