"""Datasets in files: written whole or not at all, read whole or refused."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import netCDF4
import numpy as np
import xarray as xr

from bondcell.errors import CannotWrite, DataError, Violation
from bondcell.replacing import refusal
from bondcell.replacing import replacing as replacing
from bondcell.sealed_files import seal

CONVENTIONS = "CF-1.11"
READABLE = "a complete netCDF-4 file"

LARGEST_CHUNK = 1 << 17
"""Values that are compressed and read together at most: a megabyte."""


def write_dataset(
    dataset: xr.Dataset,
    path: str | Path,
    groups: Mapping[str, xr.Dataset] | None = None,
    sealed: bool = False,
) -> Path:
    """Write a dataset to a compressed netCDF-4 file that appears under its name only when complete.

    Parameters
    ----------
    dataset
        The root group; gets the CF attributes ``Conventions`` and ``history``.
    path
        The file; its folder is made if need be, an existing file is replaced.
    groups
        More datasets, each stored in the netCDF group of its name.
    sealed
        Whether the file ends in a checksum of itself, see `bondcell.sealed_files`.

    Returns
    -------
    pathlib.Path
        `path`.

    Raises
    ------
    CannotWrite
        No space, no permission: nothing is left behind, an existing file stays as it was.

    Examples
    --------
    >>> import tempfile
    >>> folder = Path(tempfile.mkdtemp())
    >>> path = write_dataset(xr.Dataset({"gap": ("gap", [1e-4, 2e-4])}), folder / "study.nc")
    >>> read_dataset(path).gap.values
    array([0.0001, 0.0002])
    """
    target = Path(path)
    with replacing(target) as temporary:
        root = dataset.assign_attrs({**_root_attributes(dataset), **dataset.attrs})
        _write_group(root, temporary, None)
        for name, group in (groups or {}).items():
            _write_group(group, temporary, name)
        if sealed:
            seal(temporary)
    return target


def read_dataset(path: str | Path, group: str | None = None) -> xr.Dataset:
    """Read a whole dataset into memory, so that a damaged file is noticed here and not later.

    Parameters
    ----------
    path
        A file that `write_dataset` made; every stored block carries a checksum, which is verified.
    group
        Name of the netCDF group, the root group by default.

    Raises
    ------
    DataError
        The file is missing, half-written, damaged or has no such group.
    """
    source = Path(path)
    if not source.is_file():
        raise DataError([Violation("file", str(source), "an existing file")], str(source))
    try:
        with xr.open_dataset(source, engine="netcdf4", group=group) as dataset:
            return _with_plain_text(dataset.load())
    except (OSError, RuntimeError, ValueError, KeyError, AttributeError, IndexError) as error:
        missing_group = isinstance(error, OSError) and "group not found" in str(error)
        field = "group" if missing_group else "file"
        value = group if missing_group else str(source)
        allowed = "a group of the file" if missing_group else f"{READABLE} ({error})"
        raise DataError([Violation(field, value, allowed)], str(source)) from error


def group_names(path: str | Path) -> list[str]:
    """Names of the groups of a file, one below the other ones joined by ``/``.

    Parameters
    ----------
    path
        A file that `write_dataset` made.

    Raises
    ------
    DataError
        The file is missing or damaged.
    """
    source = Path(path)
    if not source.is_file():
        raise DataError([Violation("file", str(source), "an existing file")], str(source))
    try:
        with netCDF4.Dataset(source) as file:
            return list(_below(file))
    except (OSError, RuntimeError) as error:
        allowed = f"{READABLE} ({error})"
        raise DataError([Violation("file", str(source), allowed)], str(source)) from error


def _below(group: Any) -> Iterator[str]:
    for name, inner in group.groups.items():
        yield name
        yield from (f"{name}/{deeper}" for deeper in _below(inner))


def _write_group(dataset: xr.Dataset, path: Path, group: str | None) -> None:
    try:
        _to_netcdf(dataset, path, group)
    except RuntimeError as error:  # the library's word for all that the disk refuses
        raise CannotWrite(refusal(path, error)) from error


def _root_attributes(dataset: xr.Dataset) -> dict[str, str]:
    """What CF wants of a file; no time of day, so that the same content is the same file."""
    source = dataset.attrs.get("source", "bondcell")
    revision = dataset.attrs.get("source_revision")
    written = f"written by {source}" + (f", revision {revision}" if revision else "")
    return {"Conventions": CONVENTIONS, "history": written}


def _to_netcdf(dataset: xr.Dataset, path: Path, group: str | None) -> None:
    # What the dataset's variables remember of files they were read from does not count.
    dataset.drop_encoding().to_netcdf(
        path,
        mode="a" if group else "w",
        format="NETCDF4",
        engine="netcdf4",
        group=group,
        encoding={str(name): _encoding(dataset, str(name)) for name in dataset.variables},
    )


def _encoding(dataset: xr.Dataset, name: str) -> dict[str, Any]:
    """Types every reader knows, compression and checksums.

    Text is stored as characters, since a coordinate of variable-length strings is refused by old
    readers and by CF; whole numbers in 32 bits where they fit. NaN marks a missing value, but
    never in a coordinate.
    """
    variable = dataset.variables[name]
    if variable.dtype.kind in "OU":
        return {"dtype": "S1"}
    encoding: dict[str, Any] = {}
    if variable.dtype.kind not in "iuf":
        return encoding
    if variable.dtype.kind != "f" or name in dataset.coords:
        encoding["_FillValue"] = None
    if variable.dtype.kind in "iu" and variable.dtype.itemsize > 4 and _fits(variable.values):
        encoding["dtype"] = "int32"
    if variable.ndim:
        encoding |= {"zlib": True, "complevel": 4, "shuffle": True, "fletcher32": True}
    if variable.size > LARGEST_CHUNK:
        encoding["chunksizes"] = chunk_shape(variable.shape)
    return encoding


def chunk_shape(shape: tuple[int, ...]) -> tuple[int, ...]:
    """Shape of the blocks of a large array: some models at some points can be read alone.

    Examples
    --------
    >>> chunk_shape((4, 1_000_000)), chunk_shape((4, 300, 1000))
    ((1, 131072), (1, 131, 1000))
    """
    left, chunks = LARGEST_CHUNK, []
    for size in reversed(shape):
        chunks.append(max(1, min(size, left)))
        left //= chunks[-1]
    return tuple(reversed(chunks))


def _fits(values: np.ndarray) -> bool:
    """Whether whole numbers can be stored in 32 bits."""
    bounds = np.iinfo(np.int32)
    return not values.size or bool(bounds.min <= values.min() and values.max() <= bounds.max)


def _with_plain_text(dataset: xr.Dataset) -> xr.Dataset:
    """Text as numpy's own type, as it was before it was written as characters."""
    text = [
        name
        for name, variable in dataset.variables.items()
        if variable.dtype == object and "char_dim_name" in variable.encoding
    ]
    return dataset.assign({name: dataset[name].astype(str) for name in text})
