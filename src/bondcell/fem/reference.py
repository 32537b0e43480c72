"""Reference stiffness of many cells of one geometry, each with an error estimate and a flag."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from bondcell.cell import Cell, FloatArray
from bondcell.fem.cell_mesh import Geometry, Grading
from bondcell.fem.ladder import Ladder
from bondcell.fem.materials import Materials
from bondcell.fem.slender import (
    SHARE,
    BeamStiffness,
    is_slender,
    lengthened,
    lengthened_error,
    shortened,
)
from bondcell.fem.structured import Load, find_load, geometry_of
from bondcell.fem.threads import one_thread
from bondcell.status import Status

SOFT_RATIO = 1.0
"""Modulus ratio below which the cusp beside a particle is followed farther."""

STIFF_RATIO, STIFF_CUT = 100.0, 0.04
"""A modulus ratio, and where the cusp beside particles about as stiff may be cut early [radii]."""

WIDE_CUT = 2 * STIFF_CUT
"""Where it may be cut beside stiffer ones [radii]."""

CUT_SHARE = 0.3
"""Largest part of the tolerance that an early cut may cost."""

FOLLOWED_CUT = 1e-4
"""Loads whose usual cut is below this hold the side: there the cusp counts at any ratio."""

SOFT_CUT, SMALLEST_CUT = 2e-3, 1e-6
"""Where the cusp beside a soft particle is cut, over its modulus ratio, and the least [radii]."""

CUT_RATE = 1.5
"""Power of a cut, over the modulus ratio, with which its error grows."""

HELD_REACH = 0.1, 3.0
"""Where the side is held, the modulus ratio matters between these cuts over it alone."""

LEAST_CUT_ERROR = 1e-11
"""Relative error of what refinement leaves out elsewhere, at singular corners."""

RESOLVED = 1e-2
"""Height at which a cusp beside a soft particle stops to matter, over the modulus ratio [radii]."""

TIGHT = 0.499
"""Poisson's ratio of the matrix from which a cusp that is not resolved makes the value unknown."""


