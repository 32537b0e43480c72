"""How a particle deforms under shear and bending: fields that keep its end plane.

Its surface moves with flows without divergence, whose potentials go on in the matrix, so that it
gives way to a matrix that cannot be compressed; and with layers at the held plane. No two of them
move the surface alike: their difference would be a field of the matrix that costs a stiff particle
nothing but digits. Inside the particle is free to be compressed: fields that vanish on its surface
are taken out by minimising over them.
"""

from __future__ import annotations

import numpy as np

from bondcell.cell import FloatArray
from bondcell.models.film.domain import gauss, graded_angles
from bondcell.models.film.one_wave import Field, quadratic_forms, strains, stream_strains
from bondcell.models.film.particles import LEAST_COMPRESSIBILITY
from bondcell.models.film.solve import RIDGE
from bondcell.models.jets import Jet

SOURCES = 3
"""Points outside a particle's pole."""

RIM = 0.1
"""Thickness of a soft particle's layer at its end plane, radii."""

FLOW_DEGREE = 2
"""Degree of the polynomials, beside their ``z^2``, that are potentials of flows."""

DEPTH_POINTS = 8
"""Gauss points across a panel along a particle's radius and along its angle."""


def distances(radius: FloatArray, film_radius: FloatArray) -> FloatArray:
    """Distances of the sources from the pole, shape (SOURCES, ...)."""
    nearest = np.minimum(0.5 * film_radius, radius / 8)
    power = np.arange(SOURCES).reshape(-1, *(1,) * nearest.ndim) / (SOURCES - 1)
    return np.asarray(nearest * (radius / 2 / nearest) ** power)


def layers(z: Jet, radius: FloatArray) -> list[Field]:
    """A layer at the held plane, ``z/(z + d)``: the clamped rim of a soft particle."""
    layer = z / (z + RIM * radius)
    return [Field(layer, None, None), Field(None, layer, None), Field(None, None, layer)]


def inner_fields(
    r: Jet, z: Jet, radius: FloatArray, far: FloatArray, poisson: FloatArray
) -> list[Field]:
    """Fields that are zero on the end plane; times ``1 - |x|^2/R^2`` they compress the inside.

    Polynomials, `layers`, and times ``z/R`` a point force across the axis and a couple of centres
    of dilatation, outside the pole.
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
    fields += layers(z, radius)
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


def flow_potentials(
    r: Jet, z: Jet, radius: FloatArray, far: FloatArray
) -> list[tuple[Jet | None, Jet | None]]:
    """Potentials (q, p) of flows that rest on the end plane, which ``z^2`` sees to.

    Polynomials up to `FLOW_DEGREE` in z and r^2, and powers of the distance from points outside
    the pole.
    """
    square, along = r * r, z * (1 / radius)
    rise, across = along * along, square * (1 / radius**2)
    flows: list[tuple[Jet | None, Jet | None]] = []
    column = rise
    for outer in range(FLOW_DEGREE + 1):
        power = column
        for _ in range(FLOW_DEGREE + 1 - outer):
            flows += [(power * radius**2, None), (None, power * radius)]
            power = power * along
        column = column * across
    for distance in far:
        y = z - (radius + distance)
        inv = 1.0 / (square + y * y).sqrt()
        cube = inv * inv * inv
        flows += [(rise * inv * radius**2, None), (rise * cube * radius**4, None)]
        flows += [(None, rise * cube * radius**3), (None, rise * inv * radius)]
    return flows


def energy(
    radius: FloatArray, far: FloatArray, poisson: FloatArray, film_radius: FloatArray
) -> FloatArray:
    """Energy matrix of the fields in a hemisphere, twice the energy for unit Young's modulus.

    Parameters
    ----------
    radius, poisson, film_radius
        Shape (cells, 1).
    far
        Distances of the sources from the pole, shape (SOURCES, cells, 1).

    Returns
    -------
    ndarray
        Of `flow_potentials` and then `layers`.
    """
    r, z, weights = _interior(radius, film_radius)
    across, along = r.first_order(), z.first_order()
    local = inner_fields(across, along, radius, far, poisson)
    flows = [stream_strains(*flow, r.value) for flow in flow_potentials(r, z, radius, far)]
    inside = 1.0 - (across * across + along * along) * (1 / radius**2)
    rows = [strains(field, r.value) for field in layers(along, radius)]
    rows += [strains(field.times(inside), r.value) for field in local]
    shear, bulk = quadratic_forms(np.stack([*flows, *rows], axis=1), weights / 2, len(flows))
    mu = 1 / (2 * (1 + poisson))[..., None]
    kappa = 1 / (3 * np.maximum(1 - 2 * poisson, LEAST_COMPRESSIBILITY))[..., None]
    whole = mu * shear
    whole[:, len(flows) :, len(flows) :] += kappa * bulk
    return _without_last(whole, len(local))


def _interior(radius: FloatArray, film_radius: FloatArray) -> tuple[Jet, Jet, FloatArray]:
    """``r, z`` in a hemisphere and ``2 pi r dr dz``."""
    borders = graded_angles(0.5 * film_radius / radius)
    angle, width = gauss(borders, DEPTH_POINTS)
    depth, share = gauss(borders * (2 / np.pi), DEPTH_POINTS)
    grid = (*angle.shape[:-1], angle.shape[-1] * depth.shape[-1])
    distance = (radius * (1 - depth))[:, None, :]
    r = (distance * np.sin(angle)[:, :, None]).reshape(grid)
    z = (distance * np.cos(angle)[:, :, None]).reshape(grid)
    area = (distance * (radius * share)[:, None, :] * width[:, :, None]).reshape(grid)
    return *Jet.variables(r, z), 2 * np.pi * r * area


def _without_last(matrix: FloatArray, count: int) -> FloatArray:
    """The least energy over the last fields, as a form of the others.

    Whatever is put in for the last fields gives an upper bound, so a ridge does no harm.
    """
    n = matrix.shape[-1] - count
    kept, mixed, inner = matrix[:, :n, :n], matrix[:, n:, :n], matrix[:, n:, n:]
    ridge = RIDGE * np.einsum("...kk->...k", inner)
    found = -np.linalg.solve(inner + ridge[..., None] * np.eye(count), mixed)
    half = mixed.swapaxes(-1, -2) @ found
    return np.asarray(kept + half + half.swapaxes(-1, -2) + found.swapaxes(-1, -2) @ inner @ found)
