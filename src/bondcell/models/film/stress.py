"""Trial stresses of a cell between frictionless plates: they bound its stiffness from below.

Axisymmetric stresses of two free functions q and p balance themselves exactly::

    s_zz = 2 q + r q_r,  s_rz = -r q_z,  s_rr = p,  s_tt = p + r p_r - r^2 q_zz

``2 pi r^2 q`` is the force through the circle of radius r. Tractions are continuous where q, its
slope and p are; the sides are free if p = 0 and q is constant there, the plates are frictionless
if q_z = 0 on them.
"""

from __future__ import annotations

import numpy as np

from bondcell.cell import Cell, FloatArray
from bondcell.models.film.domain import Domain, Geometry, domain, gauss, graded_angles
from bondcell.models.film.energies import gram, minimum, sum_of_grams
from bondcell.models.film.fields import film_coordinate, legendre
from bondcell.models.film.reduced import least_energies_of_many
from bondcell.models.jets import Jet

LINES = 12
"""Functions of the radius alone, of q and of p, through particles and matrix."""

TRACES = 11
"""Functions of the angle on a sphere, of q, of its slope and of p."""

ODD, EVEN = {1: 7, 3: 4}, {0: 7, 2: 4}
"""Power of ``1 - 2 s`` -> radial functions of what vanishes on both spheres, of q and of p."""

LAYERS, PATCHES = 3, 5
"""Functions of depth and of angle of what vanishes outside a particle, of q and of p."""

MATRIX_POINTS, DEPTH_POINTS = (10, 9), 12
"""Gauss points across a panel and along half a line; along a particle's radius and its angle.

Too few would leave stresses whose energy they do not see: the bound would fail."""

BATCH = 4
"""Geometries assembled at once, to bound the memory."""

RELATIVE_ERROR = 1e-4
"""Bound of quadrature and round-off, see tests/verification/test_film_stress.py."""


def stiffness(cell: Cell, gap: FloatArray) -> FloatArray:
    """Lower bound of the normal stiffness over ``E_m`` and the largest radius, but for quadrature.

    Parameters
    ----------
    cell
        Flat cells.
    gap
        The gaps over the largest radius.

    Notes
    -----
    ``1/K <= 2 U*(sigma)`` for every stress that balances itself, leaves the sides free and the
    plates without friction, and carries a unit force: least complementary energy.
    """
    compliance, _ = minimum(cell, gap, complementary, _compliances, batch=BATCH)
    return np.asarray(1 / compliance)


def _compliances(forms: FloatArray, k: int, cell: Cell) -> tuple[FloatArray, FloatArray]:
    """Least complementary energies of points on geometry k, twice, and what reduction adds."""
    soft = (1 + cell.poisson_m, (1 - 2 * cell.poisson_m) / 3)
    factors = np.stack([*soft, cell.young_m / cell.young_i, cell.young_m / cell.young_j], axis=1)
    value, loss = np.empty(cell.young_m.size), np.empty(cell.young_m.size)
    for pattern in np.unique(factors > 0, axis=0):
        here = np.flatnonzero(((factors > 0) == pattern).all(axis=1))
        some = forms[pattern, k]
        # In rigid particles stresses cost nothing and those inside alone do not matter.
        felt = np.flatnonzero(some.sum(axis=0).diagonal() > 0)
        some = some[:, felt[:, None], felt]
        value[here], loss[here] = least_energies_of_many(some, factors[here][:, pattern])
    return value, loss


def stresses(q: Jet | None, p: Jet | None, r: FloatArray) -> FloatArray:
    """``s_rr, s_tt, s_zz, s_rz`` on a leading axis."""
    shape = next(part for part in (q, p) if part is not None).value.shape
    out: FloatArray = np.zeros((4, *shape))
    if p is not None:
        value, p_r = p.parts[:2]
        out[0] = value
        out[1] = value + r * p_r
    if q is not None:
        value, q_r, q_z, _, _, q_zz = q.parts
        out[1] -= r**2 * q_zz
        out[2] = 2 * value + r * q_r
        out[3] = -r * q_z
    return out


