"""Trial shear stresses of a twisted cell: they bound its stiffness against torsion from below.

``s_rt = -r^2 q_z, s_zt = 4 r q + r^2 q_r`` balance themselves for any q; ``2 pi r^4 q`` is the
torque through the circle of radius r. Tractions are continuous where q is, and the sides are free
if q is constant there.
"""

from __future__ import annotations

import numpy as np

from bondcell.cell import Cell, FloatArray
from bondcell.models.film.domain import Geometry, domain
from bondcell.models.film.energies import minimum, sum_of_grams
from bondcell.models.film.fields import film_coordinate, legendre
from bondcell.models.film.reduced import least_energies_of_many
from bondcell.models.film.stress import (
    BATCH,
    EVEN,
    LAYERS,
    LINES,
    MATRIX_POINTS,
    ODD,
    PATCHES,
    TRACES,
    angular,
    freed,
    inward,
    particle_points,
    scaled,
    within,
)
from bondcell.models.jets import Jet


def stiffness(cell: Cell, gap: FloatArray) -> FloatArray:
    """Lower bound of the torsional stiffness over ``E_m`` and the cube of the largest radius.

    Parameters
    ----------
    cell
        Flat cells.
    gap
        The gaps over the largest radius.
    """
    compliance, _ = minimum(cell, gap, complementary, _compliances, batch=BATCH)
    return np.asarray(1 / compliance)


def _compliances(forms: FloatArray, k: int, cell: Cell) -> tuple[FloatArray, FloatArray]:
    """Least complementary energies of points on geometry k, twice, and what reduction adds."""
    shares = (cell.young_m / cell.young_i, cell.young_m / cell.young_j)
    factors = np.stack([2 * (1 + cell.poisson_m), *shares], axis=1)
    value, loss = np.empty(cell.young_m.size), np.empty(cell.young_m.size)
    for pattern in np.unique(factors > 0, axis=0):
        here = np.flatnonzero(((factors > 0) == pattern).all(axis=1))
        some = forms[pattern, k]
        felt = np.flatnonzero(some.sum(axis=0).diagonal() > 0)
        some = some[:, felt[:, None], felt]
        value[here], loss[here] = least_energies_of_many(some, factors[here][:, pattern])
    return value, loss


def complementary(geometry: Geometry, poisson_i: FloatArray, poisson_j: FloatArray) -> FloatArray:
    """Twice the complementary energies of the trial stresses; the first carries a unit torque.

    Parameters
    ----------
    geometry
        Cells of one kind.
    poisson_i, poisson_j
        Poisson's ratios of the particles, shape (cells, 1).

    Returns
    -------
    ndarray
        Of the matrix for unit ``1/mu``, of particle i and of particle j for unit Young's modulus;
        shape (3, cells, stresses, stresses). The functions q are those of `stress`.
    """
    space = domain(geometry, MATRIX_POINTS)
    s = space.above_i / (space.above_i + space.above_j)
    side = freed(space.r, geometry)
    table = legendre(film_coordinate(space).value, max(*ODD.values(), *EVEN.values()))
    along = film_coordinate(space).compose(table.value, table.first, table.second)
    base = s * (1.0 - s) * side
    bubbles = []
    for power, count in (EVEN if geometry.mirrored else EVEN | ODD).items():
        own = base
        for _ in range(power):
            own = own * (1.0 - 2.0 * s)
        bubbles.append(_shear(own * Jet(along.parts[:, :count]), space.r.value))
    ends = ((geometry.radius_i, space.z, 1.0 - s), (geometry.radius_j, space.height, s))
    traces = [
        _shear(angular(space.r, z, radius, geometry, TRACES) * (fade * side), space.r.value)
        for radius, z, fade in ends
    ]
    joined = [traces[0] + traces[1]] if geometry.mirrored else traces
    common = _lines(space.r, geometry)
    trial = np.concatenate([common, *bubbles, *joined], axis=1)
    trial *= np.sqrt(space.weights)
    first, seen = trial.shape[1] - len(joined) * TRACES, trial.shape[1]
    inside = LAYERS * PATCHES
    count = seen + len(joined) * inside
    forms: FloatArray = np.zeros((3, geometry.gap.shape[0], count, count))
    forms[0, :, :seen, :seen] = sum_of_grams(trial)
    for end, (radius, poisson) in enumerate(
        ((geometry.radius_i, poisson_i), (geometry.radius_j, poisson_j))
    ):
        at = 0 if geometry.mirrored else end
        places = np.concatenate(
            [
                np.arange(common.shape[1]),
                first + at * TRACES + np.arange(TRACES),
                seen + at * inside + np.arange(inside),
            ]
        )
        block = 2 * (1 + poisson[..., None]) * _particle(geometry, radius)
        forms[1 + end][:, places[:, None], places] = block
    return forms


def _shear(q: Jet, r: FloatArray) -> FloatArray:
    """``s_rt, s_zt`` on a leading axis."""
    value, q_r, q_z = q.parts[:3]
    return np.stack([-(r**2) * q_z, 4 * r * value + r**2 * q_r])


def _lines(r: Jet, geometry: Geometry) -> FloatArray:
    """The stress of a uniform twist under a unit torque, and functions of the radius."""
    along = scaled(r * r, geometry.film_radius**2 / 4, geometry.outer**2, LINES)
    carried = _shear(r * 0.0 + 1 / (2 * np.pi * geometry.outer**4), r.value)[:, None]
    return np.concatenate([carried, _shear(along * freed(r, geometry), r.value)], axis=1)


def _particle(geometry: Geometry, radius: FloatArray) -> FloatArray:
    """Twice the complementary energy in a particle for unit shear modulus."""
    r, z, weights = particle_points(geometry, radius)
    _, fade = inward(r, z, radius)
    own = angular(r, z, radius, geometry, TRACES) * (fade * freed(r, geometry))
    inside = [_shear(field, r.value) for field in within(r, z, radius, geometry)]
    trial = np.concatenate([_lines(r, geometry), _shear(own, r.value), *inside], axis=1)
    trial *= np.sqrt(weights)
    return sum_of_grams(trial)
