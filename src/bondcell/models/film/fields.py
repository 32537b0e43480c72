"""Trial displacements of the matrix between two particles, as strains at the points of a domain.

One group of fields has no divergence by construction and carries an incompressible matrix; the
other one adds what a compressible matrix does besides. All of them keep the end planes plane and
join the particles, so that the energy of any combination bounds the stiffness from above.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bondcell.cell import FloatArray
from bondcell.models.film.domain import Domain, Geometry
from bondcell.models.film.particles import Traces
from bondcell.models.jets import Curve, Jet

ODD = {"stream": {1: 8, 3: 4}, "radial": {0: 8, 2: 3}, "axial": {1: 6, 3: 2}}
"""Fields of mirror symmetry: family -> power of ``1 - 2 s`` -> number of radial functions."""

EVEN = {"stream": {0: 8, 2: 4}, "radial": {1: 6, 3: 2}, "axial": {0: 7, 2: 3}}
"""Fields that unequal pairs need besides."""


@dataclass(frozen=True)
class Fields:
    """Strains ``e_rr, e_tt, e_zz, 2 e_rz`` of the trial fields, shape (4, fields, cells, points).

    Parameters
    ----------
    isochoric
        Fields without divergence. First the lift, that moves particle j and its plane by 1; then
        bubbles, and from ``first`` on the continuations of the particles' fields; the last one is
        the uniform strain ``(-r/2, z)`` less those of the particles.
    other
        Fields with divergence; the last one is ``(r, 0)`` less those of the particles.
    first
        Position of the first continuation: the only fields that deform the particles.
    """

    isochoric: FloatArray
    other: FloatArray
    first: int


def fields(space: Domain, geometry: Geometry, trace_i: Traces, trace_j: Traces) -> Fields:
    """Trial fields of a domain.

    Notes
    -----
    Across the film runs ``s = phi_i/(phi_i + phi_j)`` from 0 to 1, along it ``v``, the logarithm of
    its thickness; ``P_k`` are Legendre polynomials, ``S = 3 s^2 - 2 s^3``:

    - lift ``psi/r = (S - 1/2)/2``: the parabolic flow of lubrication theory; and ``u_z = s - S``;
    - stream functions ``psi/r = s^2 (1-s)^2 (1-2s)^n P_k(v)``;
    - ``u_r = (r/H) s (1-s) (1-2s)^n P_k(v)`` and ``u_z = s (1-s) (1-2s)^n P_k(v)``;
    - a particle's motion goes on as ``psi/r = [F_0 R^2/|x|^2 + phi (u_z - R cos(theta) u_r/r)/R]
      (1 - S)`` with F_0, u_z, u_r/r of its surface at the same angle.
    """
    v, thickness = film_coordinate(space), 1.0 / space.span
    along = legendre(v.value, max(n for family in ODD.values() for n in family.values()))
    total = space.above_i + space.above_j
    s = space.above_i / total
    bubble = space.above_i * space.above_j / (total * total)
    free = space.beside_i * space.beside_j * thickness * thickness
    step = s * s * (3.0 - 2.0 * s)
    r = space.r.value
    lift = _curl((step.parts - _constant(step, 0.5)) * 0.5, r)
    bases = {"stream": bubble * free, "radial": free * thickness, "axial": bubble}
    powers = _powers(1.0 - 2.0 * s)
    families: dict[str, list[FloatArray]] = {name: [] for name in bases}
    for table in (ODD,) if geometry.mirrored else (ODD, EVEN):
        for name, counts in table.items():
            for power, count in counts.items():
                base = bases[name] * powers[power] if power else bases[name]
                functions = Curve(along.value[:count], along.first[:count], along.second[:count])
                families[name].append(_rows(name, base, v, functions, r))
    lower = _continued(space.z, space, geometry.radius_i, space.above_i, 1.0 - step, trace_i)
    upper = _continued(space.height, space, geometry.radius_j, space.above_j, step, trace_j)
    joined = [lower - upper] if geometry.mirrored else [lower, -upper]
    stretched = _stretched(space, step, geometry.mirrored)
    other_ways = [
        np.stack([way[:, 0] - own[:, 0] - 0.5 * own[:, 1], way[:, 1] - own[:, 1]], axis=1)
        for way, own in zip(stretched, joined, strict=True)
    ]
    uniform = np.zeros_like(lift)
    uniform[0] = uniform[1] = -0.5
    uniform[2] = 1.0
    uniform -= geometry.length * lift
    spread = np.zeros_like(lift)
    spread[0] = spread[1] = 1.0
    for own in joined:
        uniform -= own[:, 0]
        spread -= own[:, 1]
    bubbles = families["stream"]
    return Fields(
        isochoric=np.concatenate([lift[:, None], *bubbles, *joined, uniform[:, None]], axis=1),
        other=np.concatenate(
            [
                _axial((s - step).parts)[:, None],
                *families["radial"],
                *families["axial"],
                *other_ways,
                spread[:, None],
            ],
            axis=1,
        ),
        first=1 + sum(rows.shape[1] for rows in bubbles),
    )


def _stretched(space: Domain, step: Jet, mirrored: bool) -> list[FloatArray]:
    """Uniform strains ``(0, z)`` and ``(r, 0)`` of a particle, faded out without further motion."""
    r, fade = space.r.value, 1.0 - step
    lower = [_axial((space.z * fade).parts), _radial(fade.parts, r)]
    upper = [_axial((space.height * step).parts), _radial(step.parts, r)]
    upper[0] = -upper[0]
    sides = [[a + b for a, b in zip(lower, upper, strict=True)]] if mirrored else [lower, upper]
    return [np.stack(side, axis=1) for side in sides]


def _constant(like: Jet, value: float) -> FloatArray:
    parts = np.zeros_like(like.parts)
    parts[0] = value
    return parts


def _powers(x: Jet) -> dict[int, Jet]:
    square = x * x
    return {1: x, 2: square, 3: square * x}


def film_coordinate(space: Domain) -> Jet:
    """``v``: the logarithm of the thickness, from -1 to 1 over the domain."""
    log = space.span.log()
    low, high = (end(log.value, axis=-1, keepdims=True) for end in (np.min, np.max))
    return (log - low) * (2 / (high - low)) - 1.0


def legendre(x: FloatArray, count: int) -> Curve:
    """The first Legendre polynomials and their derivatives, shape (count, ...)."""
    value, first, second = [np.ones_like(x), x], [0 * x, np.ones_like(x)], [0 * x, 0 * x]
    for k in range(1, count - 1):
        value.append(((2 * k + 1) * x * value[k] - k * value[k - 1]) / (k + 1))
        first.append(first[k - 1] + (2 * k + 1) * value[k])
        second.append(second[k - 1] + (2 * k + 1) * first[k])
    return Curve(np.stack(value), np.stack(first), np.stack(second))


def _continued(
    z: Jet, space: Domain, radius: FloatArray, above: Jet, fade: Jet, trace: Traces
) -> FloatArray:
    """Strains of a particle's fields, continued and faded out, seen from its own end plane."""
    distance2 = space.r * space.r + z * z
    distance = distance2.sqrt()
    m = space.r * space.r / (distance * (distance + z))
    spread = radius**2 * fade / distance2
    slope = above * fade * (1 / radius)
    cosine = 1.0 - Curve.variable(m.value)
    tilt = trace.axial - cosine * trace.radial * radius
    r = space.r.value
    return _rows("stream", spread, m, trace.flux, r) + _rows("stream", slope, m, tilt, r)


