"""Few points of a sweep that climb the ladder of orders for all of them.

Points of one geometry err alike, and smoothly in their materials. So it is enough that some of
them, spread over all materials, find out which order is needed: the others are solved at that order
alone, and take over the error estimates of the scouts around them.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from bondcell.cell import FloatArray
from bondcell.fem.materials import Materials

SCOUTS = 8
"""Scouts of a sweep; all of up to twice as many points are their own."""

NEIGHBOURS, CAUTION = 4, 2.0
"""Scouts that a point takes the largest estimate of, and what it is multiplied by."""

RATIOS = 3
"""Poisson's ratios of the matrix among the scouts of a regular sweep."""

COMPRESSIBLE = 1e-3
"""Compressibility, ``mu/kappa``, below which no further difference is made."""


class Scouts:
    """Which points are scouts, and what the others learn from them.

    Parameters
    ----------
    materials
        The points.

    Attributes
    ----------
    points
        The scouts, ascending.
    others
        All other points, ascending.
    """

    def __init__(self, materials: Materials) -> None:
        count = materials.count
        if count <= 2 * SCOUTS:
            self.points, self.others = np.arange(count), np.arange(0)
            self._nearest = np.empty((0, 1), dtype=int)
            return
        place = _places(materials)
        self.points = _spread(place, _candidates(materials))
        self.others = np.setdiff1d(np.arange(count), self.points)
        apart = np.array([_distance(place[self.others], place[k]) for k in self.points])
        self._nearest = np.argsort(apart, axis=0)[:NEIGHBOURS].T

    def tell(self, estimates: FloatArray) -> FloatArray:
        """Estimates of the `others` from those of the scouts, which may lack some (NaN)."""
        known = np.where(np.isnan(estimates), -1.0, estimates)
        nearest = known[self._nearest].max(axis=1)
        return np.where(nearest < 0, np.inf, CAUTION * nearest)

    @property
    def caution(self) -> float:
        """By how much the scouts' estimates must stay below what is asked of all."""
        return CAUTION if self.others.size else 1.0


def _candidates(materials: Materials) -> NDArray[np.int64]:
    """Points of few Poisson's ratios of the matrix, which share condensations, or else all."""
    distinct = np.unique(materials.poisson_m)
    few = distinct[np.linspace(0, distinct.size - 1, RATIOS).astype(int)]
    sharing = np.flatnonzero(np.isin(materials.poisson_m, few))
    return sharing if sharing.size >= SCOUTS else np.arange(materials.count)


def _spread(place: NDArray[np.float64], candidates: NDArray[np.int64]) -> NDArray[np.int64]:
    """Candidates that lie as far from each other as can be, from a corner on."""
    place = place[candidates]
    chosen = [int(place.sum(axis=1).argmin())]
    distance = np.full(len(place), np.inf)
    while len(chosen) < SCOUTS:
        distance = np.minimum(distance, _distance(place, place[chosen[-1]]))
        chosen.append(int(distance.argmax()))
    return np.unique(candidates[chosen])


def _places(materials: Materials) -> NDArray[np.float64]:
    """Points in a unit cube of materials, shape (points, dimensions)."""
    moduli = np.column_stack([materials.young_i, materials.young_j])
    columns = np.column_stack(
        [
            np.clip(np.log10(moduli / materials.young_m[:, None]), -8, 12),
            np.log10(materials.compressibility + COMPRESSIBLE),
            materials.poisson_i,
            materials.poisson_j,
        ]
    )
    low, high = columns.min(axis=0), columns.max(axis=0)
    return np.asarray((columns - low) / np.where(high > low, high - low, 1.0))


def _distance(places: NDArray[np.float64], place: NDArray[np.float64]) -> NDArray[np.float64]:
    """Largest difference in any one dimension, by which corners are the farthest."""
    return np.asarray(np.abs(places - place).max(axis=1))
