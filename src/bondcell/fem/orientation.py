"""Directed edges for quadrilaterals, so that odd edge functions agree from both sides."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Key = frozenset[int]


def orient(quads: NDArray[np.int64]) -> NDArray[np.int64]:
    """Turn or mirror each quadrilateral so that shared edges run the same way in both elements.

    The hierarchical functions of an edge are odd or even along it. Opposite edges of an element run
    parallel in its reference square, so a direction chosen on one edge propagates through a whole
    strip of elements; in a planar mesh no strip is a Moebius band, hence a choice always exists.

    Parameters
    ----------
    quads
        Vertex numbers counter-clockwise, shape (elements, 4).

    Returns
    -------
    numpy.ndarray
        The same elements with vertices reordered: edges 0-1 and 3-2 are directed alike, as are
        0-3 and 1-2, and each directed edge is the same in all elements that own it.
    """
    start = _edge_starts(quads)
    oriented = np.empty_like(quads)
    for row, quad in enumerate(quads):
        for turn in range(4):
            v0, v1, v2, v3 = np.roll(quad, -turn)
            if start[frozenset((v0, v1))] == v0 and start[frozenset((v0, v3))] == v0:
                oriented[row] = v0, v1, v2, v3
                break
    return oriented


def _edge_starts(quads: NDArray[np.int64]) -> dict[Key, int]:
    owners: dict[Key, list[int]] = {}
    for row, quad in enumerate(quads):
        for a, b in zip(quad, np.roll(quad, -1), strict=True):
            owners.setdefault(frozenset((int(a), int(b))), []).append(row)
    start: dict[Key, int] = {}
    for edge in owners:
        if edge in start:
            continue
        start[edge] = min(edge)
        strip = [edge]
        while strip:
            current = strip.pop()
            tail = start[current]
            for row in owners[current]:
                opposite, opposite_tail = _across(quads[row], current, tail)
                if opposite not in start:
                    start[opposite] = opposite_tail
                    strip.append(opposite)
    return start


def _across(quad: NDArray[np.int64], edge: Key, tail: int) -> tuple[Key, int]:
    """Opposite edge of ``edge`` in ``quad``, and the vertex that faces ``tail``."""
    ring = [int(vertex) for vertex in quad]
    opposite = frozenset(ring) - edge
    position = ring.index(tail)
    neighbours = {ring[position - 1], ring[(position + 1) % 4]}
    (facing,) = neighbours & opposite
    return opposite, facing
