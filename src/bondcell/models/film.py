"""The film model: the cell's energy minimised over a few dozen fields that know the film."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from bondcell.cell import Cell, FloatArray
from bondcell.models.film_domain import Geometry, domain, panel_count
from bondcell.models.film_fields import Fields, fields
from bondcell.models.film_particles import COUNT, distances, energy, traces
from bondcell.models.model import Model, Springs

BATCH = 16
"""Geometries assembled at once, to stay in the cache."""

POINTS = 256
"""Systems solved at once, to bound the memory."""

RIDGE = 1e-13
"""Added to the scaled matrix: fields that nearly repeat each other do no harm."""

ISOCHORIC_FROM = 1e6
"""Ratio of bulk to shear modulus above which fields without divergence are also tried alone."""

LONGEST = 3.0
"""Gap over the cylinder's radius beyond which the rest is a bar."""

KINDS = 4
"""Rows of a key that say which cells can be assembled together."""

RELATIVE_ERROR = 1e-4
"""Bound of quadrature and round-off, see tests/verification/test_film.py."""


@dataclass(frozen=True)
class Energies:
    """Quadratic forms of the trial fields, shape (cells, fields, fields).

    Parameters
    ----------
    shear
        Twice the energy for unit shear modulus of the matrix.
    bulk
        The same for unit bulk modulus, of the fields with divergence only.
    particles
        Twice the energy of particle i and of particle j for unit Young's modulus.
    isochoric
        Number of fields without divergence, which come first.
    moved
        Which fields deform particle i, and particle j, shape (2, fields).
    """

    shear: FloatArray
    bulk: FloatArray
    particles: tuple[FloatArray, FloatArray]
    isochoric: int
    moved: NDArray[np.bool_]


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
    moved, particles = _particle_energy(trial, blocks, geometry.mirrored, shear.shape[-1])
    return Energies(shear, bulk, particles, trial.isochoric.shape[1], moved)


def _matrix_energy(trial: Fields, weights: FloatArray) -> tuple[FloatArray, FloatArray]:
    """``2 dev(e) : dev(e)`` and ``(div u)^2``, integrated."""
    scale = np.sqrt(weights)
    divergence = trial.other[:3].sum(axis=0)
    deviator = trial.other.copy()
    deviator[:3] -= divergence / 3
    strain = np.concatenate((trial.isochoric, deviator), axis=1) * scale
    strain[:3] *= np.sqrt(2.0)
    rows = np.moveaxis(strain, 2, 0).swapaxes(1, 2)
    rows = rows.reshape(*rows.shape[:2], -1)
    swelling = np.moveaxis(divergence * scale, 1, 0)
    return _gram(rows), _gram(swelling)


def _gram(rows: FloatArray) -> FloatArray:
    return np.asarray(rows @ rows.swapaxes(-1, -2))


def _particle_energy(
    trial: Fields, blocks: list[FloatArray], mirrored: bool, count: int
) -> tuple[NDArray[np.bool_], tuple[FloatArray, FloatArray]]:
    """Put the particles' energies where their continuations are among the trial fields."""
    moved, spread = np.zeros((2, count), dtype=bool), []
    for own, block in enumerate(blocks):
        start = trial.first + (0 if mirrored else own * COUNT)
        mine = slice(start, start + COUNT)
        moved[own, mine] = True
        whole = np.zeros((block.shape[0], count, count))
        whole[:, mine, mine] = block
        spread.append(whole)
    return moved, (spread[0], spread[1])


def least_energy(matrix: FloatArray) -> FloatArray:
    """Least ``x . A x`` over all x with ``x_0 = 1``, for matrices of shape (points, n, n).

    Notes
    -----
    With the scaled matrix, b its first column below the first row and S the rest, ``(S + ridge) y =
    -b`` and the energy at that y is ``A_00 + y . b - ridge y . y``: a bound, not an estimate.
    """
    scale = 1 / np.sqrt(np.diagonal(matrix, axis1=-2, axis2=-1))
    matrix *= scale[:, :, None]
    matrix *= scale[:, None, :]
    inner, column = matrix[:, 1:, 1:], matrix[:, 1:, :1]
    np.einsum("pkk->pk", inner)[:] += RIDGE
    found = np.linalg.solve(inner, -column)
    gain = ((column - RIDGE * found) * found).sum(axis=(1, 2))
    return np.asarray((matrix[:, 0, 0] + gain) / scale[:, 0] ** 2)


