"""The specimen as a solid: one half by symmetry, particles rigid or elastic, meshes in a ladder."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray

from bondcell.cell import FloatArray
from bondcell.lattice import specimen_geometry as given
from bondcell.lattice.packing import Packing, packing
from bondcell.solid.elastic import solve_elastic
from bondcell.solid.raise_order import raise_order
from bondcell.solid.rigid import Condensed, condense
from bondcell.solid.sphere_mesh import sphere_mesh
from bondcell.solid.stiffness import Elastic
from bondcell.solid.tets import Tets
from bondcell.specimen.bonds import Material
from bondcell.specimen.bound import softest
from bondcell.timing import Timing, timed_once

X, Y, Z = range(3)

EXPECTED_ORDER = 1.0
"""Order of the energy in the element size that two meshes are taken to have; three show it.

The order rises with refinement, to above 2 below half a gap; meshes of an element a gap show one.
"""


EXPECTED_DROP = 0.08
"""Part of an order's gain in energy that the next order gains.

From order 3 to 4 it is 0.06 with elements of one gap and 0.09 with elements of two.
"""


@dataclass(frozen=True)
class SolidAnswer:
    """Answers of one mesh to several load cases.

    Parameters
    ----------
    energy
        Energy of the whole specimen [J], shape (cases,).
    motion
        Displacement (x, y) [m] and rotation [rad] of all particles, shape (cases, 18, 3).
    dof
        Unknowns.
    timing
        What assembly and solution took, once.
    field
        Displacements of all nodes of the half [m], shape (nodes, 3, cases); elastic particles only.
    softest
        Smallest ``2 U / n^2`` of any displacement [N/m], see `bondcell.specimen.bound`; rigid
        particles only.
    """

    energy: FloatArray
    motion: FloatArray
    dof: int
    timing: Timing
    field: FloatArray | None = None
    softest: float = np.nan


def half_specimen() -> Packing:
    """The half ``z >= 0`` of the specimen."""
    whole = given.specimen_packing()
    (x, y, (_, top)) = given.BOX
    return packing(whole.centres, whole.radii, (x, y, (0.0, top)))


def supports(mesh: Tets, walls: str) -> NDArray[np.bool_]:
    """Displacements that are zero, shape (nodes, 3): the bottom, symmetry, sides if fixed."""
    held = np.zeros((len(mesh.points), 3), dtype=bool)
    held[mesh.on_plane(Y, given.BOX[Y][0])] = True
    held[mesh.on_plane(Z, 0.0), Z] = True
    if walls == "fixed":
        for side in given.BOX[X]:
            held[mesh.on_plane(X, side)] = True
    return held


def materials(material: Material) -> tuple[Elastic, Elastic]:
    """Matrix and particles."""
    return (
        Elastic(material.young_matrix, material.poisson_matrix),
        Elastic(material.young_particle, material.poisson_particle),
    )


def rigid_answer(
    mesh: Tets, material: Material, walls: str, displacements: FloatArray
) -> SolidAnswer:
    """Rigid particles; ``displacements`` of particles 1 to 3, shape (cases, 2) [m]."""
    motion = np.zeros((len(displacements), 18, 3))
    energy = np.zeros(len(displacements))

    def solve() -> Condensed:
        found = condense(mesh, half_specimen(), materials(material)[0], supports(mesh, walls))
        for case, displacement in enumerate(displacements):
            moved, _, half = found.solve(np.array(given.LOADED), displacement)
            motion[case, found.moving], energy[case] = moved, 2 * half
        return found

    found, timing = timed_once(solve)
    shifts = np.tile([True, True, False], found.moving.size)
    least = softest(2 * found.stiffness, shifts)
    return SolidAnswer(energy, motion, found.dof, timing, softest=least)


def elastic_answer(
    mesh: Tets, material: Material, walls: str, displacements: FloatArray
) -> SolidAnswer:
    """Elastic particles; mean ``displacements`` of particles 1 to 3, shape (cases, 2) [m]."""
    held, loaded = supports(mesh, walls), np.array(given.LOADED)
    elastic = partial(solve_elastic, mesh, half_specimen(), *materials(material))
    found, timing = timed_once(lambda: elastic(held, loaded, displacements))
    motion = found.motion.transpose(2, 0, 1)
    return SolidAnswer(2 * found.energy, motion, found.dof, timing, field=found.field)


def specimen_mesh(per_gap: float, order: int = 2) -> Tets:
    """Mesh of the half specimen with elements of ``per_gap`` times the local gap."""
    half = half_specimen()
    return raise_order(sphere_mesh(half, per_gap, order=order), order, half)


def extrapolate(sizes: Sequence[float], values: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Limit of a ladder of values that fall with the element size, and the finest one's error.

    Parameters
    ----------
    sizes
        Element sizes, falling.
    values
        Shape (sizes, ...).

    Returns
    -------
    tuple
        The limit and its relative uncertainty; NaN with one size only.

    Notes
    -----
    ``v(h) = v_0 + c h^p``; three sizes give p, which is kept between 1 and 4, two are taken to have
    `EXPECTED_ORDER`. The uncertainty is the change of the limit for an order that is lower by one
    half, so that it errs on the safe side.

    Examples
    --------
    >>> limit, doubt = extrapolate([1, 0.5, 0.25], np.array([2.0, 1.25, 1.0625]))
    >>> round(float(limit), 6)
    1.0
    """
    if len(sizes) < 2:
        return values[-1], np.full_like(values[-1], np.nan)
    order = np.full_like(values[-1], EXPECTED_ORDER)
    if len(sizes) > 2:
        order = _order(sizes[-3:], values[-3:])
    drop, ratio = values[-2] - values[-1], sizes[-2] / sizes[-1]
    limit = values[-1] - drop / (ratio**order - 1)
    careful = values[-1] - drop / (ratio ** np.maximum(order - 0.5, 0.5) - 1)
    return limit, np.abs(careful / limit - 1)


def extrapolate_orders(values: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Limit of values on one mesh at orders that rise one by one, and its relative uncertainty.

    Parameters
    ----------
    values
        Shape (orders, ...).

    Notes
    -----
    Each order gains a part of what the last one gained, the same part each time: three orders show
    it, two are taken to have `EXPECTED_DROP`. The uncertainty is what is added to the last value.

    Examples
    --------
    >>> limit, error = extrapolate_orders(np.array([1.1, 1.01, 1.001]))
    >>> round(float(limit), 6), round(float(error), 6)
    (1.0, 0.001)
    """
    if len(values) < 2:
        return values[-1], np.full_like(values[-1], np.nan)
    gain = values[-2] - values[-1]
    part = np.full_like(gain, EXPECTED_DROP)
    if len(values) > 2:
        before = values[-3] - values[-2]
        part = np.clip(gain / np.where(before != 0, before, 1.0), 0.02, 0.7)
    rest = gain * part / (1 - part)
    limit = values[-1] - rest
    return limit, np.abs(rest / limit)


def _order(sizes: Sequence[float], values: FloatArray) -> FloatArray:
    """Order p of three values by bisection of ``(h1^p - h2^p) / (h2^p - h3^p) = d12 / d23``."""
    wanted = (values[0] - values[1]) / np.where(values[1] != values[2], values[1] - values[2], 1.0)
    low, high = np.full_like(wanted, 1.0), np.full_like(wanted, 4.0)
    for _ in range(50):
        middle = (low + high) / 2
        a, b, c = (size**middle for size in sizes)
        larger = (a - b) / (b - c) < wanted
        low, high = np.where(larger, middle, low), np.where(larger, high, middle)
    return (low + high) / 2
