"""Roots of the secular equation, bracketed, each counted from its nearest pole.

``c = sum over k of a_k / (T - t_k)``, ``a_k > 0``, ``t_1 < t_2 < ..``: the right side falls from
+inf to -inf between neighbouring poles, so each gap holds one root; beyond the last pole lies one
more if ``c > 0``. A root is kept as its nearest pole and the distance from it, both to full
relative precision: with poles thirty decades apart, nearly equal ones or residues next to nothing
the root itself would have lost what counts.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bondcell.cell import FloatArray
from bondcell.prony.double_double import Pair, add, quotient, total, two_sum

LARGEST_BLOCK = 60_000
"""Entries of one intermediate array (roots times poles): small enough to stay in the cache."""

MOST_STEPS = 200
"""Bound of the iterations; a bisection in the logarithm alone would need about 70."""

CLOSE = 1e-9
"""Relative step after which two Newton steps end the iteration: they converge quadratically."""

LOST = 3.0
"""Sum of the terms' magnitudes over what is left of them, from where twice the digits are used."""


@dataclass(frozen=True)
class Roots:
    """Roots of many secular equations with the same poles or each with its own.

    Parameters
    ----------
    pole
        Index of the pole next to each root, shape (equations, roots).
    offset
        ``T - t_pole``, same shape.
    value
        The roots themselves, rounded.
    slope
        ``sum of a_k / (T - t_k)^2`` at each root: a sum of positive terms.
    """

    pole: NDArray[np.int64]
    offset: FloatArray
    value: FloatArray
    slope: FloatArray


