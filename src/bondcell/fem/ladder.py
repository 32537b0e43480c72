"""The p-ladder: points climb to higher orders until their error estimates are small enough."""

from __future__ import annotations

import time

import numpy as np

from bondcell.cell import FloatArray
from bondcell.fem.cell_mesh import Geometry, Grading, build_cell_mesh
from bondcell.fem.materials import Materials
from bondcell.fem.structured import CellSolver, Load

ORDERS = (4, 6, 8, 10, 12, 14)
"""Polynomial orders of the rungs."""

LARGEST = 16_000
"""Elements times order squared, a bound on unknowns and time: the ladder ends there."""

FEW, LOOSE = 8, 1e-5
"""Points up to which each climbs from the first rung, and tolerances where all do."""

REDUCTION = 20
"""A reduced basis may add the tolerance over this."""

ROUND_OFF = 1e-11
"""Relative round-off of one solve."""

THIN_ROUND_OFF, WORST_ROUND_OFF = 6e-9, 2e-7
"""Bounds of it where ``kappa/mu`` is large: at a gap of one radius, and in the thinnest films."""


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
        Relative; the second is part of the first. Infinite where fewer than two rungs were solved.
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
        round_off = _round_off(geometry, materials)
        rungs = np.full((count, len(ORDERS)), np.nan)
        clock = time.perf_counter()
        mesh = build_cell_mesh(geometry, grading, half)
        # Many points judge each other's steps, and the first rung is never the last one needed.
        start = 1 if count > FEW and tolerance < LOOSE else 0
        points = np.arange(count)
        for number, order in enumerate(ORDERS[start:], start):
            if not points.size or mesh.topology.nelements * order**2 > LARGEST:
                break
            solver = CellSolver(geometry, load, half, order, mesh)
            sweep = solver.sweep(materials.take(points), tolerance / REDUCTION)
            rungs[points, number] = self.stiffness[points] = sweep.stiffness
            self.reduction_error[points] = sweep.reduction_error / np.abs(sweep.stiffness)
            self.way[points], self.order[points] = sweep.way, order
            self.dof[points], self.coupling[points] = solver.dof, sweep.coupling
            discretisation = estimate(rungs[points, start : number + 1], load.rate)
            discretisation = np.maximum(discretisation, round_off[points])
            self.error_estimate[points] = discretisation + self.reduction_error[points]
            now = time.perf_counter()
            self.seconds[points] += (now - clock) / points.size
            clock = now
            solved = np.isfinite(self.stiffness[points])
            points = points[solved & (self.error_estimate[points] > tolerance)]


def estimate(rungs: FloatArray, rate: float) -> FloatArray:
    """Relative error of the last rung of each ladder; infinite while there are fewer than two.

    Ladders converge exponentially: each rung comes at least ``rate`` times closer to the limit, but
    for chance, which a factor of four allows for. A step that is small by chance, where the
    sequence turns, is caught by the step before it; where there is none, by the largest step of all
    points, which share a geometry and err alike.

    Parameters
    ----------
    rungs
        Stiffness by point and order, shape (points, rungs).
    rate
        See above.
    """
    steps = np.abs(np.diff(rungs, axis=1)) / np.abs(rungs[:, -1:])
    if steps.shape[1] == 0:
        return np.full(len(rungs), np.inf)
    if steps.shape[1] == 1:
        return np.maximum(steps[:, 0] * 4, np.nanmax(steps, initial=0.0)) / rate
    last, before = steps[:, -1], steps[:, -2]
    converging = np.maximum(last * 4 / rate, before * 2 / rate**2)
    # Two steps alike are no convergence but round-off.
    return np.where(last > before / 2, np.maximum(last, before), converging)


def _round_off(geometry: Geometry, materials: Materials) -> FloatArray:
    """Nearly incompressible films are badly conditioned, the more the thinner."""
    poisson = np.max([materials.poisson_i, materials.poisson_j, materials.poisson_m], axis=0)
    thinness = max(geometry.radius_i, geometry.radius_j) / geometry.gap
    largest = np.clip(THIN_ROUND_OFF * np.sqrt(thinness), ROUND_OFF, WORST_ROUND_OFF)
    with np.errstate(divide="ignore"):
        bulk_to_shear = 2 * (1 + poisson) / (3 * (1 - 2 * poisson))
    return np.clip(2 * ROUND_OFF * bulk_to_shear, ROUND_OFF, largest)
