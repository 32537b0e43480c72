"""Reference stiffness of many cells of one geometry, with an error estimate from the p-ladder."""

from __future__ import annotations

import time
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from bondcell.cell import Cell, FloatArray
from bondcell.fem.cell_mesh import Geometry, Grading, build_cell_mesh
from bondcell.fem.materials import Materials
from bondcell.fem.structured import CellSolver, Load, find_load, split_cell
from bondcell.fem.substructure import bulk_to_shear
from bondcell.fem.threads import one_thread
from bondcell.status import Status

ORDERS = (4, 6, 8, 10, 12, 14)
"""The ladder; a point climbs it until its estimate meets the tolerance."""

LARGEST = 16_000
"""Elements times order squared, a bound on unknowns and time: the ladder ends there."""

SOFT_CUT, SMALLEST_CUT = 1e-2, 1e-6
"""Where the cusp beside a soft particle is cut, over its modulus ratio, and the least [radii]."""

REDUCTION = 20
"""A reduced basis may add the tolerance over this."""

ROUND_OFF = (1e-11, 1e-7)
"""Least and largest relative round-off of one solve; it grows with ``kappa/mu``."""


@dataclass(frozen=True)
class Reference:
    """Answers for the points of one geometry, arrays of shape (points,).

    Parameters
    ----------
    stiffness
        Stiffness [N/m; N m/rad for torsion and bending], NaN where the flag says so.
    error_estimate
        Estimated relative error of the discretisation.
    status
        Flag, see `bondcell.status.Status`.
    dof, order
        Unknowns and polynomial order of the finest solve used.
    seconds
        Wall time a point; the operators' time is shared by the points that used them [s].
    way
        How the finest solve was done, see `sweep.Way`.
    reduction_error
        The part of ``error_estimate`` that bounds what a reduced basis added.
    """

    stiffness: FloatArray
    error_estimate: FloatArray
    status: NDArray[np.int8]
    dof: NDArray[np.int64]
    order: NDArray[np.int64]
    seconds: FloatArray
    way: NDArray[np.int8]
    reduction_error: FloatArray


@one_thread()
def solve(
    cell: Cell, load: str = "normal", bc: str = "roller", tolerance: float = 1e-6
) -> Reference:
    """Solve points that share one geometry.

    Parameters
    ----------
    cell
        One-dimensional arrays; ``radius_i``, ``radius_j``, ``gap``, ``cylinder_radius`` constant.
    load, bc
        ``normal`` with ``roller``, ``clamped`` or ``confined`` end planes and sides; ``shear``,
        ``torsion`` or ``bending``, where ``bc`` means nothing.
    tolerance
        Wanted relative error; points that miss it at the highest order are flagged.
    """
    entry = find_load(load, bc)
    cell = cell.ravel()
    count = cell.shape[0]
    points = [split_cell(cell.take(slice(k, k + 1))) for k in range(count)]
    answer = Reference(
        stiffness=np.full(count, np.nan),
        error_estimate=np.full(count, np.nan),
        status=np.full(count, Status.solver_failed, dtype=np.int8),
        dof=np.zeros(count, dtype=np.int64),
        order=np.zeros(count, dtype=np.int64),
        seconds=np.zeros(count),
        way=np.zeros(count, dtype=np.int8),
        reduction_error=np.zeros(count),
    )
    groups: dict[tuple[bool, Grading], list[int]] = {}
    for k, (geometry, materials) in enumerate(points):
        if (load, bc) == ("normal", "confined") and _is_rigid(materials):
            answer.status[k] = Status.diverges
            continue
        half = geometry.is_mirrored and materials.is_mirrored
        grading = _grading(entry.grading, geometry, materials)
        groups.setdefault((half, grading), []).append(k)
    for (half, grading), chosen in groups.items():
        ladder = _Ladder(points[0][0], entry, half, grading)
        ladder.climb([points[k][1] for k in chosen], tolerance)
        ladder.report(np.array(chosen), tolerance, answer)
    return answer


def _grading(grading: Grading, geometry: Geometry, materials: Materials) -> Grading:
    """Cut the cusp at the foot later where a soft particle lets the matrix beside it carry load.

    What is cut off matters once the cusp is as stiff as the particle next to it, at a height in
    proportion to the modulus ratio. Cuts come in decades, so that points share meshes.
    """
    ratios = [
        shear / materials.shear_m
        for radius, (shear, _) in zip(
            (geometry.radius_i, geometry.radius_j), materials.particles, strict=True
        )
        if radius == geometry.cylinder_radius
    ]
    if not ratios or min(ratios) > 0.3:
        return grading
    wanted = 10.0 ** np.floor(np.log10(SOFT_CUT * min(ratios)))
    return replace(grading, foot=min(grading.foot, max(wanted, SMALLEST_CUT)))


