"""Quadratic forms of trial fields and their least value, point by point."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from bondcell.cell import Cell, FloatArray
from bondcell.models.film_domain import Geometry, panel_count

BATCH = 16
"""Geometries assembled at once, to stay in the cache."""

POINTS = 256
"""Systems solved at once, to bound the memory."""

RIDGE = 1e-13
"""Added to the scaled matrix: fields that nearly repeat each other do no harm."""

ISOCHORIC_FROM = 1e6
"""Ratio of bulk to shear modulus above which fields without divergence are also tried alone."""

KINDS = 4
"""Rows of a key that say which cells can be assembled together."""


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


Assembly = Callable[[Geometry, FloatArray, FloatArray], Energies]
"""Energies of cells of one kind, from geometry and Poisson's ratios of the particles (cells, 1)."""


def gram(rows: FloatArray) -> FloatArray:
    """Inner products of rows, (cells, fields, values) -> (cells, fields, fields)."""
    return np.asarray(rows @ rows.swapaxes(-1, -2))


def placed(
    blocks: list[FloatArray], first: int, mirrored: bool, count: int
) -> tuple[NDArray[np.bool_], tuple[FloatArray, FloatArray]]:
    """Put the particles' energies where their continuations are among the trial fields."""
    moved, spread = np.zeros((2, count), dtype=bool), []
    for own, block in enumerate(blocks):
        start = first + (0 if mirrored else own * block.shape[-1])
        mine = slice(start, start + block.shape[-1])
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


def minimum(cell: Cell, gap: FloatArray, assemble: Assembly, mirrors: bool = True) -> FloatArray:
    """Least energy, twice, over ``E_m`` and powers of the largest radius.

    Parameters
    ----------
    cell
        Flat cells.
    gap
        The gap to use instead of the cell's, over the largest radius.
    assemble
        The load's energies.
    mirrors
        Whether the load of a pair of equal particles has mirror symmetry.
    """
    scale = np.maximum(cell.radius_i, cell.radius_j)
    key = _keys(cell, scale, gap)
    key[0] *= mirrors
    own, place = np.unique(key, axis=1, return_inverse=True)
    place = place.reshape(-1)
    order = np.argsort(place, kind="stable")
    starts = np.searchsorted(place[order], np.arange(own.shape[1] + 1))
    value = np.empty(gap.shape)
    for first, last in _batches(own[:KINDS]):
        part = own[:, first:last]
        radius_i, radius_j, width, edge, nu_i, nu_j = part[KINDS:, :, None]
        geometry = Geometry(radius_i, radius_j, width, edge, mirrored=bool(part[0, 0]))
        forms = assemble(geometry, nu_i, nu_j)
        points = order[starts[first] : starts[last]]
        for k in range(0, points.size, POINTS):
            some = points[k : k + POINTS]
            value[some] = _stiffness(forms, place[some] - first, cell.take(some))
    return value


def _keys(cell: Cell, scale: FloatArray, gap: FloatArray) -> FloatArray:
    """What points must share: first the kind of the assembly, `KINDS` rows, then its numbers."""
    radius_i, radius_j, outer = (
        x / scale for x in (cell.radius_i, cell.radius_j, cell.cylinder_radius)
    )
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


def _stiffness(forms: Energies, at: NDArray[np.int64], cell: Cell) -> FloatArray:
    """Least energies of points whose forms are at positions ``at``."""
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
    if n == kept.size:
        return least_energy(matrix)
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
