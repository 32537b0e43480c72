"""Reference stiffness of many cells of one geometry, with an error estimate from the p-ladder."""

from __future__ import annotations

import time
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bondcell.cell import Cell, FloatArray
from bondcell.fem.cell_mesh import Geometry, build_cell_mesh
from bondcell.fem.cell_operators import Materials
from bondcell.fem.structured import CellSolver, Load, find_load, split_cell
from bondcell.fem.substructure import bulk_to_shear
from bondcell.status import Status

ORDERS = (4, 6, 8, 10, 12, 14)
"""The ladder; a point climbs it until its estimate meets the tolerance."""

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
    """

    stiffness: FloatArray
    error_estimate: FloatArray
    status: NDArray[np.int8]
    dof: NDArray[np.int64]
    order: NDArray[np.int64]
    seconds: FloatArray


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
    )
    mirrored = np.array([g.is_mirrored and m.is_mirrored for g, m in points])
    blocked = np.array([(load, bc) == ("normal", "confined") and _is_rigid(m) for _, m in points])
    answer.status[blocked] = Status.diverges
    for half in (True, False):
        chosen = np.flatnonzero((mirrored == half) & ~blocked)
        if chosen.size:
            materials = [points[k][1] for k in chosen]
            _climb(points[0][0], half, materials, chosen, entry, tolerance, answer)
    return answer


def _climb(
    geometry: Geometry,
    half: bool,
    materials: list[Materials],
    chosen: NDArray[np.int64],
    load: Load,
    tolerance: float,
    answer: Reference,
) -> None:
    """Raise the order for the points still open, until their estimates are small enough."""
    started = time.perf_counter()
    mesh = build_cell_mesh(geometry, load.grading, half)
    ladders: list[list[float]] = [[] for _ in materials]
    still_open = list(range(len(materials)))
    for order in ORDERS:
        solver = CellSolver(geometry, load, half, order, mesh)
        for k in still_open:
            ladders[k].append(_stiffness(solver, materials[k]))
        now = time.perf_counter()
        answer.seconds[chosen[still_open]] += (now - started) / len(still_open)
        started = now
        answer.order[chosen[still_open]] = order
        answer.dof[chosen[still_open]] = solver.dof
        still_open = [k for k in still_open if not estimate(ladders[k], materials[k]) <= tolerance]
        still_open = [k for k in still_open if np.isfinite(ladders[k][-1])]
        if not still_open:
            break
    for k, ladder in enumerate(ladders):
        at = chosen[k]
        if np.isfinite(ladder[-1]):
            answer.stiffness[at] = ladder[-1]
            answer.error_estimate[at] = estimate(ladder, materials[k])
            good = answer.error_estimate[at] <= tolerance
            answer.status[at] = Status.ok if good else Status.tolerance_not_met


def _is_rigid(materials: Materials) -> bool:
    """Whether nothing can give way once the sides are held: all parts rigid or incompressible."""
    rigid = np.isinf(materials.young_i) and np.isinf(materials.young_j)
    return bool(rigid and materials.poisson_m == 0.5)


def _stiffness(solver: CellSolver, materials: Materials) -> float:
    try:
        return solver.stiffness(materials)
    except np.linalg.LinAlgError:
        return np.nan


def estimate(ladder: list[float], materials: Materials) -> float:
    """Relative error of a ladder's last rung; infinite while there are fewer than two.

    The last rung is closer to the limit than to the rung before, since the ladder converges
    exponentially; so the last step bounds the error. A step that is small by chance, where the
    sequence turns, is caught by the step before it, allowed to have shrunk a hundredfold at most.
    """
    if len(ladder) < 2:
        return np.inf
    steps = np.abs(np.diff(ladder)) / abs(ladder[-1])
    last = max(steps[-1], steps[-2] / 100) if len(steps) > 1 else steps[-1]
    return float(max(last, _round_off(materials)))


def _round_off(materials: Materials) -> float:
    """Nearly incompressible films are badly conditioned, the more the thinner."""
    poisson = max(materials.poisson_i, materials.poisson_j, materials.poisson_m)
    least, largest = ROUND_OFF
    return float(np.clip(2 * least * bulk_to_shear(poisson), least, largest))
