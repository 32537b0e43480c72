"""Files that appear under their name only when they are complete."""

from __future__ import annotations

import errno
import glob
import os
import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from bondcell.errors import CannotWrite


@contextmanager
def replacing(path: str | Path) -> Iterator[Path]:
    """A temporary name beside `path` that takes its place when the block ends well.

    The content is on the disk before it gets its name. What killed writers of the same file left
    behind is removed.

    Raises
    ------
    CannotWrite
        The disk or the folder refuses.

    Examples
    --------
    >>> import tempfile
    >>> target = Path(tempfile.mkdtemp()) / "table.csv"
    >>> with replacing(target) as temporary:
    ...     _ = temporary.write_text("gap,stiffness")
    ...     target.exists()
    False
    >>> target.read_text()
    'gap,stiffness'
    """
    target = Path(path)
    temporary = target.with_name(f".{target.name}.{os.getpid()}.tmp")
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
        for left in target.parent.glob(f".{glob.escape(target.name)}.*.tmp"):
            left.unlink(missing_ok=True)
        yield temporary
        _flush(temporary)
        os.replace(temporary, target)
    except OSError as error:
        if error.errno not in _REFUSALS:
            raise
        raise CannotWrite(refusal(target, error)) from error
    finally:
        if temporary.exists():  # a read-only folder refuses to delete even what is not there
            temporary.unlink()


_REFUSALS = {
    getattr(errno, name)
    for name in ("EACCES", "EDQUOT", "EFBIG", "EIO", "ENOSPC", "EPERM", "EROFS")
    if hasattr(errno, name)
}


def _flush(path: Path) -> None:
    """Have a file's content on the disk, so that no crash leaves an empty file under its name."""
    with path.open("rb+") as file:
        os.fsync(file.fileno())


def refusal(target: Path, error: Exception) -> str:
    """Why a file cannot be written, with the space that is left.

    The netCDF library says "permission denied" of a full disk: so a plain file is tried.
    """
    folder = next(place for place in target.absolute().parents if place.is_dir())
    reason = str(error)
    try:
        with tempfile.TemporaryFile(dir=folder) as probe:
            probe.write(bytes(_PROBE))
    except OSError as plain:
        reason = os.strerror(plain.errno or 0)
    free = shutil.disk_usage(folder).free / 1e6
    return f"{target} cannot be written: {reason} ({free:.3g} MB are free there)"


_PROBE = 1 << 18
"""Bytes written to learn why a disk refuses."""
