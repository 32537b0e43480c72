"""The p-ladder: points climb to higher orders until their error estimates are small enough."""

from __future__ import annotations

import time

import numpy as np
from numpy.typing import NDArray

from bondcell.cell import FloatArray
from bondcell.fem.cell_mesh import Geometry, Grading, build_cell_mesh
from bondcell.fem.materials import Materials
from bondcell.fem.structured import CellSolver, Load

ORDERS = (4, 6, 8, 10, 12, 14)
"""Polynomial orders of the rungs."""

LARGEST = 16_000
"""Elements times order squared, a bound on unknowns and time: the ladder ends there."""

REDUCTION = 20
"""A reduced basis may add the tolerance over this."""

ROUND_OFF = (1e-11, 1e-7)
"""Least and largest relative round-off of one solve; it grows with ``kappa/mu``."""


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
        self._round_off = _round_off(materials)
        rungs = np.full((count, len(ORDERS)), np.nan)
        started = time.perf_counter()
        mesh = build_cell_mesh(geometry, grading, half)
        still_open = np.arange(count)
        for number, order in enumerate(ORDERS):
            if not still_open.size or mesh.topology.nelements * order**2 > LARGEST:
                break
            solver = CellSolver(geometry, load, half, order, mesh)
            sweep = solver.sweep(materials.take(still_open), tolerance / REDUCTION)
            rungs[still_open, number] = self.stiffness[still_open] = sweep.stiffness
            self.reduction_error[still_open] = sweep.reduction_error / np.abs(sweep.stiffness)
            self.way[still_open], self.order[still_open] = sweep.way, order
            self.dof[still_open], self.coupling[still_open] = solver.dof, sweep.coupling
            self._estimate(still_open, rungs[still_open, : number + 1])
            now = time.perf_counter()
            self.seconds[still_open] += (now - started) / still_open.size
            started = now
            solved = np.isfinite(self.stiffness[still_open])
            still_open = still_open[solved & (self.error_estimate[still_open] > tolerance)]

    def _estimate(self, points: NDArray[np.int64], rungs: FloatArray) -> None:
        discretisation = np.maximum(estimate(rungs), self._round_off[points])
        self.error_estimate[points] = discretisation + self.reduction_error[points]


def estimate(rungs: FloatArray) -> FloatArray:
    """Relative error of the last rung of each ladder; infinite while there are fewer than two.

    Ladders converge exponentially, each rung about thirty times closer to the limit than the one
    before, so half the last step bounds the error with room to spare. A step that is small by
    chance, where the sequence turns, is caught by the step before it, allowed to have shrunk
    fiftyfold at most.

    Parameters
    ----------
    rungs
        Stiffness by point and order, shape (points, rungs).
    """
    steps = np.abs(np.diff(rungs, axis=1)) / np.abs(rungs[:, -1:])
    if steps.shape[1] == 0:
        return np.full(len(rungs), np.inf)
    if steps.shape[1] == 1:
        return np.asarray(steps[:, 0])
    return np.maximum(steps[:, -1] / 2, steps[:, -2] / 50)


def _round_off(materials: Materials) -> FloatArray:
    """Nearly incompressible films are badly conditioned, the more the thinner."""
    poisson = np.max([materials.poisson_i, materials.poisson_j, materials.poisson_m], axis=0)
    least, largest = ROUND_OFF
    with np.errstate(divide="ignore"):
        bulk_to_shear = 2 * (1 + poisson) / (3 * (1 - 2 * poisson))
    return np.clip(2 * least * bulk_to_shear, least, largest)