def complementary(geometry: Geometry, poisson_i: FloatArray, poisson_j: FloatArray) -> FloatArray:
    """Twice the complementary energies of the trial stresses; the first carries a unit force.

    Parameters
    ----------
    geometry
        Cells of one kind.
    poisson_i, poisson_j
        Poisson's ratios of the particles, shape (cells, 1).

    Returns
    -------
    ndarray
        Of the matrix for unit ``1/(2 mu)`` and for unit ``1/(9 kappa)``, of particle i and of
        particle j for unit Young's modulus; shape (4, cells, stresses, stresses).

    Notes
    -----
    Across the film runs ``s = phi_i/(phi_i + phi_j)``, along it the logarithm of its thickness,
    ``S = 3 s^2 - 2 s^3``. All stresses but the first, which is uniform, have a factor ``R_c^2 -
    r^2`` that frees the sides:

    - functions of the radius alone, of q and of p;
    - ``q = s^2 (1-s)^2 (1-2s)^n P_k`` and ``p = s (1-s) (1-2s)^n P_k``;
    - of sphere i ``q = (1 - S) P_k``, ``q = phi_i (1 - S) P_k`` and ``p = (1 - S) P_k`` with
      functions of ``sin(theta)^2``, which go on in the particle with ``rho^4 (3 - 2 rho^2)``,
      ``rho = |x|/R_i``, instead of 1 - S: as smoothly, and even in z;
    - ``q = phi_i^2 P_k`` and ``p = phi_i P_k`` in the particle alone.
    """
    space = domain(geometry, MATRIX_POINTS)
    s = space.above_i / (space.above_i + space.above_j)
    step = s * s * (3.0 - 2.0 * s)
    rows = [_lines(space.r, geometry), _bubbles(space, s, geometry)]
    ends = (
        (geometry.radius_i, space.z, space.beside_i, 1.0 - step),
        (geometry.radius_j, space.height, space.beside_j, step),
    )
    traces = [_traces(space.r, z, phi, fade, own, geometry) for own, z, phi, fade in ends]
    joined = [traces[0] + traces[1]] if geometry.mirrored else traces
    matrix = _forms(np.concatenate([*rows, *joined], axis=1), space.weights)
    common, first = rows[0].shape[1], rows[0].shape[1] + rows[1].shape[1]
    # Common stresses, bubbles, then of each end traces; last of each end what is inside it.
    inside = 2 * LAYERS * PATCHES
    seen = matrix[0].shape[-1]
    count = seen + len(joined) * inside
    forms: FloatArray = np.zeros((4, *matrix[0].shape[:1], count, count))
    forms[:2, :, :seen, :seen] = matrix
    lower = _particle(geometry, geometry.radius_i, poisson_i)
    upper = lower if geometry.mirrored else _particle(geometry, geometry.radius_j, poisson_j)
    for own, block in enumerate((lower, upper)):
        at = 0 if geometry.mirrored else own
        places = np.concatenate(
            [
                np.arange(common),
                first + at * 3 * TRACES + np.arange(3 * TRACES),
                seen + at * inside + np.arange(inside),
            ]
        )
        forms[2 + own][:, places[:, None], places] = block
    return forms


def _forms(stress: FloatArray, weights: FloatArray) -> FloatArray:
    """``dev s : dev s`` and ``(tr s)^2``, integrated; overwrites the stresses."""
    stress *= np.sqrt(weights)
    trace = stress[0] + stress[1] + stress[2]
    stress[:3] -= trace / 3
    stress[3] *= np.sqrt(2.0)
    return np.stack([sum_of_grams(stress), gram(trace.swapaxes(0, 1))])


def freed(r: Jet, geometry: Geometry) -> Jet:
    """``R_c^2 - r^2``, which frees the sides."""
    return geometry.outer**2 - r * r


def scaled(value: Jet, small: FloatArray, largest: FloatArray | float, count: int) -> Jet:
    """Legendre polynomials of the logarithm of ``value + small``, value from 0 to the largest."""
    low, high = np.log(small), np.log(largest + small)
    x = ((value + small).log() - low) * (2 / (high - low)) - 1.0
    table = legendre(x.value, count)
    return x.compose(table.value, table.first, table.second)


def _lines(r: Jet, geometry: Geometry) -> FloatArray:
    """The uniform stress of a unit force and functions of the radius."""
    along = scaled(r * r, geometry.film_radius**2 / 4, geometry.outer**2, LINES)
    own = along * freed(r, geometry)
    carried = r * 0.0 + 1 / (2 * np.pi * geometry.outer**2)
    rows = [stresses(carried, None, r.value)[:, None]]
    rows += [stresses(own, None, r.value), stresses(None, own, r.value)]
    return np.concatenate(rows, axis=1)


