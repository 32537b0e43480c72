"""The film model: the cell's energy minimised over a few dozen fields that know the film.

How its files hang together, docs/film.md has the derivations:

- `domain`: points of the matrix and smooth coordinates there; `jets`: fields with derivatives
- `fields`, `particles`: trial displacements of the normal load, `normal` puts their energies
  together; `torsion` and `lateral` (shear and bending) do the same for the other loads
- `energies`, `solve`, `reduced`: least energies of many cells; the last one where many materials
  share a shape
- `loads`: the four stiffnesses; `interpolated`: where many shapes share a material; `ranges`
- `stress`, `stress_torsion`: trial stresses, the lower ends of the model `bounds`
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

from bondcell.cell import Cell
from bondcell.models.film import loads
from bondcell.models.film.interpolated import by_families
from bondcell.models.film.ranges import is_resolved, is_short
from bondcell.models.model import Model, Springs


def stiffness(
    cell: Cell, law: Callable[[Cell], Springs], power: int, swaps: bool = True
) -> Springs:
    """Stiffness of cells, interpolated where many shapes share a material.

    Parameters
    ----------
    cell
        Bond cells of any shape.
    law
        One of `loads`.
    power
        The stiffness is this power of the length times ``E_m``.
    swaps
        Whether exchanging the particles leaves the stiffness as it is.

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
    >>> float(stiffness(cell, loads.normal, power=1).stiffness.round(-2))
    162700.0
    """
    flat = cell.ravel()
    smooth = is_resolved(flat) & is_short(flat)
    value, error = by_families(flat, law, smooth, power, swaps)
    return Springs.of_cell(cell, value.reshape(cell.shape), error.reshape(cell.shape))


FILM = Model(
    name="film",
    title="film between elastic spheres",
    summary="Energy minimised over some fifty to a hundred fields: flow and compression of the "
    "film, dents of the particles, uniform strain.",
    source="Derived for this project, docs/film.md; nothing is calibrated.",
    valid_range="gap/min(R) >= 1e-5, E_i and E_j >= E_m up to rigid, 0 <= nu_m <= 1/2, radii "
    "within a factor of 10, R_c <= 3 max(R); shear and bending: gap <= 3 R_c. An upper bound "
    "(normal: between frictionless plates). Measured in random samples, gap/R >= 1e-4: 0.1 % above "
    "the finite elements in the median, at most 2.2 % if E_i >= 100 E_m; softer particles under "
    "shear and bending 2.4 %, and 7 % near nu_m = 1/2.",
    loads={
        "normal": partial(stiffness, law=loads.normal, power=1),
        "shear": partial(stiffness, law=loads.shear, power=1),
        "torsion": partial(stiffness, law=loads.torsion, power=3),
        # Plane j turns, plane i is held: not the same from the other end.
        "bending": partial(stiffness, law=loads.bending, power=3, swaps=False),
    },
    is_valid=is_resolved,
    limits={"shear": is_short, "bending": is_short},
)
