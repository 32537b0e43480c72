"""Shear and bending: trial displacements of matrix and particles with one wave around the axis.

``u_r = (a + b) cos t, u_t = (a - b) sin t, u_z = w cos t`` with ``a = r^2 alpha``, ``b = beta`` and
``w = r omega``, whose strains stay finite on the axis. Both end planes are held, so no field but
the lift is other than zero there.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from bondcell.cell import FloatArray
from bondcell.models.film_domain import Domain, Geometry, domain, gauss, graded_angles
from bondcell.models.film_energies import Energies, gram, placed, sum_of_grams
from bondcell.models.film_fields import film_coordinate, legendre
from bondcell.models.film_particles import LEAST_COMPRESSIBILITY
from bondcell.models.jets import Jet

SOURCES = 3
"""Points outside a particle's pole."""

FAMILIES = {
    "stream": {0: 5, 1: 5, 2: 2, 3: 2},
    "swirl": {0: 4, 1: 4},
    "alpha": {0: 5, 1: 5, 2: 2},
    "beta": {0: 6, 1: 6, 2: 3, 3: 3},
    "omega": {0: 6, 1: 6, 2: 3, 3: 3},
}
"""Family -> power of ``1 - 2 s`` -> number of radial functions."""

RIM = 0.1
"""Thickness of a soft particle's layer at its end plane, radii."""

FLOWS = 5
"""Widths of the flows across the film."""

DEPTH_POINTS = 8
"""Gauss points across a panel along a particle's radius and along its angle."""


@dataclass(frozen=True)
class Field:
    """``alpha, beta, omega``; jets, None for zero."""

    alpha: Jet | None
    beta: Jet | None
    omega: Jet | None

    def times(self, factor: Jet, alpha: Jet | float = 1.0, omega: Jet | float = 1.0) -> Field:
        """All parts times a factor, alpha and omega times one of their own besides."""
        parts = ((self.alpha, alpha), (self.beta, 1.0), (self.omega, omega))
        return Field(*(None if part is None else part * factor * own for part, own in parts))


def strains(field: Field, r: FloatArray) -> FloatArray:
    """Amplitudes of ``e_rr, e_tt, e_zz, 2 e_rz, 2 e_rt, 2 e_tz``."""
    some = next(part for part in (field.alpha, field.beta, field.omega) if part is not None)
    out: FloatArray = np.zeros((6, *some.value.shape))
    if field.alpha is not None:
        value, d_r, d_z = field.alpha.parts[:3]
        out[0] += 2 * r * value + r**2 * d_r
        out[1] += 2 * r * value
        out[3] += r**2 * d_z
        out[4] += r**2 * d_r
        out[5] += r**2 * d_z
    if field.beta is not None:
        _, d_r, d_z = field.beta.parts[:3]
        out[0] += d_r
        out[3] += d_z
        out[4] -= d_r
        out[5] -= d_z
    if field.omega is not None:
        value, d_r, d_z = field.omega.parts[:3]
        out[2] += r * d_z
        out[3] += value + r * d_r
        out[5] -= value
    return out


def stream_strains(q: Jet | None, p: Jet | None, r: FloatArray) -> FloatArray:
    """Strains of ``alpha = -p_z, beta = -q_z, omega = 4 p + r p_r + q_r/r``: no divergence."""
    shape = next(part for part in (q, p) if part is not None).value.shape
    out: FloatArray = np.zeros((6, *shape))
    if p is not None:
        value, p_r, p_z, p_rr, p_rz, p_zz = p.parts
        out[0] -= 2 * r * p_z + r**2 * p_rz
        out[1] -= 2 * r * p_z
        out[2] += 4 * r * p_z + r**2 * p_rz
        out[3] += 4 * value + 6 * r * p_r + r**2 * (p_rr - p_zz)
        out[4] -= r**2 * p_rz
        out[5] -= 4 * value + r * p_r + r**2 * p_zz
    if q is not None:
        _, q_r, _, q_rr, q_rz, q_zz = q.parts
        out[0] -= q_rz
        out[2] += q_rz
        out[3] += q_rr - q_zz
        out[4] += q_rz
        out[5] += q_zz - q_r / r
    return out


def shear_energies(geometry: Geometry, poisson_i: FloatArray, poisson_j: FloatArray) -> Energies:
    """Quadratic forms with a lift that moves particle j and its plane across the axis."""
    space = domain(geometry)
    s = _fraction(space)
    step = s * s * (3.0 - 2.0 * s)
    middle = geometry.radius_i + geometry.gap / 2
    q = (middle - space.z) * step
    return _energies(geometry, space, s, q, Field(None, s, None), (poisson_i, poisson_j))