def solve(poles: FloatArray, residues: Pair, constant: Pair) -> Roots:
    """Solve ``constant = sum of residues / (T - poles)``.

    Parameters
    ----------
    poles
        Ascending, shape (n,) or (equations, n).
    residues
        Positive, high and low part, each of the shape of `poles`.
    constant
        High and low part, each of shape (equations,): all positive, or all zero, when there is no
        root beyond the last pole.

    Returns
    -------
    Roots
        n roots an equation, or n - 1 without a constant.
    """
    equations, n = constant[0].size, poles.shape[-1]
    roots = n if np.any(constant[0] > 0) else n - 1
    shape = (equations, roots)
    result = Roots(np.zeros(shape, dtype=np.int64), *(np.zeros(shape) for _ in range(3)))
    step = max(1, LARGEST_BLOCK // max(1, roots * n))
    for start in range(0, equations if roots else 0, step):
        rows = slice(start, start + step)
        own = poles.ndim == 2
        block = _Block(
            poles[rows] if own else poles[None],
            (residues[0][rows], residues[1][rows])
            if own
            else (residues[0][None], residues[1][None]),
            (constant[0][rows], constant[1][rows]),
            roots,
        )
        block.solve()
        size = (-1, roots)
        result.pole[rows] = block.origin.reshape(size)
        result.offset[rows] = block.offset.reshape(size)
        result.value[rows] = block.value().reshape(size)
        result.slope[rows] = block.slope().reshape(size)
    return result


class _Block:
    """All roots of some equations, one root a row."""

    def __init__(self, poles: FloatArray, residues: Pair, constant: Pair, roots: int) -> None:
        equations = constant[0].size
        self.poles, self.residues, self.low_residues = poles, *residues
        self.equation = np.repeat(np.arange(equations), roots)
        self.own = self.equation if len(poles) > 1 else np.zeros_like(self.equation)
        self.left = np.tile(np.arange(roots), equations)
        self.constant = constant[0][self.equation], constant[1][self.equation]
        self.right = np.minimum(self.left + 1, poles.shape[1] - 1)
        self.last = self.left == poles.shape[1] - 1

    def distances(self, rows: NDArray[np.int64], offset: FloatArray) -> FloatArray:
        """``T - t_k`` for the chosen roots, shape (rows, n)."""
        own, origin = self.own[rows], self.origin[rows]
        return (self.poles[own, origin][:, None] - self.poles[own]) + offset[:, None]

    def sums(
        self, rows: NDArray[np.int64], offset: FloatArray
    ) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
        """Sum and slope of the poles on the left, and of those on the right, all positive."""
        distance = self.distances(rows, offset)
        term = self.residues[self.own[rows]] / distance
        slope = term / distance
        is_left = np.arange(term.shape[1]) <= self.left[rows][:, None]
        sum_left = np.where(is_left, term, 0.0).sum(axis=1)
        slope_left = np.where(is_left, slope, 0.0).sum(axis=1)
        return (
            sum_left,
            slope_left,
            np.where(is_left, 0.0, -term).sum(axis=1),
            np.where(is_left, 0.0, slope).sum(axis=1),
        )

    def solve(self) -> None:
        """Bracket, iterate, and polish where digits cancelled."""
        self._bracket()
        active = np.arange(self.left.size)
        for step in range(MOST_STEPS):
            active = self._improve(active, bisect=step % 12 == 11)
            if not active.size:
                break
        self._polish()

    def _bracket(self) -> None:
        """Which pole is nearest, the least and the largest distance from it, a first guess."""
        own = self.own
        gap = self.poles[own, self.right] - self.poles[own, self.left]
        reach = self.residues.sum(axis=1)[own] / np.where(self.last, self.constant[0], 1.0)
        gap = np.where(self.last, 2 * reach, gap)
        self.gap, self.origin = gap, self.left.copy()
        rows = np.arange(gap.size)
        sums = self.sums(rows, gap / 2)
        excess = self.constant[0] - sums[0] + sums[2]
        is_right = (excess < 0) & ~self.last
        self.origin = np.where(is_right, self.right, self.left)
        nearest = self.residues[own, self.origin]
        self.low = nearest / np.where(is_right, sums[0], self.constant[0] + sums[2])
        self.high = np.maximum(gap / 2, self.low)
        self.side = np.where(is_right, -1.0, 1.0)
        guess = self._interpolate(rows, gap / 2 * self.side, sums)
        self.offset = self.side * self._inside(rows, guess)

    def _improve(self, rows: NDArray[np.int64], bisect: bool) -> NDArray[np.int64]:
        """One step for the rows still moving; returns those that have to go on."""
        offset = self.offset[rows]
        sums = self.sums(rows, offset)
        excess = self.constant[0][rows] - sums[0] + sums[2]
        size = np.abs(offset)
        inward = excess * self.side[rows] > 0
        self.high[rows] = np.where(inward, np.minimum(size, self.high[rows]), self.high[rows])
        self.low[rows] = np.where(inward, self.low[rows], np.maximum(size, self.low[rows]))
        guess = self._inside(rows, self._interpolate(rows, offset, sums))
        if bisect:
            guess = np.sqrt(self.low[rows] * self.high[rows])
        self.offset[rows] = self.side[rows] * guess
        moving = np.abs(guess - size) > CLOSE * size
        open_bracket = self.high[rows] > self.low[rows] * (1 + CLOSE)
        return rows[moving & open_bracket]

    def _inside(self, rows: NDArray[np.int64], guess: FloatArray) -> FloatArray:
        low, high = self.low[rows], self.high[rows]
        good = (guess >= low) & (guess <= high)
        return np.where(good, guess, np.sqrt(low * high))

    def _interpolate(
        self,
        rows: NDArray[np.int64],
        offset: FloatArray,
        sums: tuple[FloatArray, FloatArray, FloatArray, FloatArray],
    ) -> FloatArray:
        """Distance of the root from its pole if each side were one pole and a constant.

        ``C - A/x + B/(gap - x) = 0`` with x counted from the left pole; A, B and C take both
        sums' values and slopes where they were measured.
        """
        left, slope_left, right, slope_right = sums
        gap, is_left = self.gap[rows], self.side[rows] > 0
        from_left = np.where(is_left, offset, gap + offset)
        from_right = np.where(is_left, gap - offset, -offset)
        strength_left = slope_left * from_left**2
        strength_right = slope_right * from_right**2
        height = self.constant[0][rows] - (left - slope_left * from_left)
        height = height + (right - slope_right * from_right)
        sign = np.where(is_left, 1.0, -1.0)
        near = np.where(is_left, strength_left, strength_right)
        middle = sign * height * gap + strength_left + strength_right
        with np.errstate(invalid="ignore", divide="ignore"):
            root = np.sqrt(middle**2 - 4 * sign * height * near * gap)
            guess = np.where(
                middle > 0, 2 * near * gap / (middle + root), (middle - root) / (2 * sign * height)
            )
            single = strength_left / height
        return np.where(self.last[rows], single, guess)

    def _polish(self) -> None:
        """Two Newton steps, the residual with twice the digits where cancellation takes some."""
        rows = np.arange(self.left.size)
        for _ in range(2):
            offset, constant = self.offset[rows], self.constant[0][rows]
            left, slope_left, right, slope_right = self.sums(rows, offset)
            excess, slope = constant - left + right, slope_left + slope_right
            lost = constant + left + right > LOST * slope * np.abs(offset)
            if lost.any():
                excess[lost] = self._excess(rows[lost], offset[lost])
            better = offset - excess / slope
            self.offset[rows] = np.where(better * offset > 0, better, offset)

    def _excess(self, rows: NDArray[np.int64], offset: FloatArray) -> FloatArray:
        """``c - sum of a_k / (T - t_k)`` summed with twice the digits."""
        own = self.own[rows]
        origin = self.poles[own, self.origin[rows]][:, None]
        apart = two_sum(origin, -self.poles[own])
        distance = add(apart, (offset[:, None], np.zeros((rows.size, 1))))
        terms = total(quotient((self.residues[own], self.low_residues[own]), distance))
        constant = self.constant[0][rows], self.constant[1][rows]
        return add(constant, (-terms[0], -terms[1]))[0]

    def value(self) -> FloatArray:
        """The roots, rounded."""
        return np.asarray(self.poles[self.own, self.origin] + self.offset)

    def slope(self) -> FloatArray:
        """``sum of a_k / (T - t_k)^2``."""
        distance = self.distances(np.arange(self.left.size), self.offset)
        return np.asarray((self.residues[self.own] / distance / distance).sum(axis=1))
