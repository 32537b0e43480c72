"""Quadratic forms of trial fields and their least value, point by point."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from bondcell.cell import Cell, FloatArray
from bondcell.models.film.domain import Geometry, panel_count
from bondcell.models.film.ranges import FINEST_GAP
from bondcell.models.film.reduced import least_energies_of_many
from bondcell.models.film.solve import least_energies

BATCH = 16
"""Geometries assembled at once, to stay in the cache."""

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


Forms = TypeVar("Forms")

Assembly = Callable[[Geometry, FloatArray, FloatArray], Energies]
"""Energies of cells of one kind, from geometry and Poisson's ratios of the particles (cells, 1)."""


def gram(rows: FloatArray) -> FloatArray:
    """Inner products of rows, (cells, fields, values) -> (cells, fields, fields)."""
    return np.asarray(rows @ rows.swapaxes(-1, -2))


def sum_of_grams(strain: FloatArray) -> FloatArray:
    """Inner products of fields, (components, fields, cells, points) -> (cells, fields, fields)."""
    return np.asarray(sum(gram(component.swapaxes(0, 1)) for component in strain))


def placed(
    blocks: Sequence[FloatArray], places: Sequence[NDArray[np.int64]], count: int
) -> tuple[NDArray[np.bool_], tuple[FloatArray, FloatArray]]:
    """Put the two particles' energies where their continuations are among the trial fields."""
    moved, spread = np.zeros((2, count), dtype=bool), []
    for own, (block, mine) in enumerate(zip(blocks, places, strict=True)):
        moved[own, mine] = True
        whole = np.zeros((block.shape[0], count, count))
        whole[:, mine[:, None], mine] = block
        spread.append(whole)
    return moved, (spread[0], spread[1])


def in_a_row(
    blocks: Sequence[FloatArray], first: int, mirrored: bool = False
) -> list[NDArray[np.int64]]:
    """Places of fields that come one particle after the other, or that mirrored ones share."""
    count = blocks[0].shape[-1]
    return [first + (0 if mirrored else own * count) + np.arange(count) for own in (0, 1)]


def minimum(
    cell: Cell,
    gap: FloatArray,
    assemble: Callable[[Geometry, FloatArray, FloatArray], Forms],
    solve: Callable[[Forms, int, Cell], tuple[FloatArray, FloatArray]],
    mirrors: bool = True,
    batch: int = BATCH,
) -> tuple[FloatArray, FloatArray]:
    """Least energy, twice, over ``E_m`` and powers of the largest radius, and its loss.

    Parameters
    ----------
    cell
        Flat cells.
    gap
        The gap to use instead of the cell's, over the largest radius.
    assemble
        The load's quadratic forms.
    solve
        Energies and losses of points from the forms and the position of their geometry in them.
    mirrors
        Whether the load of a pair of equal particles has mirror symmetry.
    batch
        Geometries to assemble at once.

    Returns
    -------
    tuple of ndarray
        Energies, and how much higher they may be than the least over all fields, relative; NaN
        for gaps below `ranges.FINEST_GAP`.
    """
    scale = np.maximum(cell.radius_i, cell.radius_j)
    fine = gap * scale >= FINEST_GAP * np.minimum(cell.radius_i, cell.radius_j)
    if not fine.all():
        value, loss = np.full((2, *gap.shape), np.nan)
        if fine.any():
            rest = cell.take(np.flatnonzero(fine))
            value[fine], loss[fine] = minimum(rest, gap[fine], assemble, solve, mirrors, batch)
        return value, loss
    key = _keys(cell, scale, gap)
    key[0] *= mirrors
    own, place = np.unique(key, axis=1, return_inverse=True)
    place = place.reshape(-1)
    order = np.argsort(place, kind="stable")
    starts = np.searchsorted(place[order], np.arange(own.shape[1] + 1))
    value, loss = np.empty(gap.shape), np.empty(gap.shape)
    for first, last in _batches(own[:KINDS], batch):
        part = own[:, first:last]
        radius_i, radius_j, width, edge, nu_i, nu_j = part[KINDS:, :, None]
        geometry = Geometry(radius_i, radius_j, width, edge, mirrored=bool(part[0, 0]))
        forms = assemble(geometry, nu_i, nu_j)
        for k in range(last - first):
            points = order[starts[first + k] : starts[first + k + 1]]
            value[points], loss[points] = solve(forms, k, cell.take(points))
    return value, loss


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


def _batches(kinds: FloatArray, batch: int) -> list[tuple[int, int]]:
    """Runs of at most ``batch`` columns of one kind."""
    change = np.flatnonzero(np.any(np.diff(kinds, axis=1) != 0, axis=0)) + 1
    borders = [0, *change.tolist(), kinds.shape[1]]
    return [
        (k, min(k + batch, end))
        for start, end in pairwise(borders)
        for k in range(start, end, batch)
    ]


def least(forms: Energies, k: int, cell: Cell) -> tuple[FloatArray, FloatArray]:
    """Least energies of points on geometry k, and their loss."""
    rigid = np.isinf(np.stack([cell.young_i, cell.young_j]))
    value, loss = np.empty(cell.young_m.size), np.empty(cell.young_m.size)
    for pattern in np.unique(rigid, axis=1).T:
        here = np.flatnonzero((rigid == pattern[:, None]).all(axis=0))
        value[here], loss[here] = _open_energies(forms, k, cell.take(here), pattern)
    return value, loss


def _open_energies(
    forms: Energies, k: int, cell: Cell, rigid: NDArray[np.bool_]
) -> tuple[FloatArray, FloatArray]:
    """The same for points with the same rigid particles, which take out the fields they move."""
    kept = np.flatnonzero(~forms.moved[rigid].any(axis=0))
    block = np.ix_(kept, kept)
    stack, factors = [forms.shear[k][block]], [1 / (2 * (1 + cell.poisson_m))]
    for own, young in enumerate((cell.young_i, cell.young_j)):
        if not rigid[own]:
            stack.append(forms.particles[own][k][block])
            factors.append(young / cell.young_m)
    compressibility = 3 * (1 - 2 * cell.poisson_m)
    n = int((kept < forms.isochoric).sum())
    if n == kept.size:
        return least_energies_of_many(np.stack(stack), np.stack(factors, axis=1))
    value, loss = np.full(compressibility.size, np.inf), np.zeros(compressibility.size)
    tight = compressibility * ISOCHORIC_FROM < 1 / factors[0]
    if tight.any():
        still = np.stack([form[:n, :n] for form in stack])
        own_factors = np.stack([factor[tight] for factor in factors], axis=1)
        value[tight], loss[tight] = least_energies_of_many(still, own_factors)
    bulk = np.zeros_like(stack[0])
    late = kept[n:] - forms.isochoric
    bulk[n:, n:] = forms.bulk[k][np.ix_(late, late)]
    every = np.stack([*stack, bulk])
    for some, solve in (
        (~tight, least_energies_of_many),
        (tight & (compressibility > 0), least_energies),
    ):
        if some.any():
            own_factors = np.stack([*(f[some] for f in factors), 1 / compressibility[some]], axis=1)
            least, lost = solve(every, own_factors)
            loss[some] = np.where(least < value[some], lost, loss[some])
            value[some] = np.fmin(value[some], least)
    return value, loss