def bending_energies(geometry: Geometry, poisson_i: FloatArray, poisson_j: FloatArray) -> Energies:
    """Quadratic forms with a lift that turns particle j and its plane about the plane's centre."""
    space = domain(geometry)
    s = _fraction(space)
    step = s * s * (3.0 - 2.0 * s)
    q = -(space.beside_j * geometry.radius_j * step)
    lift = Field(None, -(space.height * s), -s)
    return _energies(geometry, space, s, q, lift, (poisson_i, poisson_j))


def _fraction(space: Domain) -> Jet:
    return space.above_i / (space.above_i + space.above_j)


def _energies(
    geometry: Geometry,
    space: Domain,
    s: Jet,
    stream: Jet,
    simple: Field,
    poisson: Sequence[FloatArray],
) -> Energies:
    r = space.r.value
    lift = stream_strains(stream, None, r)
    isochoric, other = _bubbles(space, s)
    isochoric = np.concatenate([lift[:, None], _flows(space, geometry, s), isochoric], axis=1)
    sides, blocks = [], []
    for own, (radius, z, fade) in enumerate(
        ((geometry.radius_i, space.z, 1.0 - s), (geometry.radius_j, space.height, s))
    ):
        far = _distances(radius, geometry.film_radius)
        # Seen from plane j the axis points the other way; only omega turns its sign with it.
        sign = 1.0 if own == 0 else -1.0
        across, along, fade = space.r.first_order(), z.first_order(), fade.first_order()
        shrink = radius * (1.0 / (across * across + along * along).sqrt())
        local = _particle_fields(across * shrink, along * shrink, radius, far, poisson[own])
        square = shrink * shrink
        carried = [field.times(fade, alpha=square, omega=shrink * sign) for field in local]
        sides.append(np.stack([strains(field, r) for field in carried], axis=1))
        blocks.append(_particle_energy(radius, far, poisson[own], geometry.film_radius))
    trial = np.concatenate([isochoric, (strains(simple, r) - lift)[:, None], other, *sides], axis=1)
    n = isochoric.shape[1]
    first = trial.shape[1] - sum(side.shape[1] for side in sides)
    shear, bulk = _forms(trial, space.weights / 2, n)
    moved, particles = placed(blocks, first, False, trial.shape[1])
    return Energies(shear, bulk, particles, n, moved)


def _flows(space: Domain, geometry: Geometry, s: Jet) -> FloatArray:
    """Strains of fields without divergence that carry the film sideways.

    ``p = S g(r)``, ``q = S k(r)`` move nothing where S is 1 if ``k_r = -(r^4 g)_r/r^2``: ``g = 1``
    with ``k = -2 r^2``; and for widths c from the film's to the cylinder's ``g = 1/(r^2 + c^2)``,
    ``k = -r^2 g - ln(r^2 + c^2)`` and ``g = 1/(r^2 + c^2)^2``, ``k = 1/(r^2 + c^2) - r^2 g``.
    """
    r, step = space.r.value, s * s * (3.0 - 2.0 * s)
    square = space.r * space.r
    strain = [stream_strains(-2.0 * square * step, step, r)]
    start = np.minimum(0.5 * geometry.film_radius, geometry.outer / 8)
    for power in np.linspace(0, 1, FLOWS):
        width = start * (2 * geometry.outer / start) ** power
        total = square + width**2
        g = 1.0 / total
        k = -(square * g) - (total * (1 / width**2)).log()
        strain.append(stream_strains(k * step, g * step, r))
        steep = g * g * width**2
        strain.append(stream_strains((g * width**2 - square * steep) * step, steep * step, r))
    return np.stack(strain, axis=1)


def _bubbles(space: Domain, s: Jet) -> tuple[FloatArray, FloatArray]:
    """Strains of fields that vanish on both particles: without divergence, and the others."""
    r, v, thickness = space.r.value, film_coordinate(space), 1.0 / space.span
    bubble, odd = s * (1.0 - s), 1.0 - 2.0 * s
    bases = {
        "stream": bubble * bubble * space.span,
        "swirl": bubble * bubble,
        "alpha": bubble * thickness,
        "beta": bubble,
        "omega": bubble,
    }
    count = max(n for family in FAMILIES.values() for n in family.values())
    table = legendre(v.value, count)
    along = v.compose(table.value, table.first, table.second)
    rows: dict[str, list[FloatArray]] = {name: [] for name in bases}
    for name, counts in FAMILIES.items():
        for power, n in counts.items():
            flows = name in ("stream", "swirl")
            base = bases[name] if flows else bases[name].first_order()
            for _ in range(power):
                base = base * odd
            field = base * Jet(along.parts[:, :n])
            rows[name].append(
                {
                    "stream": lambda f: stream_strains(f, None, r),
                    "swirl": lambda f: stream_strains(None, f, r),
                    "alpha": lambda f: strains(Field(f, None, None), r),
                    "beta": lambda f: strains(Field(None, f, None), r),
                    "omega": lambda f: strains(Field(None, None, f), r),
                }[name](field)
            )
    isochoric = np.concatenate([*rows["stream"], *rows["swirl"]], axis=1)
    other = np.concatenate([*rows["alpha"], *rows["beta"], *rows["omega"]], axis=1)
    return isochoric, other


