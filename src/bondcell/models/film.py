"""The film model: the cell's energy minimised over a few dozen fields that know the film."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from bondcell.cell import Cell, FloatArray
from bondcell.models import film_lateral, film_torsion
from bondcell.models.film_domain import Geometry, domain
from bondcell.models.film_energies import (
    Assembly,
    Energies,
    gram,
    least,
    minimum,
    placed,
    sum_of_grams,
)
from bondcell.models.film_fields import Fields, fields
from bondcell.models.film_particles import distances, energy, traces
from bondcell.models.model import Model, Springs

LONGEST = 3.0
"""Gap over the cylinder's radius beyond which the rest is a bar."""

RELATIVE_ERROR = 1e-4
"""Bound of quadrature and round-off, see tests/verification/test_film.py; reduction adds to it."""


LONG_ERROR = 5e-4
"""The same for gaps longer than the cylinder's radius, whose lines have as many points."""


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
    moved, particles = placed(blocks, trial.first, geometry.mirrored, shear.shape[-1])
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


def normal(cell: Cell) -> Springs:
    """Normal stiffness: least energy over fields that join film, particles and cylinder.

    Parameters
    ----------
    cell
        Bond cells of any shape. Those that share geometry and Poisson's ratios of the particles
        share the assembly, which is most of the cost.

    Returns
    -------
    Springs
        ``K_n`` [N/m], no parts. The exact K_n between frictionless plates is not above it, but for
        quadrature, round-off and the bar of long gaps.

    Notes
    -----
    ``K_n = min 2 U(u)`` over displacements u that move end plane j by 1 and keep plane i, with the
    trial fields of `film_fields` in the matrix and of `film_particles` in the particles. Nothing
    is calibrated. A gap longer than `LONGEST` radii is a cell of that gap in series with a bar,
    ``pi E_m R_c^2`` over the rest of the length: Saint-Venant's principle.

    Examples
    --------
    >>> cell = Cell.from_values(
    ...     radius_i=7.5e-3,
    ...     gap=5e-4,
    ...     young_i=3e10,
    ...     young_m=1.4e6,
    ...     poisson_i=0.25,
    ...     poisson_m=0.46,
    ... )
    >>> float(normal(cell).stiffness.round(-2))  # finite elements: 162461
    162700.0
    """
    flat = cell.ravel()
    scale = np.maximum(flat.radius_i, flat.radius_j)
    outer = flat.cylinder_radius / scale
    gap = np.minimum(flat.gap / scale, LONGEST * outer)
    value, loss = minimum(flat, gap, energies, least)
    value /= 1 + value * (flat.gap / scale - gap) / (np.pi * outer**2)
    return _springs(cell, value * flat.young_m * scale, loss)


def torsion(cell: Cell) -> Springs:
    """Stiffness against torsion: least energy over trial rotations.

    Parameters
    ----------
    cell
        Bond cells of any shape.

    Returns
    -------
    Springs
        ``K_t`` [N m/rad], no parts; an upper bound as the normal stiffness is.

    Notes
    -----
    See `film_torsion`. A long gap is in series with a bar, ``G_m pi R_c^4/2`` over its length.

    Examples
    --------
    >>> cell = Cell.from_values(
    ...     radius_i=7.5e-3,
    ...     gap=5e-4,
    ...     young_i=3e10,
    ...     young_m=1.4e6,
    ...     poisson_i=0.25,
    ...     poisson_m=0.46,
    ... )
    >>> float(torsion(cell).stiffness.round(3))  # finite elements: 0.52188
    0.522
    """
    flat = cell.ravel()
    scale = np.maximum(flat.radius_i, flat.radius_j)
    outer = flat.cylinder_radius / scale
    gap = np.minimum(flat.gap / scale, LONGEST * outer)
    value, loss = minimum(flat, gap, film_torsion.energies, least)
    bar = np.pi * outer**4 / (4 * (1 + flat.poisson_m))
    value /= 1 + value * (flat.gap / scale - gap) / bar
    return _springs(cell, value * flat.young_m * scale**3, loss)


def shear(cell: Cell) -> Springs:
    """Stiffness against shear with both end planes held: least energy over trial displacements.

    Parameters
    ----------
    cell
        Bond cells of any shape.

    Returns
    -------
    Springs
        ``K_s`` [N/m], no parts; an upper bound. NaN where the gap is longer than `LONGEST` radii.

    Notes
    -----
    See `film_lateral`.

    Examples
    --------
    >>> cell = Cell.from_values(
    ...     radius_i=7.5e-3,
    ...     gap=5e-4,
    ...     young_i=3e10,
    ...     young_m=1.4e6,
    ...     poisson_i=0.25,
    ...     poisson_m=0.46,
    ... )
    >>> float(shear(cell).stiffness.round(-2))  # finite elements: 29586
    29600.0
    """
    return _lateral(cell, film_lateral.shear_energies, power=1)