def _rows(kind: str, base: Jet, inner: Jet, functions: Curve, r: FloatArray) -> FloatArray:
    """Strains of ``base * f(inner)`` for many f at once, shape (4, functions, cells, points)."""
    strain = {
        "stream": lambda parts: _curl(parts, r),
        "radial": lambda parts: _radial(parts, r),
        "axial": _axial,
    }[kind]
    factors = [strain(parts)[:, None] for parts in base.times_function_of(inner)]
    rows = factors[0] * functions.value
    rows += factors[1] * functions.first
    if kind == "stream":
        rows += factors[2] * functions.second
    return np.asarray(rows)


def _curl(f: FloatArray, r: FloatArray) -> FloatArray:
    """Strains of ``u_r = -r f_z, u_z = 2 f + r f_r``, the stream function being ``r f``."""
    _, f_r, f_z, f_rr, f_rz, f_zz = f
    return np.stack([-f_z - r * f_rz, -f_z, 2 * f_z + r * f_rz, 3 * f_r + r * (f_rr - f_zz)])


def _radial(f: FloatArray, r: FloatArray) -> FloatArray:
    """Strains of ``u_r = r f``."""
    none = np.zeros_like(f[0])
    return np.stack([f[0] + r * f[1], f[0], none, r * f[2]])


def _axial(f: FloatArray) -> FloatArray:
    """Strains of ``u_z = f``."""
    none = np.zeros_like(f[0])
    return np.stack([none, none, f[2], f[1]])
