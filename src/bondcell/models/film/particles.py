"""How a particle deforms: exact elastic fields of a sphere, their energy and their traces.

The hemisphere on its end plane is half of a sphere that deforms in mirror symmetry. Fields are two
uniform strains, and Kelvin's point force and the centre of dilatation at points of the axis
outside the sphere, mirrored: near the pole they are the dents that the pressure of a film makes.
Moduli are in units of the particle's Young's modulus, forces over ``8 pi mu (1 - nu)``.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bondcell.cell import FloatArray
from bondcell.models.film.domain import gauss, graded_angles
from bondcell.models.jets import Curve

SOURCES = 5
"""Points outside the pole, in geometric progression from half the film's width to a radius."""

COUNT = 2 + 2 * SOURCES
"""Fields of a particle."""

SURFACE_POINTS = 8
"""Gauss points across a panel of the surface."""

LEAST_COMPRESSIBILITY = 1e-9
"""Least ``1 - 2 nu`` of a particle; at nu = 1/2 the second uniform strain is shut off by it."""


@dataclass(frozen=True)
class Traces:
    """Displacement of the surface over ``m = 1 - cos(theta)``, curves of shape (fields, ...).

    Parameters
    ----------
    axial
        ``u_z``.
    radial
        ``u_r / r``.
    flux
        ``F_0 = (1/r^2) * integral of u_n dA / (2 pi)`` over the cap inside r: the value there of
        ``psi/r``, psi the stream function of a field without divergence that continues u.
    """

    axial: Curve
    radial: Curve
    flux: Curve


def distances(radius: FloatArray, film_radius: FloatArray) -> FloatArray:
    """Distances of the sources from the pole, shape (SOURCES, ...)."""
    nearest = np.minimum(0.5 * film_radius, radius / 8)
    power = np.arange(SOURCES).reshape(-1, *(1,) * nearest.ndim) / (SOURCES - 1)
    return np.asarray(nearest * (radius / nearest) ** power)


def traces(m: FloatArray, radius: FloatArray, far: FloatArray, poisson: FloatArray) -> Traces:
    """Traces of all fields on a sphere.

    Parameters
    ----------
    m
        ``1 - cos(theta)``, shape (cells, points).
    radius, poisson
        The sphere's, shape (cells, 1).
    far
        Distances of the sources from the pole, shape (SOURCES, cells, 1).

    Notes
    -----
    With ``rho^2 = r^2 + (z - z_s)^2`` Kelvin's field is a Stokeslet, ``psi/r = 1/rho``, and ``2 (1
    - 2 nu) e_z/rho``; the centre of dilatation ``grad(1/rho)`` has ``psi/r = 1/(rho (rho + z_s -
    z))``. The mirror image is ``u_r(r, -z), -u_z(r, -z)``. The flux of ``e_z/rho`` through a cap
    is elementary since ``d(rho^2)`` is in proportion to dm.
    """
    off = Curve.variable(m)
    cosine = 1.0 - off
    pole = radius + far
    squares, product = radius**2 + pole**2, 2 * radius * pole
    near, mirror = (off * product + far**2).sqrt(), (cosine * product + squares).sqrt()
    inv, inv_mirror = 1.0 / near, 1.0 / mirror
    cube, cube_mirror = inv * inv * inv, inv_mirror * inv_mirror * inv_mirror
    height = cosine * radius
    down, up = height - pole, height + pole
    share = 2 * (1 - 2 * poisson)
    cap = _cap(near, far, squares, cosine) + _cap(mirror, radius + pole, squares, cosine)
    shift = inv - inv_mirror
    kelvin = (
        shift * (1 + share) + down * down * cube - up * up * cube_mirror,
        down * cube - up * cube_mirror,
        shift + cap * (share * 2 / product),
    )
    dilatation = (
        -(down * cube) - up * cube_mirror,
        -cube - cube_mirror,
        1.0 / (near * (near - down)) - 1.0 / (mirror * (mirror + up)),
    )
    rows = zip(_uniform(off, cosine, radius), kelvin, dilatation, strict=True)
    return Traces(*(_stacked(*row) for row in rows))


def _cap(rho: Curve, end: FloatArray, squares: FloatArray, cosine: Curve) -> Curve:
    """Flux of ``e_z/rho`` from the pole, where rho is ``end``, over ``2 r^2/(2 R z_s)``."""
    mean = (rho * rho + rho * end + end**2) * (1 / 3)
    return (squares - mean) / ((rho + end) * (1.0 + cosine))


