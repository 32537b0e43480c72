"""The condensed matrix as a function of its compressibility, interpolated between few values."""

from __future__ import annotations

import numpy as np

from bondcell.cell import FloatArray
from bondcell.fem.cell_operators import CellOperators

NODES = (9, 17, 33, 65)
"""Interpolation nodes in compressibility, each list containing the one before."""


class InterpolatedMatrix:
    """``S, b, c`` at any compressibility in a range, from their values at few.

    Parameters
    ----------
    operators
        One geometry, order and load.
    wanted
        Compressibilities of the points; few distinct ones are taken as they are.
    offset
        The ``d`` above: about where the smallest eigenvalue of a film's compressibility lies.
    tolerance
        Relative error allowed in the response of rigid particles.
    """

    def __init__(
        self, operators: CellOperators, wanted: FloatArray, offset: float, tolerance: float
    ) -> None:
        self._operators, self._offset = operators, offset
        distinct = np.unique(wanted)
        self.error = 0.0
        if distinct.size <= NODES[1]:
            self._take(distinct)
            return
        self._low, self._high = np.log(distinct[[0, -1]] + offset)
        for count in NODES:
            nodes = self._lobatto(count)
            if nodes.size >= distinct.size:
                break
            if count > NODES[0]:
                self.error = self._misses(nodes[1::2])
                if self.error <= tolerance:
                    return
            self._take(nodes)
        self.error = 0.0
        self._take(distinct)

    def _lobatto(self, count: int) -> FloatArray:
        x = -np.cos(np.pi * np.arange(count) / (count - 1))
        t = self._low + (self._high - self._low) * (x + 1) / 2
        return np.clip(np.exp(t) - self._offset, 0.0, None)

    def _take(self, nodes: FloatArray) -> None:
        systems = [self._operators.matrix_system(_poisson(e)) for e in nodes]
        m = self._operators.motions
        self.nodes = nodes
        self.matrix = np.array([system.matrix for system in systems])
        self.coupling = np.array([system.coupling[:, :m] for system in systems])
        self.own = np.array([system.own[:m, :m] for system in systems])

    def _misses(self, nodes: FloatArray) -> float:
        """Worst relative error of the rigid response between the nodes."""
        weights = self.weights(nodes)
        m = self._operators.motions
        guess = np.tensordot(weights, self.own, 1)
        true = np.array([self._operators.matrix_system(_poisson(e)).own[:m, :m] for e in nodes])
        size = np.abs(true).max(axis=(1, 2), keepdims=True)
        other = np.tensordot(weights, self.matrix, 1) - [
            self._operators.matrix_system(_poisson(e)).matrix for e in nodes
        ]
        scale = np.abs(self.matrix).max()
        return float(max(np.abs((guess - true) / size).max(), np.abs(other).max() / scale))

    def weights(self, compressibility: FloatArray) -> FloatArray:
        """Interpolation weights, shape (points, nodes): barycentric, exact at the nodes."""
        t = np.log(compressibility + self._offset)[:, None]
        at = np.log(self.nodes + self._offset)
        if self.nodes.size == 1:
            return np.ones((t.size, 1))
        # Products of distances in units that keep them near one, whatever the nodes.
        capacity = (at[-1] - at[0]) / 4
        gaps = (at[:, None] - at) / capacity
        np.fill_diagonal(gaps, 1.0)
        barycentric = 1 / gaps.prod(axis=1)
        distance = t - at
        # Round-off of the logarithm must not hide that a point is a node.
        hits = np.abs(compressibility[:, None] - self.nodes) <= 1e-13 * self.nodes
        distance[hits] = 1.0
        terms = barycentric / distance
        weights = terms / terms.sum(axis=1, keepdims=True)
        rows = hits.any(axis=1)
        weights[rows] = hits[rows]
        return np.asarray(weights)


def _poisson(compressibility: float) -> float:
    """Poisson's ratio at ``mu/kappa``."""
    return float((3 - 2 * compressibility) / (6 + 2 * compressibility))