def _stiffness(forms: Energies, at: NDArray[np.int64], cell: Cell) -> FloatArray:
    """Stiffness over ``E_m`` times length of points whose forms are at positions ``at``."""
    rigid = np.isinf(np.stack([cell.young_i, cell.young_j]))
    value = np.empty(at.size)
    for pattern in np.unique(rigid, axis=1).T:
        here = np.flatnonzero((rigid == pattern[:, None]).all(axis=0))
        kept = np.flatnonzero(~forms.moved[pattern].any(axis=0))
        value[here] = _open_stiffness(forms, kept, at[here], cell.take(here), pattern)
    return value


def _open_stiffness(
    forms: Energies,
    kept: NDArray[np.int64],
    at: NDArray[np.int64],
    cell: Cell,
    rigid: NDArray[np.bool_],
) -> FloatArray:
    """The same for points with the same rigid particles, from the fields ``kept``."""
    mu = 1 / (2 * (1 + cell.poisson_m))
    compressibility = 3 * (1 - 2 * cell.poisson_m)
    block = np.ix_(np.arange(forms.shear.shape[0]), kept, kept)
    matrix = mu[:, None, None] * forms.shear[block][at]
    for own, young in enumerate((cell.young_i, cell.young_j)):
        if not rigid[own]:
            ratio = (young / cell.young_m)[:, None, None]
            matrix += ratio * forms.particles[own][block][at]
    n = int((kept < forms.isochoric).sum())
    tight = compressibility < 1 / (ISOCHORIC_FROM * mu)
    best = np.full(at.size, np.inf)
    if tight.any():
        best[tight] = least_energy(matrix[tight, :n, :n])
    soft = compressibility > 0
    if not soft.all():
        matrix = matrix[soft]
    if soft.any():
        bulk = forms.bulk[:, kept[n:, None] - forms.isochoric, kept[n:] - forms.isochoric]
        matrix[:, n:, n:] += bulk[at[soft]] / compressibility[soft, None, None]
        best[soft] = np.fmin(best[soft], least_energy(matrix))
    return best


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
    bar = flat.gap / scale - gap
    key = _keys(flat, scale, gap, outer)
    own, place = np.unique(key, axis=1, return_inverse=True)
    place = place.reshape(-1)
    order = np.argsort(place, kind="stable")
    starts = np.searchsorted(place[order], np.arange(own.shape[1] + 1))
    value = np.empty(gap.shape)
    for first, last in _batches(own[:KINDS]):
        part = own[:, first:last]
        radius_i, radius_j, width, edge, nu_i, nu_j = part[KINDS:, :, None]
        geometry = Geometry(radius_i, radius_j, width, edge, mirrored=bool(part[0, 0]))
        forms = energies(geometry, nu_i, nu_j)
        points = order[starts[first] : starts[last]]
        for k in range(0, points.size, POINTS):
            some = points[k : k + POINTS]
            value[some] = _stiffness(forms, place[some] - first, flat.take(some))
    value /= 1 + value * bar / (np.pi * outer**2)
    stiffness = value * flat.young_m * scale
    return Springs.of_cell(cell, stiffness.reshape(cell.shape), RELATIVE_ERROR)


def _keys(cell: Cell, scale: FloatArray, gap: FloatArray, outer: FloatArray) -> FloatArray:
    """What points must share: first the kind of the assembly, `KINDS` rows, then its numbers."""
    radius_i, radius_j = cell.radius_i / scale, cell.radius_j / scale
    same = (cell.young_i == cell.young_j) & (cell.poisson_i == cell.poisson_j)
    equal = radius_i == radius_j
    width = np.sqrt(2 * gap / (1 / radius_i + 1 / radius_j))
    panels = panel_count(width / np.minimum(radius_i, radius_j))
    kind = [same & equal, outer > 1, ~equal, panels]
    return np.stack([*kind, radius_i, radius_j, gap, outer, cell.poisson_i, cell.poisson_j])


def _batches(kinds: FloatArray) -> list[tuple[int, int]]:
    """Runs of at most `BATCH` columns of one kind."""
    change = np.flatnonzero(np.any(np.diff(kinds, axis=1) != 0, axis=0)) + 1
    borders = [0, *change.tolist(), kinds.shape[1]]
    return [
        (k, min(k + BATCH, end))
        for start, end in pairwise(borders)
        for k in range(start, end, BATCH)
    ]


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


FILM = Model(
    name="film",
    title="film between elastic spheres",
    summary="Energy minimised over some fifty fields: flow and compression of the film, dents of "
    "the particles, uniform strain.",
    source="Derived for this project, docs/film.md; nothing is calibrated.",
    valid_range="gap/min(R) >= 1e-5, E_i and E_j >= E_m up to rigid, 0 <= nu_m <= 1/2, radii "
    "within a factor of 10, R_c <= 3 max(R). An upper bound between frictionless plates, within "
    "0.5 % of the finite elements for equal pairs with gap/R >= 1e-4, within 2 % for most others.",
    loads={"normal": normal},
    is_valid=is_resolved,
)
