"""Responses of many points on one geometry, by the cheaper of two ways."""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum

import numpy as np
from numpy.typing import NDArray

from bondcell.cell import FloatArray
from bondcell.fem.cell_operators import CellOperators
from bondcell.fem.materials import Materials
from bondcell.fem.reduced_basis import NODES, Points, ReducedBasis

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
    operators: CellOperators, materials: list[Materials], tolerance: float, offset: float
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
        See `reduced_basis.InterpolatedMatrix`.
    """
    count, m = len(materials), operators.motions
    answer = Responses(
        np.full((count, m, m), np.nan), np.zeros((count, m)), np.zeros(count, dtype=np.int8)
    )
    groups: dict[tuple[float, ...], list[int]] = {}
    for k, material in enumerate(materials):
        if all(modulus >= material.shear_m for modulus, _ in material.particles):
            particles = material.particles[: len(operators.of_particle)]
            groups.setdefault(tuple(poisson for _, poisson in particles), []).append(k)
    for poisson, members in groups.items():
        if _reduction_pays(materials, members):
            _reduce(operators, poisson, materials, np.array(members), tolerance, offset, answer)
    for point in np.flatnonzero(answer.way == Way.direct):
        try:
            answer.matrix[point] = operators.response(materials[point])
        except np.linalg.LinAlgError:
            continue
    return answer


def _reduction_pays(materials: list[Materials], members: list[int]) -> bool:
    """Compare costs in units of a condensation: a point costs 1/20, the greedy search about 25."""
    distinct = len({materials[k].poisson_m for k in members})
    return distinct + len(members) / 20 > min(distinct, NODES[2]) + 25


def _reduce(
    operators: CellOperators,
    poisson: tuple[float, ...],
    materials: list[Materials],
    members: NDArray[np.int64],
    tolerance: float,
    offset: float,
    answer: Responses,
) -> None:
    """Serve the members that a reduced basis serves within the tolerance."""
    own = [materials[k] for k in members]
    points = Points.of(own, len(poisson))
    basis = ReducedBasis(operators, list(poisson), points, tolerance, offset)
    response, bound = basis.respond(points)
    for _ in range(REFINEMENTS):
        relative = _relative(response, bound)
        missed = np.flatnonzero(relative > tolerance)
        if not missed.size or not basis.refine(points.take(missed), tolerance):
            break
        response, bound = basis.respond(points)
    good = _relative(response, bound) <= tolerance
    scale = np.array([m.shear_m for m in own]) / (2 if operators.is_half else 1)
    size = np.abs(np.diagonal(response, axis1=1, axis2=2))
    answer.matrix[members[good]] = (scale[:, None, None] * response)[good]
    error = scale[:, None] * (bound + size * basis.interpolation_error)
    answer.error[members[good]] = error[good]
    answer.way[members[good]] = Way.reduced_basis


def _relative(response: FloatArray, bound: FloatArray) -> FloatArray:
    size = np.abs(np.diagonal(response, axis1=1, axis2=2))
    return np.asarray((bound / size).max(axis=1))
