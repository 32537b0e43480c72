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
    rings = [[int(vertex) for vertex in quad] for quad in quads]
    start = _edge_starts(rings)
    oriented = []
    for ring in rings:
        for turn in range(4):
            v0, v1, v2, v3 = ring[turn:] + ring[:turn]
            if start[frozenset((v0, v1))] == v0 and start[frozenset((v0, v3))] == v0:
                oriented.append((v0, v1, v2, v3))
                break
    return np.array(oriented, dtype=np.int64)


def _edge_starts(rings: list[list[int]]) -> dict[Key, int]:
    owners: dict[Key, list[int]] = {}
    for row, ring in enumerate(rings):
        for a, b in zip(ring, ring[1:] + ring[:1], strict=True):
            owners.setdefault(frozenset((a, b)), []).append(row)
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
                opposite, opposite_tail = _across(rings[row], current, tail)
                if opposite not in start:
                    start[opposite] = opposite_tail
                    strip.append(opposite)
    return start


def _across(ring: list[int], edge: Key, tail: int) -> tuple[Key, int]:
    """Opposite edge of ``edge`` in ``ring``, and the vertex that faces ``tail``."""
    opposite = frozenset(ring) - edge
    position = ring.index(tail)
    neighbours = {ring[position - 1], ring[(position + 1) % 4]}
    (facing,) = neighbours & opposite
    return opposite, facing
