"""Certified bounds of normal stiffness and torsion: stresses below, displacements above."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from bondcell.cell import Cell, FloatArray
from bondcell.models import generatrix
from bondcell.models.film import loads, ranges, stress, stress_torsion
from bondcell.models.model import Model, Springs


def normal(cell: Cell) -> Springs:
    """Interval that holds the normal stiffness of the cell between frictionless plates.

    Parameters
    ----------
    cell
        Bond cells of any shape.

    Returns
    -------
    Springs
        The middle of the interval as stiffness, its half width over the middle as relative error,
        and the parts ``lower`` and ``upper`` [N/m].

    Notes
    -----
    Lower: the stresses of `film.stress`, and those of the generatrix lines, balance themselves
    and leave the sides free, so their complementary energies bound the compliance from above; the
    better of both counts, generatrix alone for gaps that are not `ranges.is_short`. Upper: the
    trial displacements of the film model are continuous and keep the plates plane, so their energy
    bounds the stiffness from above at any Poisson's ratio, 1/2 included: solved for every cell,
    never interpolated between cells. Both are widened by their
    numerical error.

    Examples
    --------
    >>> cell = Cell.from_values(
    ...     radius_i=7.5e-3,
    ...     gap=5e-4,
    ...     young_i=3e10,
    ...     young_m=1.4e6,
    ...     poisson_i=0.25,
    ...     poisson_m=0.0,
    ... )
    >>> {name: float(part.round(-1)) for name, part in normal(cell).parts.items()}
    {'lower': 87190.0, 'upper': 87250.0}
    """
    return _between(cell, generatrix.normal(cell), stress.stiffness, loads.normal(cell), 1)


def torsion(cell: Cell) -> Springs:
    """Interval that holds the stiffness against torsion, as `normal` does for the normal load."""
    below = stress_torsion.stiffness
    return _between(cell, generatrix.torsion(cell), below, loads.torsion(cell), 3)


def _between(
    cell: Cell,
    lines: Springs,
    trial: Callable[[Cell, FloatArray], FloatArray],
    above: Springs,
    power: int,
) -> Springs:
    """The interval; a stiffness of trial stresses is over ``E_m`` and a power of the radius."""
    lower = np.array(lines.stiffness * (1 - lines.relative_error)).ravel()
    flat = cell.ravel()
    short = np.flatnonzero(ranges.is_short(flat))
    if short.size:
        own = flat.take(short)
        scale = np.maximum(own.radius_i, own.radius_j)
        found = trial(own, own.gap / scale) * own.young_m * scale**power
        lower[short] = np.maximum(lower[short], found * (1 - stress.RELATIVE_ERROR))
    lower = lower.reshape(cell.shape)
    upper = above.stiffness * (1 + above.relative_error)
    middle = (lower + upper) / 2
    half = (upper - lower) / (2 * middle)
    return Springs.of_cell(cell, middle, np.abs(half), lower=lower, upper=upper)


BOUNDS = Model(
    name="bounds",
    title="bounds from below and above",
    summary="The middle of a certified interval: trial stresses below, film model above.",
    source="Derived for this project: least complementary and least potential energy.",
    valid_range="The interval holds wherever the film model is resolved; as an estimate its "
    "middle is off by up to half the interval, which is reported as the error.",
    loads={"normal": normal, "torsion": torsion},
    is_valid=ranges.is_resolved,
)
