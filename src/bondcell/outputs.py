"""What an evaluation gives at each point: names, units and the arrays themselves."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bondcell.cell import FloatArray
from bondcell.status import Status, cf_flag_attributes

OUTPUTS = ("stiffness", "error_estimate", "status", "dof", "seconds")
"""Variables that every evaluation gives."""

DETAILS = {"order": 0, "way": 3, "reduction_error": 0.0, "coupling": np.nan}
"""Variables that only the finite element reference gives -> what stands for them elsewhere."""

WAYS = ("direct", "reduced_basis", "spectrum", "closed_form")
"""Meanings of the flag variable ``way``: how a value was found."""

TIME = {"units": "s", "long_name": "time since the step"}
"""Attributes of the axis ``time``."""

FREQUENCY = {"units": "rad s-1", "long_name": "angular frequency"}
"""Attributes of the axis ``frequency``."""

STIFFNESS_UNITS = {
    "normal": "N m-1",
    "shear": "N m-1",
    "torsion": "N m rad-1",
    "bending": "N m rad-1",
}
"""Unit of the stiffness under each load."""


@dataclass(frozen=True)
class PointResults:
    """The `OUTPUTS` as arrays of one common shape.

    Parameters
    ----------
    stiffness
        Stiffness [N/m for the normal load], NaN where it failed.
    error_estimate
        Relative numerical error of `stiffness`.
    status
        `Status` codes.
    dof
        Unknowns of the finest solve, 0 for a closed form.
    seconds
        Wall time spent on the point, its share of the geometry's assembly included [s].
    details
        Those of `DETAILS` that were found.
    failures
        One line for each geometry that failed.
    """

    stiffness: FloatArray
    error_estimate: FloatArray
    status: NDArray[np.int8]
    dof: NDArray[np.int64]
    seconds: FloatArray
    details: dict[str, NDArray[Any]] = field(default_factory=dict)
    failures: list[str] = field(default_factory=list)

    @classmethod
    def empty(cls, shape: int | tuple[int, ...]) -> PointResults:
        """Results of which none has been computed yet."""
        return cls(
            stiffness=np.full(shape, np.nan),
            error_estimate=np.full(shape, np.nan),
            status=np.full(shape, Status.not_computed, dtype=np.int8),
            dof=np.zeros(shape, dtype=np.int64),
            seconds=np.full(shape, np.nan),
        )

    def detail(self, name: str) -> NDArray[Any]:
        """One of `DETAILS`; where it was not found, what stands for it."""
        if name not in self.details:
            kind = {"order": np.int64, "way": np.int8}.get(name, np.float64)
            self.details[name] = np.full(self.stiffness.shape, DETAILS[name], dtype=kind)
        return self.details[name]


def detail_names(load: str) -> tuple[str, ...]:
    """Those of `DETAILS` that the reference gives under a load."""
    return tuple(name for name in DETAILS if name != "coupling" or load == "bending")


def output_attributes(load: str) -> dict[str, dict[str, Any]]:
    """CF attributes of each of `OUTPUTS` and `DETAILS` under a load."""
    return {
        "stiffness": {
            "units": STIFFNESS_UNITS[load],
            "long_name": f"{load} stiffness of the bond",
            "ancillary_variables": "status error_estimate",
        },
        "error_estimate": {"units": "1", "long_name": "relative numerical error of the stiffness"},
        "status": cf_flag_attributes(),
        "dof": {"units": "1", "long_name": "degrees of freedom"},
        "seconds": {"units": "s", "long_name": "wall time per point"},
        "order": {"units": "1", "long_name": "polynomial order of the finest solve"},
        "way": {
            "long_name": "how the value was found",
            "flag_values": np.arange(len(WAYS), dtype=np.int8),
            "flag_meanings": " ".join(WAYS),
        },
        "reduction_error": {
            "units": "1",
            "long_name": "part of the error estimate that a reduced basis added",
        },
        "coupling": {
            "units": "N rad-1",
            "long_name": "force across the axis for a unit rotation of end plane j",
        },
    }


def part_attributes(part: str, model: str, load: str) -> dict[str, str]:
    """CF attributes of one of a model's own springs."""
    return {"units": STIFFNESS_UNITS[load], "long_name": f"spring {part} of model {model}"}