@dataclass(frozen=True)
class Reference:
    """Answers for the points of one geometry, arrays of shape (points,).

    Parameters
    ----------
    stiffness
        Stiffness [N/m; N m/rad for torsion and bending], NaN where the flag says so.
    error_estimate
        Estimated relative error: of the discretisation, and of a reduced basis where one was used.
    status
        Flag, see `bondcell.status.Status`.
    dof, order
        Unknowns and polynomial order of the finest solve used.
    seconds
        Wall time a point; the operators' time is shared by the points that used them [s].
    way
        How the finest solve was done, see `sweep.Way`.
    coupling
        Force across the axis for a unit rotation of end plane j, of the bending load [N/rad].
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
    coupling: FloatArray
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
    if is_slender(cell, load):
        return _solve_slender(cell, load, tolerance)
    geometry, materials = geometry_of(cell), Materials.of(cell)
    answer = _empty(materials.count)
    blocked = _is_blocked(materials) & ((load, bc) == ("normal", "confined"))
    answer.status[blocked] = Status.diverges
    half = materials.is_mirrored & geometry.is_mirrored
    gradings = _gradings(geometry, materials, entry, tolerance)
    for is_half in np.unique(half):
        for grading in sorted(set(gradings), key=lambda g: g.foot):
            mine = np.array([own == grading for own in gradings])
            at = np.flatnonzero((half == is_half) & mine & ~blocked)
            if at.size:
                own = materials.take(at)
                cut = _cut_error(geometry, own, entry, grading)
                left = tolerance - min(float(cut.min()), tolerance / 2)
                ladder = Ladder(geometry, entry, bool(is_half), grading, own, left)
                ladder.error_estimate += cut
                _report(ladder, at, tolerance, answer)
    return answer


def _solve_slender(cell: Cell, load: str, tolerance: float) -> Reference:
    """Solve slender cells by short ones; what is reported of the solves is theirs."""
    short = [
        [solve(own, motion, tolerance=SHARE * tolerance) for motion in ("shear", "bending")]
        for own in shortened(cell)
    ]
    parts = [part for pair in short for part in pair]
    values = [BeamStiffness(s.stiffness, b.stiffness, b.coupling) for s, b in short]
    errors = [_beam_errors(*pair) for pair in short]
    with np.errstate(divide="ignore", invalid="ignore"):
        result, error = lengthened(cell, *values), lengthened_error(cell, *values, *errors)
    stiffness, estimate = getattr(result, load), getattr(error, load)
    known = np.isfinite(stiffness) & (stiffness > 0) & np.isfinite(estimate)
    failed = np.max([np.maximum(part.status, Status.limit_exceeded) for part in parts], axis=0)
    met = np.where(estimate <= tolerance, Status.ok, Status.tolerance_not_met)
    return Reference(
        stiffness=np.where(known, stiffness, np.nan),
        error_estimate=np.where(known, estimate, np.nan),
        status=np.where(known, met, failed).astype(np.int8),
        dof=np.max([part.dof for part in parts], axis=0),
        order=np.max([part.order for part in parts], axis=0),
        seconds=np.sum([part.seconds for part in parts], axis=0),
        way=np.max([part.way for part in parts], axis=0),
        coupling=np.where(known & (load == "bending"), result.coupling, np.nan),
        reduction_error=np.max([part.reduction_error for part in parts], axis=0),
    )


def _beam_errors(shear: Reference, bending: Reference) -> BeamStiffness:
    """Relative errors; the coupling's absolute one is no more than their geometric mean."""
    errors = shear.error_estimate, bending.error_estimate
    mean = np.sqrt(errors[0] * shear.stiffness * errors[1] * bending.stiffness)
    return BeamStiffness(*errors, mean / np.abs(bending.coupling))


def _empty(count: int) -> Reference:
    return Reference(
        stiffness=np.full(count, np.nan),
        error_estimate=np.full(count, np.nan),
        status=np.full(count, Status.solver_failed, dtype=np.int8),
        dof=np.zeros(count, dtype=np.int64),
        order=np.zeros(count, dtype=np.int64),
        seconds=np.zeros(count),
        way=np.zeros(count, dtype=np.int8),
        coupling=np.full(count, np.nan),
        reduction_error=np.zeros(count),
    )


def _report(ladder: Ladder, at: NDArray[np.int64], tolerance: float, answer: Reference) -> None:
    """Write a ladder's results and flags at positions ``at``."""
    answer.order[at], answer.dof[at], answer.way[at] = ladder.order, ladder.dof, ladder.way
    answer.seconds[at], answer.reduction_error[at] = ladder.seconds, ladder.reduction_error
    solved = np.isfinite(ladder.stiffness) & (ladder.stiffness > 0)
    known = solved & np.isfinite(ladder.error_estimate)
    good = known & (ladder.error_estimate <= tolerance)
    answer.stiffness[at[known]] = ladder.stiffness[known]
    answer.coupling[at[known]] = ladder.coupling[known]
    answer.error_estimate[at[known]] = ladder.error_estimate[known]
    answer.status[at[known]] = Status.tolerance_not_met
    answer.status[at[good]] = Status.ok
    climbed = ladder.order > 0
    answer.status[at[(solved | ~climbed) & ~known]] = Status.limit_exceeded


def _is_blocked(materials: Materials) -> NDArray[np.bool_]:
    """Where nothing can give way once the sides are held: all parts rigid or incompressible."""
    rigid = np.isinf(materials.young_i) & np.isinf(materials.young_j)
    return np.asarray(rigid & (materials.poisson_m == 0.5))


def _touches_side(geometry: Geometry) -> NDArray[np.bool_]:
    """Which of the spheres touch the lateral surface, where the matrix runs into a cusp."""
    radii = np.array([geometry.radius_i, geometry.radius_j])
    return np.asarray(radii == geometry.cylinder_radius)