def _bubbles(space: Domain, s: Jet, geometry: Geometry) -> FloatArray:
    """Stresses that leave both spheres alone."""
    r, v = space.r.value, film_coordinate(space)
    bubble, odd = s * (1.0 - s), 1.0 - 2.0 * s
    table = legendre(v.value, max(*ODD.values(), *EVEN.values()))
    along = v.compose(table.value, table.first, table.second)
    base = bubble * freed(space.r, geometry)
    rows = []
    for power, count in (EVEN if geometry.mirrored else EVEN | ODD).items():
        own = base
        for _ in range(power):
            own = own * odd
        field = own * Jet(along.parts[:, :count])
        rows += [stresses(field * bubble, None, r), stresses(None, field, r)]
    return np.concatenate(rows, axis=1)


def _traces(
    r: Jet, z: Jet, phi: Jet, fade: Jet, radius: FloatArray, geometry: Geometry
) -> FloatArray:
    """Force, its slope and radial stress on a sphere, fading with ``fade``."""
    own = angular(r, z, radius, geometry, TRACES) * (fade * freed(r, geometry))
    rows = [stresses(own, None, r.value), stresses(own * phi, None, r.value)]
    return np.concatenate([*rows, stresses(None, own, r.value)], axis=1)


def angular(r: Jet, z: Jet, radius: FloatArray, geometry: Geometry, count: int) -> Jet:
    """Functions of ``sin(theta)^2`` seen from a particle's centre."""
    square = r * r
    width = geometry.film_radius / (2 * radius)
    return scaled(square * (1.0 / (square + z * z)), width**2, 1.0, count)


def _particle(geometry: Geometry, radius: FloatArray, poisson: FloatArray) -> FloatArray:
    """Twice the complementary energy in a particle for unit Young's modulus."""
    r, z, weights = particle_points(geometry, radius)
    phi, fade = inward(r, z, radius)
    rows = [_lines(r, geometry), _traces(r, z, phi, fade, radius, geometry)]
    inside = within(r, z, radius, geometry)
    rows += [stresses(own * phi, None, r.value) for own in inside]
    rows += [stresses(None, own, r.value) for own in inside]
    shear, bulk = _forms(np.concatenate(rows, axis=1), weights)
    return np.asarray((1 + poisson)[..., None] * shear + ((1 - 2 * poisson) / 3)[..., None] * bulk)


def particle_points(geometry: Geometry, radius: FloatArray) -> tuple[Jet, Jet, FloatArray]:
    """``r, z`` in a hemisphere and ``2 pi r dr dz``."""
    borders = graded_angles(0.5 * geometry.film_radius / radius)
    angle, width = gauss(borders, DEPTH_POINTS)
    depth, share = gauss(borders * (2 / np.pi), DEPTH_POINTS)
    grid = (*angle.shape[:-1], angle.shape[-1] * depth.shape[-1])
    distance = (radius * (1 - depth))[:, None, :]
    r = (distance * np.sin(angle)[:, :, None]).reshape(grid)
    z = (distance * np.cos(angle)[:, :, None]).reshape(grid)
    area = (distance * (radius * share)[:, None, :] * width[:, :, None]).reshape(grid)
    return *Jet.variables(r, z), 2 * np.pi * r * area


def inward(r: Jet, z: Jet, radius: FloatArray) -> tuple[Jet, Jet]:
    """``phi``, and ``rho^4 (3 - 2 rho^2)``, which fades to the centre without a slope at 1."""
    square = (r * r + z * z) * (1 / radius**2)
    return (square - 1.0) * (radius / 2), square * square * (3.0 - 2.0 * square)


def within(r: Jet, z: Jet, radius: FloatArray, geometry: Geometry) -> list[Jet]:
    """Functions that vanish outside a particle, for every layer those of the angle."""
    phi, fade = inward(r, z, radius)
    patches = angular(r, z, radius, geometry, PATCHES) * (fade * phi * freed(r, geometry))
    layers = scaled(-phi, geometry.film_radius / 2, radius / 2, LAYERS)
    return [patches * Jet(layers.parts[:, k : k + 1]) for k in range(LAYERS)]
