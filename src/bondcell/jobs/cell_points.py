"""Single points of a cell whose inputs stand on axes."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from bondcell.cell import Cell, FloatArray


def cell_at(cell: Cell, positions: NDArray[np.int64]) -> Cell:
    """The points of a cell at positions in its raveled order, without raveling all of it.

    Parameters
    ----------
    cell
        Fields that broadcast against each other.
    positions
        Shape (points,).

    Examples
    --------
    >>> moduli = {"young_i": 3e10, "young_m": 1e6, "poisson_i": 0.2}
    >>> cell = Cell.from_values(
    ...     radius_i=1.0, gap=[[0.1], [0.2]], poisson_m=[0.3, 0.4], **moduli
    ... )
    >>> cell_at(cell, np.array([3, 0])).gap
    array([0.2, 0.1])
    """
    shape = cell.shape
    index = np.unravel_index(positions, shape) if shape else ()

    def at(value: FloatArray) -> FloatArray:
        aligned = value.reshape((1,) * (len(shape) - value.ndim) + value.shape)
        varying = (i if size > 1 else 0 for i, size in zip(index, aligned.shape, strict=True))
        return np.broadcast_to(aligned[tuple(varying)], positions.shape)

    return Cell(**{name: at(value) for name, value in cell.as_dict().items()})