class _Ladder:
    """Points of one mesh on their way up the orders."""

    def __init__(self, geometry: Geometry, load: Load, half: bool, grading: Grading) -> None:
        self._geometry, self._load, self._half, self._grading = geometry, load, half, grading

    def climb(self, materials: list[Materials], tolerance: float) -> None:
        """Raise the order for the points still open, until their estimates are small enough."""
        count = len(materials)
        self._materials = materials
        self._rungs: list[list[float]] = [[] for _ in materials]
        self._order, self._dof = np.zeros(count, dtype=int), np.zeros(count, dtype=int)
        self._seconds, self._reduction = np.zeros(count), np.zeros(count)
        self._way = np.zeros(count, dtype=np.int8)
        started = time.perf_counter()
        mesh = build_cell_mesh(self._geometry, self._grading, self._half)
        still_open = list(range(count))
        for order in ORDERS:
            if not still_open or mesh.topology.nelements * order**2 > LARGEST:
                break
            solver = CellSolver(self._geometry, self._load, self._half, order, mesh)
            sweep = solver.sweep([materials[k] for k in still_open], tolerance / REDUCTION)
            for k, stiffness in zip(still_open, sweep.stiffness, strict=True):
                self._rungs[k].append(float(stiffness))
            self._way[still_open] = sweep.way
            self._reduction[still_open] = sweep.reduction_error / np.abs(sweep.stiffness)
            now = time.perf_counter()
            self._seconds[still_open] += (now - started) / len(still_open)
            started = now
            self._order[still_open], self._dof[still_open] = order, solver.dof
            still_open = [
                k
                for k in still_open
                if np.isfinite(self._rungs[k][-1]) and not self._estimate(k) <= tolerance
            ]

    def report(self, at: NDArray[np.int64], tolerance: float, answer: Reference) -> None:
        """Write the points' results at positions ``at`` of the answer."""
        answer.order[at], answer.dof[at], answer.seconds[at] = (
            self._order,
            self._dof,
            self._seconds,
        )
        answer.way[at], answer.reduction_error[at] = self._way, self._reduction
        for k, point in enumerate(at):
            rungs = self._rungs[k]
            if len(rungs) < 2:
                answer.status[point] = Status.limit_exceeded
            elif np.isfinite(rungs[-1]) and rungs[-1] > 0:
                answer.stiffness[point] = rungs[-1]
                answer.error_estimate[point] = self._estimate(k)
                good = answer.error_estimate[point] <= tolerance
                answer.status[point] = Status.ok if good else Status.tolerance_not_met

    def _estimate(self, k: int) -> float:
        own = estimate(self._rungs[k], self._materials[k]) + self._reduction[k]
        wanted = _grading(self._grading, self._geometry, self._materials[k]).foot
        softest = min(shear for shear, _ in self._materials[k].particles)
        # The cusp of a very soft particle cannot be followed to where it no longer matters.
        if wanted <= SMALLEST_CUT and softest < 1e-2 * self._materials[k].shear_m:
            return max(own, _unresolved_cusp(softest / self._materials[k].shear_m))
        return own


def _unresolved_cusp(ratio: float) -> float:
    """Relative error that the shortest cut leaves at a particle's modulus over the matrix's.

    The stiffness falls by about its tenth for each decade that the cut lies above the height where
    the cusp stops to matter; below it the error shrinks with the square of the cut.
    """
    excess = SMALLEST_CUT / (SOFT_CUT * ratio)
    return float(1e-7 * excess**2 if excess < 300 else 0.01 + 0.15 * np.log10(excess / 300))


def _is_rigid(materials: Materials) -> bool:
    """Whether nothing can give way once the sides are held: all parts rigid or incompressible."""
    rigid = np.isinf(materials.young_i) and np.isinf(materials.young_j)
    return bool(rigid and materials.poisson_m == 0.5)


def estimate(ladder: list[float], materials: Materials) -> float:
    """Relative error of a ladder's last rung; infinite while there are fewer than two.

    The ladder converges exponentially, each rung about thirty times closer to the limit than the
    one before, so half the last step bounds the error with room to spare. A step that is small by
    chance, where the sequence turns, is caught by the step before it, allowed to have shrunk
    fiftyfold at most.
    """
    if len(ladder) < 2:
        return np.inf
    steps = np.abs(np.diff(ladder)) / abs(ladder[-1])
    last = max(steps[-1] / 2, steps[-2] / 50) if len(steps) > 1 else steps[-1]
    return float(max(last, _round_off(materials)))


def _round_off(materials: Materials) -> float:
    """Nearly incompressible films are badly conditioned, the more the thinner."""
    poisson = max(materials.poisson_i, materials.poisson_j, materials.poisson_m)
    least, largest = ROUND_OFF
    return float(np.clip(2 * least * bulk_to_shear(poisson), least, largest))
