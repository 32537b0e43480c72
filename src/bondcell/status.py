"""What became of a point: the flag variable ``status`` of every result."""

from __future__ import annotations

from enum import IntEnum
from typing import Any

import numpy as np


class Status(IntEnum):
    """Outcome of one point; 0 is good, the value is NaN from ``limit_exceeded`` on."""

    ok = 0
    outside_valid_range = 1
    tolerance_not_met = 2
    limit_exceeded = 3
    solver_failed = 4
    mesh_failed = 5
    diverges = 6
    not_computed = 7

    @property
    def has_value(self) -> bool:
        """Whether a point with this flag carries a number."""
        return self < Status.limit_exceeded


def cf_flag_attributes() -> dict[str, Any]:
    """CF attributes that make the flag variable readable without this package."""
    return {
        "long_name": "outcome of the point",
        "flag_values": np.array([status.value for status in Status], dtype=np.int8),
        "flag_meanings": " ".join(status.name for status in Status),
    }
