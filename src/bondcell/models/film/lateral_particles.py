"""How a particle deforms under shear and bending: simple fields that keep its end plane."""

from __future__ import annotations

import numpy as np

from bondcell.cell import FloatArray
from bondcell.models.film.domain import gauss, graded_angles
from bondcell.models.film.one_wave import Field, quadratic_forms, strains
from bondcell.models.film.particles import LEAST_COMPRESSIBILITY
from bondcell.models.jets import Jet

SOURCES = 3
"""Points outside a particle's pole."""

RIM = 0.1
"""Thickness of a soft particle's layer at its end plane, radii."""

DEPTH_POINTS = 8
"""Gauss points across a panel along a particle's radius and along its angle."""


def distances(radius: FloatArray, film_radius: FloatArray) -> FloatArray:
    """Distances of the sources from the pole, shape (SOURCES, ...)."""
    nearest = np.minimum(0.5 * film_radius, radius / 8)
    power = np.arange(SOURCES).reshape(-1, *(1,) * nearest.ndim) / (SOURCES - 1)
    return np.asarray(nearest * (radius / 2 / nearest) ** power)


def particle_fields(
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


def energy(
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
    local = particle_fields(r, z, radius, far, poisson)
    strain = np.stack([strains(field, r_values) for field in local], axis=1)
    shear, bulk = quadratic_forms(strain, np.pi * r_values * area, 0)
    mu = 1 / (2 * (1 + poisson))
    kappa = 1 / (3 * np.maximum(1 - 2 * poisson, LEAST_COMPRESSIBILITY))
    return np.asarray(mu[..., None] * shear + kappa[..., None] * bulk)
