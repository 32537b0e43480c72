"""The p-ladder: points climb to higher orders until their error estimates are small enough."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from functools import partial

import numpy as np
from numpy.typing import NDArray

from bondcell.cell import FloatArray
from bondcell.fem.cell_mesh import Geometry, Grading, build_cell_mesh
from bondcell.fem.materials import Materials
from bondcell.fem.particle_lag import particle_lag
from bondcell.fem.scouts import Scouts
from bondcell.fem.strain import LATERAL, SWIRL
from bondcell.fem.structured import CellSolver, Load

LOWEST, HIGHEST = 4, 14
"""Polynomial orders of the first and the last rung."""

LARGEST = 16_000
"""Elements times order squared, a bound on unknowns and time: the ladder ends there."""

LOOSE = 1e-5
"""Tolerances from which a ladder of many points begins at the lowest order too."""

FEWEST = 3
"""Rungs that an estimate needs."""

LONGEST = 2
"""Orders that one step may take while the estimate is far too large."""

REDUCTION = 20
"""A reduced basis may add the tolerance over this."""

ROUND_OFF = 1e-11
"""Relative round-off of one solve."""

THIN_ROUND_OFF, WORST_ROUND_OFF = 1.5e-8, 4e-7
"""Bounds of it where ``kappa/mu`` is large: at a gap of one radius, and in the thinnest films."""

HELD_ROUND_OFF, HELD_WORST = 2e-8, 3e-6
"""The same, to be added where the side is held, over the particles' modulus ratio: all volume has
to go into them, and the stiffness is theirs."""

BENT_ROUND_OFF, SOFTER, SOFTEST = 2e-11, 1.5, 2e-6
"""Where the cell bends: bound of it at unit modulus ratio, growing with the square of the gap in
radii of the cylinder, and power of the ratio with which it grows beside softer particles, down to
the last ratio; the elements at their feet shrink no further."""

FREE_SHARE = 0.05
"""Part of these bounds that cells with free sides reach."""

SAFETY = 3.0
"""By how much the estimate exceeds the sum of the steps to come."""

SLOWEST, QUICKEST = 1.5, 20.0
"""Least and largest rate of convergence an order that steps are taken to have."""


class Ladder:
    """Points of one mesh on their way up the orders.

    Parameters
    ----------
    geometry, load, half, grading
        What to solve; see `CellSolver`.
    materials
        The points.
    tolerance
        Relative error at which a point stops climbing.

    Attributes
    ----------
    stiffness
        Of each point's last rung, NaN where it could not be solved, shape (points,).
    error_estimate, reduction_error
        Relative; the second is part of the first. Infinite where too few rungs were solved.
    coupling
        Coupling force of the bending load [N/rad], else NaN.
    order, dof, way, seconds
        Of each point: last order, its unknowns, how it was solved, share of the time [s].
    """

    def __init__(
        self,
        geometry: Geometry,
        load: Load,
        half: bool,
        grading: Grading,
        materials: Materials,
        tolerance: float,
    ) -> None:
        count = materials.count
        self.stiffness, self.error_estimate = np.full(count, np.nan), np.full(count, np.inf)
        self.coupling = np.full(count, np.nan)
        self.reduction_error, self.seconds = np.zeros(count), np.zeros(count)
        self.order, self.dof = np.zeros(count, dtype=int), np.zeros(count, dtype=int)
        self.way = np.zeros(count, dtype=np.int8)
        self._materials, self._tolerance = materials, tolerance
        self._round_off = _round_off(geometry, materials, load)
        self._clock = time.perf_counter()
        mesh = build_cell_mesh(geometry, grading, half)
        lag = particle_lag(geometry, materials, load)
        last = min(HIGHEST, int(np.sqrt(LARGEST / mesh.topology.nelements)))
        if last >= LOWEST:
            solver = partial(CellSolver, geometry, load, half, mesh=mesh, lag=lag)
            self._climb(Scouts(materials), solver, load.rate, last)

    def _climb(
        self, scouts: Scouts, solver: Callable[[int], CellSolver], rate: float, last: int
    ) -> None:
        """Solve the scouts at rising orders, and the other points once their order is known."""
        wanted = self._tolerance / scouts.caution
        size = scouts.points.size
        climbing, waiting, found = np.arange(size), scouts.others, np.full(size, np.nan)
        hurried = bool(waiting.size) and self._tolerance < LOOSE
        orders, rungs = [min(LOWEST + hurried, last)], np.empty((size, 0))
        while True:
            at = solver(orders[-1])
            mine = scouts.points[climbing]
            self._solve(at, orders[-1], mine)
            rungs = np.column_stack([rungs, np.full(size, np.nan)])
            rungs[climbing, -1] = self.stiffness[mine]
            guess = estimate(rungs[climbing], orders, rate)
            is_early = len(orders) < FEWEST
            if not is_early:
                found[climbing] = guess
                self._judge(mine, guess)
            goes_on = np.isfinite(self.stiffness[mine]) & (is_early | (guess > wanted))
            climbing, guess = climbing[goes_on], guess[goes_on]
            is_end = orders[-1] == last or not climbing.size
            told = scouts.tell(found)[np.isin(scouts.others, waiting)]
            ready = is_end | (told <= self._tolerance)
            self._solve(at, orders[-1], waiting[ready])
            self._judge(waiting[ready], told[ready])
            waiting = waiting[~ready]
            if is_end:
                return
            step = LONGEST if hurried and len(orders) == 1 else _step(guess, wanted)
            orders.append(min(orders[-1] + step, last))

    def _solve(self, solver: CellSolver, order: int, points: NDArray[np.int64]) -> None:
        """Solve points at one order."""
        if not points.size:
            return
        sweep = solver.sweep(self._materials.take(points), self._tolerance / REDUCTION)
        self.stiffness[points] = sweep.stiffness
        self.reduction_error[points] = sweep.reduction_error / np.abs(sweep.stiffness)
        self.way[points], self.order[points] = sweep.way, order
        self.dof[points], self.coupling[points] = solver.dof, sweep.coupling
        now = time.perf_counter()
        self.seconds[points] += (now - self._clock) / points.size
        self._clock = now

    def _judge(self, points: NDArray[np.int64], estimates: FloatArray) -> None:
        """Error estimates of solved points: of the discretisation, round-off and reduction."""
        estimates = np.maximum(estimates, self._round_off[points])
        self.error_estimate[points] = estimates + self.reduction_error[points]


def estimate(rungs: FloatArray, orders: Sequence[int], rate: float) -> FloatArray:
    """Relative error of the last rung of each ladder; infinite while there are fewer than two.

    Ladders converge exponentially, an order bringing them ``r`` times closer to the limit. With the
    last two steps ``s_1``, ``s_2`` over ``p_1``, ``p_2`` orders::

        error = 3 s_2 / (r^p_2 - 1),   r^p_1 = s_1 / s_2 within [3/2, rate]

    A step that is small by chance, where the sequence turns, is caught by the step before it: the
    error is no less than ``s_1 / rate^(p_1 + p_2)``.

    Parameters
    ----------
    rungs
        Stiffness by point and order, shape (points, rungs).
    orders
        Polynomial order of each rung, ascending.
    rate
        How much closer to the limit one more order comes usually at least.
    """
    steps = np.abs(np.diff(rungs, axis=1)) / np.abs(rungs[:, -1:])
    spans = np.diff(orders)
    if not spans.size:
        return np.full(len(rungs), np.inf)
    last = steps[:, -1]
    if spans.size == 1:
        return np.asarray(SAFETY * last / (SLOWEST ** spans[0] - 1))
    before = steps[:, -2]
    with np.errstate(divide="ignore", invalid="ignore"):
        seen = np.where(last > 0, before / last, np.inf) ** (1 / spans[-2])
    seen = np.clip(seen, SLOWEST, rate)
    return np.maximum(
        SAFETY * last / (seen ** spans[-1] - 1), before / rate ** float(spans[-2] + spans[-1])
    )


def _step(guess: FloatArray, wanted: float) -> int:
    """Orders to climb next: fewer by one than the least demanding point seems to need."""
    needed = np.ceil(np.log(guess.min() / wanted) / np.log(QUICKEST))
    return int(np.clip(needed - 1, 1, LONGEST))


def _round_off(geometry: Geometry, materials: Materials, load: Load) -> FloatArray:
    """Nearly incompressible films are badly conditioned, the more the thinner.

    Where the sides are free to move, volume finds its way and little was measured; torsion
    does not change it at all. Long cells bend much more easily than they strain otherwise.
    """
    if load.whole.mode is SWIRL:
        return np.full(materials.count, ROUND_OFF)
    share = 1.0 if load.whole.held.get("lateral") else FREE_SHARE
    poisson = np.max([materials.poisson_i, materials.poisson_j, materials.poisson_m], axis=0)
    thinness = max(geometry.radius_i, geometry.radius_j) / geometry.gap
    largest = np.clip(THIN_ROUND_OFF * np.sqrt(thinness), ROUND_OFF, WORST_ROUND_OFF)
    if load.whole.held.get("lateral"):
        with np.errstate(divide="ignore"):
            softness = HELD_ROUND_OFF / materials.ratios.min(axis=1)
        largest = np.minimum(largest + softness * np.sqrt(thinness), HELD_WORST)
    with np.errstate(divide="ignore"):
        bulk_to_shear = 2 * (1 + poisson) / (3 * (1 - 2 * poisson))
    least = ROUND_OFF * np.ones(materials.count)
    if load.whole.mode is LATERAL:
        slenderness = (1 + geometry.gap / geometry.cylinder_radius) ** 2
        softest = np.clip(materials.ratios.min(axis=1), SOFTEST, 1.0)
        least = BENT_ROUND_OFF * slenderness / softest**SOFTER
    return np.maximum(share * np.minimum(2 * ROUND_OFF * bulk_to_shear, largest), least)
