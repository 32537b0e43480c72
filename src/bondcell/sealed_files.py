"""Files that end in a checksum of themselves: a changed or shortened one is noticed.

The seal is a line after the last byte of the file proper. netCDF and HDF5 know where their content
ends and read such a file as any other.
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterator
from pathlib import Path

MARK = b"\nsha256 "
_LENGTH = len(MARK) + 64 + 1
_BLOCK = 1 << 20


def seal(path: str | Path) -> None:
    """Append the checksum of a file to it.

    Parameters
    ----------
    path
        A complete file without a seal.
    """
    target = Path(path)
    line = _line(target, target.stat().st_size)
    with target.open("ab") as file:
        file.write(line)


def is_whole(path: str | Path) -> bool:
    """Whether a file ends in the checksum of all that comes before.

    Parameters
    ----------
    path
        An existing file.

    Examples
    --------
    >>> import tempfile
    >>> file = Path(tempfile.mkdtemp()) / "batch.nc"
    >>> _ = file.write_bytes(b"results")
    >>> is_whole(file)
    False
    >>> seal(file)
    >>> is_whole(file)
    True
    >>> _ = file.write_bytes(file.read_bytes().replace(b"s", b"z", 1))
    >>> is_whole(file)
    False
    """
    source = Path(path)
    content = source.stat().st_size - _LENGTH
    if content < 0:
        return False
    with source.open("rb") as file:
        file.seek(content)
        found = file.read()
    return found.startswith(MARK) and found == _line(source, content)


def damaged_batches(results: str | Path) -> list[Path]:
    """Batch files of all scenes that lost their seal or do not match it, sorted.

    Parameters
    ----------
    results
        The folder of the scenes' results.
    """
    return sorted(path for path in _batches(Path(results)) if not is_whole(path))


def _batches(results: Path) -> Iterator[Path]:
    return (path for path in results.glob("*/batches/[!.]*.nc") if path.is_file())


def _line(path: Path, size: int) -> bytes:
    """What the seal of the first `size` bytes of a file reads."""
    digest = hashlib.sha256()
    with path.open("rb") as file:
        while size > 0 and (block := file.read(min(size, _BLOCK))):
            digest.update(block)
            size -= len(block)
    return MARK + digest.hexdigest().encode() + b"\n"
