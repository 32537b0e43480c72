"""Torsion: trial rotations about the axis, ``u_t = r f(r, z)``, of matrix and particles."""

from __future__ import annotations

import numpy as np

from bondcell.cell import FloatArray
from bondcell.models.film.domain import Domain, Geometry, domain, gauss, graded_angles
from bondcell.models.film.energies import Energies, gram, in_a_row, placed
from bondcell.models.film.fields import film_coordinate, legendre
from bondcell.models.film.particles import SOURCES, SURFACE_POINTS, distances
from bondcell.models.jets import Curve, Jet

COUNT = 1 + SOURCES
"""Fields of a particle: uniform twist and a point source at each distance."""

ODD = {1: 6, 3: 3}
"""Power of ``1 - 2 s`` -> number of radial functions, mirror symmetry."""

EVEN = {0: 6, 2: 3}
"""What unequal pairs need besides."""


def energies(geometry: Geometry, poisson_i: FloatArray, poisson_j: FloatArray) -> Energies:
    """Assemble the quadratic forms of cells of one kind.

    Notes
    -----
    ``2 U = integral of mu r^2 (f_r^2 + f_z^2) dV``. Trial fields are the lift ``s``, bubbles ``s
    (1-s) (1-2s)^n P_k(v)``, and the particles' own fields ``f = z`` and ``1/rho^3``, mirrored,
    which continue as functions of the angle that fade like ``1 - s``. A single material twists
    uniformly, which is among them.
    """
    space = domain(geometry)
    trial, first = _fields(space, geometry)
    slopes = trial * (space.r.value * np.sqrt(space.weights))
    rows = np.moveaxis(slopes, 2, 0).swapaxes(1, 2)
    shear = gram(rows.reshape(*rows.shape[:2], -1))
    count = shear.shape[-1]
    blocks = []
    for radius, poisson in ((geometry.radius_i, poisson_i), (geometry.radius_j, poisson_j)):
        far = distances(radius, geometry.film_radius)
        form = _energy(radius, far, geometry.film_radius)
        blocks.append(form / (2 * (1 + poisson[..., None])))
    moved, particles = placed(blocks, in_a_row(blocks, first, geometry.mirrored), count)
    return Energies(shear, np.zeros((shear.shape[0], 0, 0)), particles, count, moved)


def _fields(space: Domain, geometry: Geometry) -> tuple[FloatArray, int]:
    """``f_r, f_z`` of the trial fields, shape (2, fields, cells, points), first continuation."""
    total = space.above_i + space.above_j
    s = space.above_i / total
    bubble, odd = s * (1.0 - s), 1.0 - 2.0 * s
    v = film_coordinate(space)
    rows = [s.parts[1:3, None]]
    for table in (ODD,) if geometry.mirrored else (ODD, EVEN):
        for power, count in table.items():
            base = bubble
            for _ in range(power):
                base = base * odd
            rows.append(_slopes(base, v, legendre(v.value, count)))
    first = sum(part.shape[1] for part in rows)
    sides = []
    for z, radius, fade, sign in (
        (space.z, geometry.radius_i, 1.0 - s, 1.0),
        (space.height, geometry.radius_j, s, -1.0),
    ):
        distance = (space.r * space.r + z * z).sqrt()
        m = space.r * space.r / (distance * (distance + z))
        trace = _traces(m.value, radius, distances(radius, geometry.film_radius))
        sides.append(sign * _slopes(fade, m, trace))
    joined = [sides[0] + sides[1]] if geometry.mirrored else sides
    uniform = space.z.parts[1:3] - geometry.length * s.parts[1:3]
    for own in joined:
        uniform = uniform - own[:, 0]
    return np.concatenate([*rows, *joined, uniform[:, None]], axis=1), first


def _slopes(base: Jet, inner: Jet, functions: Curve) -> FloatArray:
    value, first, _ = (part[1:3, None] for part in base.times_function_of(inner))
    return np.asarray(value * functions.value + first * functions.first)


def _traces(m: FloatArray, radius: FloatArray, far: FloatArray) -> Curve:
    """Values on the sphere: ``z`` and ``(R/rho)^3 - (R/rho')^3``, shape (COUNT, ...)."""
    off = Curve.variable(m)
    pole = radius + far
    near = 1.0 / (off * (2 * radius * pole) + far**2).sqrt()
    mirror = 1.0 / ((1.0 - off) * (2 * radius * pole) + (radius**2 + pole**2)).sqrt()
    point = (near * near * near - mirror * mirror * mirror) * radius**3
    uniform = (1.0 - off) * radius
    parts = (
        np.concatenate([getattr(uniform, name)[None], getattr(point, name)])
        for name in ("value", "first", "second")
    )
    return Curve(*parts)


def _energy(radius: FloatArray, far: FloatArray, film_radius: FloatArray) -> FloatArray:
    """Twice the energy in a hemisphere for unit shear modulus: ``integral of t u dA``.

    The fields solve ``(1/r^3) (r^3 f_r)_r + f_zz = 0`` and keep the end plane.
    """
    angle, width = gauss(graded_angles(0.5 * film_radius / radius), SURFACE_POINTS)
    sine, cosine = np.sin(angle), np.cos(angle)
    r, z, pole = radius * sine, radius * cosine, radius + far
    value, normal = [z[None]], [cosine[None]]
    point, slope_point = np.zeros_like(pole * z), np.zeros_like(pole * z)
    for side in (1.0, -1.0):
        y = side * z - pole
        square = r * r + y * y
        cube = radius**3 / (square * np.sqrt(square))
        slope = -3 * cube / square * (r * sine + side * y * cosine)
        point += side * cube
        slope_point += side * slope
    value.append(point)
    normal.append(slope_point)
    u = np.moveaxis(np.concatenate(value), 0, 1) * r[:, None]
    t = np.moveaxis(np.concatenate(normal), 0, 1) * r[:, None]
    area = 2 * np.pi * radius * r * width
    work = (t * area[:, None]) @ np.swapaxes(u, -1, -2)
    return np.asarray((work + np.swapaxes(work, -1, -2)) / 2)
