"""What a three-dimensional solution will take, said before the long work."""

from __future__ import annotations

import os
from pathlib import Path

from bondcell.errors import InputError, Violation

BYTES_PER_ELEMENT = {2: 10_000, 3: 60_000, 4: 150_000}
"""Peak of mesh, matrices, multigrid and vectors, by order; measured by the specimen's benchmark."""


def predicted_memory(elements: int, order: int = 2) -> int:
    """Peak memory of an elastic solution with so many tetrahedra [bytes]."""
    return BYTES_PER_ELEMENT[order] * elements


def free_memory() -> float:
    """Memory that the machine could give now [bytes]; without bound where it does not say.

    On Linux what the kernel calls available: free, or given back by its caches when asked.
    """
    try:
        lines = Path("/proc/meminfo").read_text(encoding="ascii").splitlines()
        (available,) = (line.split()[1] for line in lines if line.startswith("MemAvailable:"))
        return 1024 * float(available)
    except (OSError, ValueError):
        pass
    try:
        return float(os.sysconf("SC_AVPHYS_PAGES") * os.sysconf("SC_PAGE_SIZE"))
    except (AttributeError, OSError, ValueError):
        return float("inf")


def check_memory(elements: int, limit: float | None = None, order: int = 2) -> None:
    """Refuse a mesh that would not fit.

    Raises
    ------
    InputError
        The predicted memory exceeds ``limit`` [bytes], by default `free_memory`.

    Examples
    --------
    >>> check_memory(1000, limit=1e9)
    """
    needed = predicted_memory(elements, order)
    allowed = free_memory() if limit is None else limit
    if needed > allowed:
        raise InputError(
            [
                Violation(
                    "elements",
                    elements,
                    f"what fits into {allowed / 1e9:.1f} GB; these take about "
                    f"{needed / 1e9:.1f} GB: choose larger elements",
                )
            ]
        )
