"""A batch: points at which one job computes some rows of a scene's results, in one file."""

from __future__ import annotations

import json
import re
from dataclasses import dataclass
from functools import cached_property
from hashlib import blake2b

import numpy as np

from bondcell.cell import Cell
from bondcell.jobs.point_hash import SCHEME, Hashes, point_hashes
from bondcell.jobs.rows import KINDS, Row

NAME = re.compile(rf"(?:{'|'.join(KINDS)})_[a-z]+_[0-9a-f]{{16}}")
"""Names of batches."""


@dataclass(frozen=True)
class Batch:
    """Rows of one kind and load at points.

    Parameters
    ----------
    rows
        At least one.
    points
        A raveled cell; those of a finite element batch that share a geometry share a mesh.

    Examples
    --------
    >>> base = Cell.from_values(
    ...     radius_i=7.5e-3,
    ...     gap=5e-4,
    ...     young_i=3e10,
    ...     young_m=1.4e6,
    ...     poisson_i=0.25,
    ...     poisson_m=0.46,
    ... )
    >>> Batch((Row("analytic", "normal", "fsi"),), base.ravel()).name
    'analytic_normal_040953f7f0cd06f8'
    """

    rows: tuple[Row, ...]
    points: Cell

    @property
    def load(self) -> str:
        """Load of all rows."""
        return self.rows[0].load

    @property
    def models(self) -> tuple[str, ...]:
        """Models of the rows."""
        return tuple(row.model for row in self.rows)

    @property
    def rows_json(self) -> str:
        """The rows as JSON text."""
        return json.dumps([row.as_list() for row in self.rows])

    @cached_property
    def hashes(self) -> Hashes:
        """Hashes of the points, shape (points, 2)."""
        return point_hashes(self.points)

    @cached_property
    def name(self) -> str:
        """Name of the batch and stem of its file: it follows from rows and points alone."""
        return batch_name(self.rows, self.hashes)


def batch_name(rows: tuple[Row, ...], hashes: Hashes) -> str:
    """Name of the batch of some rows at points of these hashes.

    Parameters
    ----------
    rows
        The rows.
    hashes
        Shape (points, 2).
    """
    key = blake2b(digest_size=8, person=f"bondcell batch {SCHEME}".encode())
    key.update(json.dumps([row.as_list() for row in rows]).encode())
    key.update(np.ascontiguousarray(hashes, dtype="<u8").tobytes())
    return f"{rows[0].file_prefix}_{key.hexdigest()}"
