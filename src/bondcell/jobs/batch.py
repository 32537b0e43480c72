"""A batch: the share of a scene's points that one job computes and one file holds."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bondcell.by_geometry import geometry_groups
from bondcell.cell import Cell, FloatArray
from bondcell.errors import InputError, Violation

ANALYTIC = "analytic"
"""Method of a batch of analytic models; one of another load than the first ends in its name."""

REFERENCE = "fe"
"""Method of a batch of the reference, followed by boundary condition or load."""


RELAXATION = "relaxation"
"""Method of a batch of relaxation, followed by ``models`` or ``fe`` and the load."""


@dataclass(frozen=True)
class Batch:
    """Every `parts`-th item of a scene's work, beginning with item `part` - 1.

    The items of an analytic batch are points; those of a finite element batch are geometries with
    all their points, since these share a mesh. Strided, so that the costly narrow gaps at one end
    of an axis are spread over the batches.

    Examples
    --------
    >>> Batch("fe_roller", 1, 2).name
    'fe_roller_1of2'
    >>> Batch.parse("fe_roller_1of2")
    Batch(method='fe_roller', part=1, parts=2)
    """

    method: str
    part: int = 1
    parts: int = 1

    @property
    def name(self) -> str:
        """Name of the batch and stem of its file."""
        return f"{self.method}_{self.part}of{self.parts}"

    @classmethod
    def parse(cls, name: str) -> Batch:
        """The batch of a name."""
        match = re.fullmatch(r"([a-z][a-z0-9_]*)_([1-9][0-9]*)of([1-9][0-9]*)", name)
        if match is None or int(match[2]) > int(match[3]):
            raise InputError([Violation("batch", name, "<method>_<part>of<parts>")])
        return cls(match[1], int(match[2]), int(match[3]))

    def points(self, cell: Cell) -> NDArray[np.int64]:
        """Positions of the batch's points in the raveled cell, ascending."""
        if self.method.split("_")[0] == ANALYTIC:
            return np.arange(self.part - 1, math.prod(cell.shape), self.parts)
        groups = list(geometry_groups(cell.ravel()))[self.part - 1 :: self.parts]
        return np.sort(np.concatenate([*groups, np.empty(0, dtype=np.int64)]))


def cell_at(cell: Cell, positions: NDArray[np.int64]) -> Cell:
    """The points of a cell at positions in its raveled order, without raveling all of it.

    Parameters
    ----------
    cell
        Fields aligned to common dimensions, as `bondcell.inputs.cell_from_study` gives them.
    positions
        Shape (points,).
    """
    index = np.unravel_index(positions, cell.shape) if cell.shape else ()

    def at(value: FloatArray) -> FloatArray:
        varying = (i if size > 1 else 0 for i, size in zip(index, value.shape, strict=True))
        return np.broadcast_to(value[tuple(varying)], positions.shape)

    return Cell(**{name: at(value) for name, value in cell.as_dict().items()})
