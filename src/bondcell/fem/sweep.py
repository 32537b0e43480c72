"""Responses of many points on one geometry, by the cheaper of two ways."""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum

import numpy as np
from numpy.typing import NDArray

from bondcell.cell import FloatArray
from bondcell.fem.cell_operators import CellOperators
from bondcell.fem.interpolated_matrix import NODES
from bondcell.fem.materials import Materials
from bondcell.fem.reduced_basis import Points, ReducedBasis

REFINEMENTS = 6
"""How often the greedy search may look again where the bound is still too large."""


class Way(IntEnum):
    """How a point's response was found."""

    direct = 0
    reduced_basis = 1


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
    for point in map(int, np.flatnonzero(answer.way == Way.direct)):
        try:
            answer.matrix[point] = operators.response(materials.constants(point))
        except np.linalg.LinAlgError:
            continue
    return answer


def _reduction_pays(poisson_m: FloatArray) -> bool:
    """Compare costs in units of a condensation: a point costs 1/20, the greedy search about 25."""
    distinct = np.unique(poisson_m).size
    return bool(distinct + poisson_m.size / 20 > min(distinct, NODES[2]) + 25)


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
