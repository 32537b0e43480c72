"""Files that commands write."""

from __future__ import annotations

from pathlib import Path

from bondcell.errors import Violation


def overwritten(target: str, *sources: str) -> list[Violation]:
    """The violation of writing over a file that is read, by whatever name.

    Examples
    --------
    >>> overwritten("both.nc", "one.nc", "other.nc")
    []
    """
    read = [Path(source) for source in sources]
    if not any(Path(target).exists() and p.exists() and p.samefile(target) for p in read):
        return []
    return [Violation("-o", target, "another file than those that are read")]