def _forms(trial: FloatArray, weights: FloatArray, isochoric: int) -> tuple[FloatArray, FloatArray]:
    """``2 dev(e) : dev(e)`` of all fields and ``(div u)^2`` of those with divergence.

    Overwrites the strains.
    """
    trial *= np.sqrt(weights)
    divergence = trial[0] + trial[1] + trial[2]
    divergence[:isochoric] = 0
    trial[:3] -= divergence / 3
    trial[:3] *= np.sqrt(2.0)
    return sum_of_grams(trial), gram(divergence[isochoric:].swapaxes(0, 1))


def _distances(radius: FloatArray, film_radius: FloatArray) -> FloatArray:
    """Distances of the sources from the pole, shape (SOURCES, ...)."""
    nearest = np.minimum(0.5 * film_radius, radius / 8)
    power = np.arange(SOURCES).reshape(-1, *(1,) * nearest.ndim) / (SOURCES - 1)
    return np.asarray(nearest * (radius / 2 / nearest) ** power)


def _particle_fields(
    r: Jet, z: Jet, radius: FloatArray, far: FloatArray, poisson: FloatArray
) -> list[Field]:
    """Fields of a particle, zero on its end plane.

    Polynomials; a layer at the held plane, ``z/(z + d)``, for soft particles; and times ``z/R`` a
    point force across the axis and a couple of centres of dilatation, outside the pole.
    """
    square = r * r
    fields = [
        Field(None, z, None),
        Field(None, z * z, None),
        Field(None, z * square, None),
        Field(None, None, z),
        Field(None, None, z * z),
        Field(z, None, None),
        Field(None, z * z * z, None),
        Field(None, None, z * square),
        Field(None, None, z * z * z),
        Field(z * z, None, None),
    ]
    rise = z * (1 / radius)
    layer = z / (z + RIM * radius)
    fields += [Field(layer, None, None), Field(None, layer, None), Field(None, None, layer)]
    for distance in far:
        y = z - (radius + distance)
        inv = 1.0 / (square + y * y).sqrt()
        cube = inv * inv * inv
        fifth = cube * inv * inv
        half = 0.5 * cube
        force = Field(half, inv * (3 - 4 * poisson) + square * half, y * cube)
        couple = Field(-1.5 * fifth, cube - 1.5 * square * fifth, -3.0 * y * fifth)
        fields += [force.times(rise), couple.times(rise * radius**2)]
    return fields


def _particle_energy(
    radius: FloatArray, far: FloatArray, poisson: FloatArray, film_radius: FloatArray
) -> FloatArray:
    """Energy matrix of the fields in a hemisphere, twice the energy for unit Young's modulus."""
    borders = graded_angles(0.5 * film_radius / radius)
    angle, width = gauss(borders, DEPTH_POINTS)
    depth, share = gauss(borders * (2 / np.pi), DEPTH_POINTS)
    grid = (*angle.shape[:-1], angle.shape[-1] * depth.shape[-1])
    distance = (radius * (1 - depth))[:, None, :]
    r_values = (distance * np.sin(angle)[:, :, None]).reshape(grid)
    z_values = (distance * np.cos(angle)[:, :, None]).reshape(grid)
    area = (distance * (radius * share)[:, None, :] * width[:, :, None]).reshape(grid)
    r, z = (one.first_order() for one in Jet.variables(r_values, z_values))
    local = _particle_fields(r, z, radius, far, poisson)
    strain = np.stack([strains(field, r_values) for field in local], axis=1)
    shear, bulk = _forms(strain, np.pi * r_values * area, 0)
    mu = 1 / (2 * (1 + poisson))
    kappa = 1 / (3 * np.maximum(1 - 2 * poisson, LEAST_COMPRESSIBILITY))
    return np.asarray(mu[..., None] * shear + kappa[..., None] * bulk)
