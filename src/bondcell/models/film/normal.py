"""Normal load: quadratic forms of the trial fields that join film, particles and cylinder."""

from __future__ import annotations

import numpy as np

from bondcell.cell import FloatArray
from bondcell.models.film.domain import Geometry, domain
from bondcell.models.film.energies import Energies, gram, in_a_row, placed, sum_of_grams
from bondcell.models.film.fields import Fields, fields
from bondcell.models.film.particles import distances, energy, traces


def energies(geometry: Geometry, poisson_i: FloatArray, poisson_j: FloatArray) -> Energies:
    """Assemble the quadratic forms of cells of one kind."""
    space = domain(geometry)
    film_radius = geometry.film_radius
    sides = (
        (geometry.radius_i, poisson_i, space.z),
        (geometry.radius_j, poisson_j, space.height),
    )
    surface, blocks = [], []
    for radius, poisson, z in sides:
        far = distances(radius, film_radius)
        length = np.hypot(space.r.value, z.value)
        off = space.r.value**2 / (length * (length + z.value))
        surface.append(traces(off, radius, far, poisson))
        blocks.append(energy(radius, far, poisson, film_radius))
    trial = fields(space, geometry, *surface)
    shear, bulk = _matrix_energy(trial, space.weights)
    moved, particles = placed(
        blocks, in_a_row(blocks, trial.first, geometry.mirrored), shear.shape[-1]
    )
    return Energies(shear, bulk, particles, trial.isochoric.shape[1], moved)


def _matrix_energy(trial: Fields, weights: FloatArray) -> tuple[FloatArray, FloatArray]:
    """``2 dev(e) : dev(e)`` and ``(div u)^2``, integrated."""
    scale = np.sqrt(weights)
    strain = np.concatenate((trial.isochoric, trial.other), axis=1)
    strain *= scale
    swelling = strain[:3, trial.isochoric.shape[1] :].sum(axis=0)
    strain[:3, trial.isochoric.shape[1] :] -= swelling / 3
    strain[:3] *= np.sqrt(2.0)
    return sum_of_grams(strain), gram(swelling.swapaxes(0, 1))
