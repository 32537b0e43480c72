"""What makes two points the same: a hash of their inputs in canonical form."""

from __future__ import annotations

from collections.abc import Iterator
from hashlib import blake2b
from math import prod

import numpy as np
from numpy.typing import NDArray

from bondcell.cell import UNITS, Cell
from bondcell.jobs.cell_points import cell_at

SCHEME = 1
"""Version of the canonical form and of the hash; another one is another identity."""

Hashes = NDArray[np.uint64]

_BYTES = 16
_MARK = f"bondcell point {SCHEME}".encode()
_CHUNK = 100_000


def point_hashes(cell: Cell) -> Hashes:
    """Hash of every point of a cell, in its raveled order.

    Parameters
    ----------
    cell
        Fields that broadcast against each other.

    Returns
    -------
    numpy.ndarray
        Shape (points, 2): 128 bits a point.

    Notes
    -----
    The canonical form of a point is its ten inputs [SI] in the order of `bondcell.cell.UNITS`, as
    little-endian doubles, with defaults filled in, ratios replaced by what they set, and no
    negative zero. How a value was written and on which axis it stands do not matter, its last bit
    does. The hash is BLAKE2b, personalised with the version of this scheme.

    Examples
    --------
    >>> moduli = {"young_i": 3e10, "young_m": 1e6, "poisson_i": 0.2}
    >>> one = Cell.from_values(radius_i=0.0075, gap=1e-3, poisson_m=0.0, **moduli)
    >>> two = Cell.from_values(radius_i=7.5e-3, gap=[2e-3, 0.001], poisson_m=-0.0, **moduli)
    >>> (point_hashes(one) == point_hashes(two)).all(axis=1)
    array([False,  True])
    """
    digests = b"".join(_digests(cell))
    return np.frombuffer(digests, dtype="<u8").astype(np.uint64).reshape(-1, 2)


def _digests(cell: Cell) -> Iterator[bytes]:
    points = prod(cell.shape)
    width = 8 * len(UNITS)
    for start in range(0, points, _CHUNK):
        part = cell_at(cell, np.arange(start, min(start + _CHUNK, points)))
        rows = np.column_stack([getattr(part, name) for name in UNITS]) + 0.0  # no negative zero
        content = memoryview(rows.astype("<f8").tobytes())
        for at in range(0, len(content), width):
            yield blake2b(content[at : at + width], digest_size=_BYTES, person=_MARK).digest()


class HashIndex:
    """Where each of many hashes stands.

    Parameters
    ----------
    hashes
        Shape (points, 2).

    Examples
    --------
    >>> index = HashIndex(np.array([[7, 1], [3, 2], [7, 1]], dtype=np.uint64))
    >>> index.find(np.array([[3, 2], [7, 1], [7, 5]], dtype=np.uint64))
    array([ 1,  0, -1])
    """

    def __init__(self, hashes: Hashes) -> None:
        self._order = np.lexsort((hashes[:, 1], hashes[:, 0]))  # stable: first occurrence first
        self._sorted = hashes[self._order]

    def find(self, wanted: Hashes) -> NDArray[np.int64]:
        """Position of the first equal hash, -1 where there is none; shape (wanted,)."""
        found = np.full(len(wanted), -1, dtype=np.int64)
        at = np.searchsorted(self._sorted[:, 0], wanted[:, 0])
        waiting = np.arange(len(wanted))
        while waiting.size:  # more than once only where different hashes begin alike
            waiting = waiting[at[waiting] < len(self._sorted)]
            here = self._sorted[at[waiting]]
            alike = here[:, 0] == wanted[waiting, 0]
            equal = alike & (here[:, 1] == wanted[waiting, 1])
            found[waiting[equal]] = self._order[at[waiting[equal]]]
            waiting = waiting[alike & ~equal]
            at[waiting] += 1
        return found