def _softness(geometry: Geometry, materials: Materials) -> FloatArray:
    """Least modulus ratio of the particles beside a cusp; infinite if all are rigid, or none is."""
    return np.where(_touches_side(geometry), materials.ratios, np.inf).min(axis=1)


def _cut_error(
    geometry: Geometry, materials: Materials, load: Load, grading: Grading
) -> FloatArray:
    """Relative error of cutting the cusp where ``grading`` does."""
    unresolved = _unresolved_cusp(geometry, materials)
    if grading.foot in (STIFF_CUT, WIDE_CUT):
        return _early_cut(geometry, materials, load, grading.foot)
    if not _touches_side(geometry).any():
        return unresolved + LEAST_CUT_ERROR
    with np.errstate(divide="ignore"):
        reach = grading.foot / (load.grading.foot * _softness(geometry, materials))
    if load.grading.foot <= FOLLOWED_CUT:
        reach = np.clip(reach, *HELD_REACH)
    return np.asarray(unresolved + LEAST_CUT_ERROR + load.usual_cut * reach**CUT_RATE)


def _early_cut(
    geometry: Geometry, materials: Materials, load: Load, cut: float = STIFF_CUT
) -> FloatArray:
    """Relative error of an early cut: it grows with its cube and falls with the ratio squared."""
    with np.errstate(divide="ignore"):
        ratio = STIFF_RATIO / _softness(geometry, materials)
    return np.asarray(load.early_cut * (cut / STIFF_CUT) ** 3 * ratio**2)


def _gradings(
    geometry: Geometry, materials: Materials, load: Load, tolerance: float
) -> list[Grading]:
    """How finely each point's mesh follows the cusps at the feet of spheres that touch the side.

    What is cut off matters once the cusp is as stiff as the particle next to it, at a height in
    proportion to the modulus ratio; beside a stiff particle it hardly strains, unless the side is
    held, and nor does the particle's own rim. Cuts come in few sizes, so that points share meshes.
    """
    usual = load.grading
    softness = _softness(geometry, materials)
    with np.errstate(invalid="ignore", divide="ignore"):
        decades = 10.0 ** np.floor(np.log10(SOFT_CUT * softness))
    cuts = np.where(softness < SOFT_RATIO, np.maximum(decades, SMALLEST_CUT), usual.foot)
    cuts = np.minimum(cuts, usual.foot)
    touches = _touches_side(geometry)
    may_coarsen = touches.any() & (usual.foot > FOLLOWED_CUT)
    share = CUT_SHARE * tolerance
    is_early = may_coarsen & (_early_cut(geometry, materials, load) <= share)
    is_wide = (_early_cut(geometry, materials, load, WIDE_CUT)[is_early] <= share).all()
    foot = WIDE_CUT if is_wide else STIFF_CUT
    stiff = replace(usual, foot=foot, corner=0.0 if touches.all() else usual.corner)
    return [
        stiff if early else replace(usual, foot=cut)
        for early, cut in zip(is_early.tolist(), cuts.tolist(), strict=True)
    ]


def _unresolved_cusp(geometry: Geometry, materials: Materials) -> FloatArray:
    """Relative error that the shortest cut leaves beside very soft particles.

    Measured: the error grows with the square of the cut over the height where the cusp stops to
    matter, up to about one hundredth; from there by about 0.15 of the stiffness a decade. An
    incompressible matrix is wedged in such a cusp: nothing is known of its error.
    """
    excess = SMALLEST_CUT / (RESOLVED * _softness(geometry, materials))
    far = 0.01 + 0.15 * np.log10(np.maximum(excess, 300) / 300)
    error = np.where(excess > 1, np.where(excess < 300, 1e-7 * excess**2, far), 0.0)
    return np.where((excess > 1) & (materials.poisson_m > TIGHT), np.inf, error)
