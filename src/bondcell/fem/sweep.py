"""Responses of many points on one geometry, by the cheapest of three ways."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from enum import IntEnum

import numpy as np
from numpy.typing import NDArray

from bondcell.cell import FloatArray
from bondcell.fem.cell_operators import CellOperators
from bondcell.fem.interpolated_matrix import NODES
from bondcell.fem.materials import Materials
from bondcell.fem.pencil import MANY
from bondcell.fem.reduced_basis import Points, ReducedBasis

FEWEST = 2
"""Points that differ in the particles' modulus alone from which sharing their pencil pays."""

COMPRESSIBLE, AGREEMENT = 1e-3, 1e-9
"""Compressibility below which a pencil is compared with a direct solve, and how well it must."""

REFINEMENTS = 6
"""How often the greedy search may look again where the bound is still too large."""


class Way(IntEnum):
    """How a point's response was found."""

    direct = 0
    reduced_basis = 1
    spectrum = 2


@dataclass(frozen=True)
class Responses:
    """Responses of points.

    Parameters
    ----------
    matrix
        Stiffness of the motions, shape (points, motions, motions); NaN from singular systems.
    error
        Bound of the reduction's error of each motion's own stiffness, shape (points, motions).
    way
        `Way` of each point.
    """

    matrix: FloatArray
    error: FloatArray
    way: NDArray[np.int8]


def respond(
    operators: CellOperators, materials: Materials, tolerance: float, offset: float
) -> Responses:
    """Solve all points.

    Parameters
    ----------
    operators
        One geometry, order and load.
    materials
        Materials of the points.
    tolerance
        Relative error that the reduction may add; points that miss it are solved directly.
    offset
        See `interpolated_matrix.InterpolatedMatrix`.
    """
    count, m = materials.count, operators.motions
    answer = Responses(
        np.full((count, m, m), np.nan), np.zeros((count, m)), np.zeros(count, dtype=np.int8)
    )
    stiff = (materials.ratios >= 1).all(axis=1)
    poisson = np.stack([materials.poisson_i, materials.poisson_j], axis=1)
    poisson = poisson[:, : len(operators.of_particle)]
    for pair in np.unique(poisson[stiff], axis=0):
        members = np.flatnonzero(stiff & (poisson == pair).all(axis=1))
        if _reduction_pays(materials.poisson_m[members]):
            _reduce(operators, list(pair), materials, members, tolerance, offset, answer)
    for group in _of_one_pencil(materials, np.flatnonzero(stiff & _unanswered(answer))):
        _share_pencil(operators, materials, group, answer)
    for point in map(int, np.flatnonzero(_unanswered(answer))):
        try:
            answer.matrix[point] = operators.response(materials.constants(point))
        except np.linalg.LinAlgError:
            continue
    return answer


def _unanswered(answer: Responses) -> NDArray[np.bool_]:
    return np.isnan(answer.matrix[:, 0, 0])


def _reduction_pays(poisson_m: FloatArray) -> bool:
    """Compare costs in units of a condensation.

    By spectra each Poisson's ratio costs a condensation and half of one for the eigenvalues. The
    basis costs few condensations, a greedy search of about 25, and 1/100 a point.
    """
    distinct = np.unique(poisson_m).size
    return bool(1.5 * distinct > min(distinct, NODES[2]) + 25 + poisson_m.size / 100)


def _of_one_pencil(materials: Materials, points: NDArray[np.int64]) -> Iterator[NDArray[np.int64]]:
    """Groups of points that differ in the particles' modulus alone."""
    ratios = materials.ratios[points]
    rigid = np.isinf(ratios)
    both = np.asarray(rigid.all(axis=1))
    usable = np.logical_or(both, ~rigid.any(axis=1))
    points, ratios, both = points[usable], ratios[usable], both[usable]
    share = np.divide(ratios[:, 1], ratios[:, 0], out=np.ones(len(ratios)), where=~both)
    poisson = [materials.poisson_m, materials.poisson_i, materials.poisson_j]
    keys = np.column_stack([*(value[points] for value in poisson), np.log(share).round(12)])
    _, group, count = np.unique(keys, axis=0, return_inverse=True, return_counts=True)
    for number in np.flatnonzero(count >= FEWEST):
        yield points[group.ravel() == number]


def _share_pencil(
    operators: CellOperators, materials: Materials, group: NDArray[np.int64], answer: Responses
) -> None:
    """Serve a group by its pencil, unless round-off spoils that."""
    ratios = materials.ratios[group, 0]
    softest = int(ratios.argmin())
    first = materials.constants(int(group[softest]))
    share = 1.0 if np.isinf(first.shear[0]) else first.shear[1] / first.shear[0]
    try:
        pencil = operators.pencil(first.poisson_m, first.poisson, share)
        response = materials.shear_m[group][:, None, None] * pencil.response(ratios)
        if materials.compressibility[group[softest]] < COMPRESSIBLE:
            other = operators.response(first)
            if np.abs(response[softest] - other).max() > AGREEMENT * np.abs(other).max():
                return
    except np.linalg.LinAlgError:
        return
    answer.matrix[group] = response
    answer.way[group] = Way.spectrum if group.size >= MANY else Way.direct


def _reduce(
    operators: CellOperators,
    poisson: list[float],
    materials: Materials,
    members: NDArray[np.int64],
    tolerance: float,
    offset: float,
    answer: Responses,
) -> None:
    """Serve the members that a reduced basis serves within the tolerance."""
    own = materials.take(members)
    points = Points.of(own, len(poisson))
    basis = ReducedBasis(operators, poisson, points, tolerance, offset)
    response, bound = basis.respond(points)
    for _ in range(REFINEMENTS):
        missed = np.flatnonzero(_relative(response, bound) > tolerance)
        if not missed.size or not basis.refine(points.take(missed), tolerance):
            break
        response, bound = basis.respond(points)
    good = _relative(response, bound) <= tolerance
    scale = own.shear_m / (2 if operators.is_half else 1)
    size = np.abs(np.diagonal(response, axis1=1, axis2=2))
    answer.matrix[members[good]] = (scale[:, None, None] * response)[good]
    error = scale[:, None] * (bound + size * basis.interpolation_error)
    answer.error[members[good]] = error[good]
    answer.way[members[good]] = Way.reduced_basis


def _relative(response: FloatArray, bound: FloatArray) -> FloatArray:
    size = np.abs(np.diagonal(response, axis1=1, axis2=2))
    return np.asarray((bound / size).max(axis=1))