def _uniform(off: Curve, cosine: Curve, radius: FloatArray) -> tuple[list[Curve], ...]:
    """Traces of ``(-r/2, z)`` and of ``(r, 0)``."""
    one, none = off * 0.0 + 1.0, off * 0.0
    flux = off * (2.0 + cosine) / ((1.0 + cosine) * 3.0) * radius
    return [cosine * radius, none], [one * -0.5, one], [cosine * (0.5 * radius), flux]


def _stacked(uniform: list[Curve], *groups: Curve) -> Curve:
    parts = (
        [np.stack([getattr(u, name) for u in uniform]), *(getattr(g, name) for g in groups)]
        for name in ("value", "first", "second")
    )
    return Curve(*(np.concatenate(part) for part in parts))


def energy(
    radius: FloatArray, far: FloatArray, poisson: FloatArray, film_radius: FloatArray
) -> FloatArray:
    """Energy matrix of the fields in a hemisphere, twice the energy for unit Young's modulus.

    Parameters
    ----------
    radius, poisson, film_radius
        Shape (cells, 1).
    far
        Shape (SOURCES, cells, 1).

    Returns
    -------
    ndarray
        Shape (cells, COUNT, COUNT), the order of `traces`.

    Notes
    -----
    The fields are in equilibrium without body force and the end plane does no work, so the energy
    is that of the surface tractions, ``integral of t_k . u_l dA``.
    """
    angle, width = gauss(graded_angles(0.5 * film_radius / radius), SURFACE_POINTS)
    sine, cosine = np.sin(angle), np.cos(angle)
    moved, tractions = [], []
    for radial, axial, s_rr, s_zz, s_rz in _fields(
        radius * sine, radius * cosine, radius + far, poisson
    ):
        moved.append(np.concatenate((radial, axial), axis=-1))
        pull = (s_rr * sine + s_rz * cosine, s_rz * sine + s_zz * cosine)
        tractions.append(np.concatenate(pull, axis=-1))
    area = np.tile(2 * np.pi * radius**2 * sine * width, 2)
    u = np.moveaxis(np.concatenate(moved), 0, 1)
    t = np.moveaxis(np.concatenate(tractions), 0, 1)
    work = (t * area[:, None]) @ np.swapaxes(u, -1, -2)
    return np.asarray((work + np.swapaxes(work, -1, -2)) / 2)


def _fields(
    r: FloatArray, z: FloatArray, pole: FloatArray, poisson: FloatArray
) -> list[tuple[FloatArray, ...]]:
    """``u_r, u_z, sigma_rr, sigma_zz, sigma_rz`` of the fields in groups (fields, cells, points).

    The hoop stress does not pull at the surface. ``lambda div u`` of Kelvin's field is ``-4 mu nu
    (z - z_s)/rho^3``, finite at nu = 1/2.
    """
    mu = 1 / (2 * (1 + poisson))
    lam = 2 * mu * poisson / np.maximum(1 - 2 * poisson, LEAST_COMPRESSIBILITY)
    one, none = np.ones_like(r)[None], np.zeros_like(r)[None]
    groups: list[tuple[FloatArray, ...]] = [
        (-r[None] / 2, z[None], -mu * one, 2 * mu * one, none),
        (r[None], none, 2 * (mu + lam) * one, 2 * lam * one, none),
    ]
    kelvin: FloatArray = np.zeros((5, *np.broadcast_shapes(pole.shape, r.shape)))
    dilatation = np.zeros_like(kelvin)
    weight = 3 - 4 * poisson
    for side in (1.0, -1.0):
        y = side * z - pole
        inv2 = 1 / (r * r + y * y)
        inv = np.sqrt(inv2)
        cube, fifth = inv * inv2, inv * inv2 * inv2
        pressure = -4 * mu * poisson * y * cube
        kelvin[0] += r * y * cube
        kelvin[1] += side * (weight * inv + y * y * cube)
        kelvin[2] += 2 * mu * (y * cube - 3 * r * r * y * fifth) + pressure
        kelvin[3] += 2 * mu * ((2 - weight) * y * cube - 3 * y**3 * fifth) + pressure
        kelvin[4] += side * mu * ((1 - weight) * r * cube - 6 * r * y * y * fifth)
        dilatation[0] -= r * cube
        dilatation[1] -= side * y * cube
        dilatation[2] += 2 * mu * (3 * r * r * fifth - cube)
        dilatation[3] += 2 * mu * (3 * y * y * fifth - cube)
        dilatation[4] += side * 6 * mu * r * y * fifth
    return [*groups, tuple(kelvin), tuple(dilatation)]