def bending(cell: Cell) -> Springs:
    """Stiffness against bending, plane j turning about its centre: least energy.

    Parameters
    ----------
    cell
        Bond cells of any shape.

    Returns
    -------
    Springs
        ``K_b`` [N m/rad], no parts; an upper bound. NaN where the gap is longer than `LONGEST`
        radii.

    Notes
    -----
    See `film_lateral`.

    Examples
    --------
    >>> cell = Cell.from_values(
    ...     radius_i=7.5e-3,
    ...     gap=5e-4,
    ...     young_i=3e10,
    ...     young_m=1.4e6,
    ...     poisson_i=0.25,
    ...     poisson_m=0.46,
    ... )
    >>> float(bending(cell).stiffness.round(2))  # finite elements: 2.5804
    2.58
    """
    return _lateral(cell, film_lateral.bending_energies, power=3)


def _lateral(cell: Cell, assemble: Assembly, power: int) -> Springs:
    flat = cell.ravel()
    value, loss = np.full(flat.radius_i.shape, np.nan), np.zeros(flat.radius_i.shape)
    short = np.flatnonzero(flat.gap <= LONGEST * flat.cylinder_radius)
    if short.size:
        own = flat.take(short)
        scale = np.maximum(own.radius_i, own.radius_j)
        found, loss[short] = minimum(own, own.gap / scale, assemble, least, mirrors=False)
        value[short] = found * own.young_m * scale**power
    return _springs(cell, value, loss)


def _springs(cell: Cell, stiffness: FloatArray, loss: FloatArray) -> Springs:
    flat = cell.ravel()
    own = np.where(flat.gap > flat.cylinder_radius, LONG_ERROR, RELATIVE_ERROR)
    error = (own + loss).reshape(cell.shape)
    return Springs.of_cell(cell, stiffness.reshape(cell.shape), error)


SMALLEST_GAP = 1e-5
"""L_g / min(R_i, R_j) down to which the fields resolve the film."""

WIDEST = 3.0
"""R_c / max(R_i, R_j) up to which the fields were checked."""

SMALLEST_RADIUS = 0.1
"""Ratio of the radii down to which the fields were checked."""


def is_resolved(cell: Cell) -> NDArray[np.bool_]:
    """Whether the trial fields resolve the cell."""
    small = np.minimum(cell.radius_i, cell.radius_j)
    large = np.maximum(cell.radius_i, cell.radius_j)
    shape = (cell.gap >= SMALLEST_GAP * small) & (small >= SMALLEST_RADIUS * large)
    shape = shape & (cell.cylinder_radius <= WIDEST * large)
    stiff = np.minimum(cell.young_i, cell.young_j) >= cell.young_m
    return np.broadcast_to(shape & stiff & (cell.poisson_m >= 0), cell.shape)


LATERAL_POISSON = 0.499
"""nu_m up to which shear and bending let elastic particles give way to a film's pressure."""


def is_lateral(cell: Cell) -> NDArray[np.bool_]:
    """Whether shear and bending are resolved: gaps not long, matrix not all but incompressible."""
    short = cell.gap <= LONGEST * cell.cylinder_radius
    rigid = np.isinf(cell.young_i) & np.isinf(cell.young_j)
    yielding = (cell.poisson_m <= LATERAL_POISSON) | rigid
    return np.broadcast_to(short & yielding, cell.shape)


FILM = Model(
    name="film",
    title="film between elastic spheres",
    summary="Energy minimised over some fifty to a hundred fields: flow and compression of the "
    "film, dents of the particles, uniform strain.",
    source="Derived for this project, docs/film.md; nothing is calibrated.",
    valid_range="gap/min(R) >= 1e-5, E_i and E_j >= E_m up to rigid, 0 <= nu_m <= 1/2, radii "
    "within a factor of 10, R_c <= 3 max(R); shear and bending: gap <= 3 R_c and nu_m <= 0.499, "
    "or rigid particles. An upper bound (normal: between frictionless plates). Measured in random "
    "samples, gap/R >= 1e-4: normal and torsion 0.1 % above the finite elements, at most 1.2 %; "
    "shear and bending 0.4 %, at most 5 % (soft particles, wide cylinders).",
    loads={"normal": normal, "shear": shear, "torsion": torsion, "bending": bending},
    is_valid=is_resolved,
    limits={"shear": is_lateral, "bending": is_lateral},
)
