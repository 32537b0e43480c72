"""A lattice of bonds between any spheres, each bond by a model of the bond cell."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

from bondcell.cell import FloatArray
from bondcell.errors import InputError, Violation
from bondcell.evaluate import evaluate
from bondcell.lattice.bonds import bonds
from bondcell.lattice.lattice import Lattice, lattice
from bondcell.lattice.packing import packing
from bondcell.models import MODELS

_DIGITS = 12

_ARGUMENTS = {
    "young_i": "young_particle",
    "poisson_i": "poisson_particle",
    "young_m": "young_matrix",
    "poisson_m": "poisson_matrix",
}


def bonded_lattice(
    centres: ArrayLike,
    radii: ArrayLike,
    cutoff: float,
    *,
    young_particle: float,
    poisson_particle: float,
    young_matrix: float,
    poisson_matrix: float,
    model: str = "film",
    box: ArrayLike | None = None,
) -> Lattice:
    """Bond all neighbours among spheres.

    Parameters
    ----------
    centres
        Centres [m], shape (spheres, 3).
    radii
        Radii [m], shape (spheres,) or one for all.
    cutoff
        Spheres whose gap is at most this are bonded [m].
    young_particle, young_matrix
        Young's moduli [Pa].
    poisson_particle, poisson_matrix
        Poisson's ratios.
    model
        A name in ``bondcell.MODELS``, or ``fe``. A model of the normal load alone gives a lattice
        whose nodes do not rotate. ``film`` takes milliseconds a pair that is like no other one;
        ``generatrix`` a microsecond.
    box
        Walls that no sphere may pierce [m], shape (3, 2).

    Returns
    -------
    Lattice
        Nodes in the order of the spheres; solve it by `bondcell.solve_lattice`.

    Raises
    ------
    InputError
        Overlapping spheres, no neighbours within the cut-off, an unknown model, a pair of which
        the model gives no stiffness.

    Notes
    -----
    The bending stiffness K_b of the cell holds one centre and turns the other one. By both ways
    round, ``K_b = K_bb + K_s a^2`` with the levers ``a_i + a_j = L`` of the shear force gives the
    pivot of a bond of unequal spheres: ``a_j - a_i = (K_b(j) - K_b(i)) / (K_s L)``.

    Examples
    --------
    >>> import bondcell
    >>> net = bondcell.bonded_lattice(
    ...     [[0, 0, 0], [0.0155, 0, 0], [0.031, 0, 0]],
    ...     7.5e-3,
    ...     cutoff=1e-3,
    ...     model="fsi",
    ...     young_particle=30e9,
    ...     poisson_particle=0.25,
    ...     young_matrix=1.4e6,
    ...     poisson_matrix=0.46,
    ... )
    >>> held = [[True] * 3, [False, True, True], [True] * 3]
    >>> pulled = bondcell.solve_lattice(net, held, [[0, 0, 0], [0, 0, 0], [1e-4, 0, 0]])
    >>> pulled.bond_forces.round(4).ravel()
    array([4.2028, 4.2028])
    """
    spheres = packing(centres, radii, box)
    pairs = spheres.neighbours(cutoff)
    if not len(pairs):
        raise InputError([Violation("cutoff", cutoff, "at least the smallest gap, m")])
    sizes, gaps = spheres.radii[pairs], spheres.gaps(pairs)
    material = {
        "young_i": young_particle, "poisson_i": poisson_particle,
        "young_m": young_matrix, "poisson_m": poisson_matrix,
    }  # fmt: skip
    if many := [name for name, value in material.items() if np.ndim(value)]:
        allowed = "one number, the same for all"
        raise InputError([Violation(_ARGUMENTS[name], material[name], allowed) for name in many])
    try:
        springs = _springs(np.column_stack([sizes, gaps]), material, model)
    except InputError as error:
        named = [replace(v, field=_ARGUMENTS.get(v.field, v.field)) for v in error.violations]
        raise type(error)(named) from None
    bad = np.flatnonzero(~np.isfinite(np.stack(list(springs.values()))).all(axis=0))
    if bad.size:
        allowed = f"pairs of which {model} gives a stiffness"
        raise InputError([Violation("pairs", pairs[bad[:20]].tolist(), allowed)])
    return lattice(spheres.centres, bonds(pairs, **springs))


def _springs(shapes: FloatArray, material: dict[str, float], model: str) -> dict[str, FloatArray]:
    """Arguments of `bonds`; ``shapes`` are radii and gap of each pair, shape (pairs, 3)."""
    # Pairs that differ by round-off alone are one.
    scale = 10.0 ** (np.floor(np.log10(shapes)) - _DIGITS)
    _, first, same = np.unique(
        np.round(shapes / scale) * scale, axis=0, return_index=True, return_inverse=True
    )
    same = same.ravel()
    radius_i, radius_j, gap = shapes[first].T

    def stiffness(load: str, one: FloatArray, other: FloatArray) -> FloatArray:
        columns = {"radius_i": one, "radius_j": other, "gap": gap}
        study = xr.Dataset({**{name: ("pair", x) for name, x in columns.items()}, **material})
        return np.asarray(evaluate(study, model=model, load=load).stiffness.values)

    found = {"normal": stiffness("normal", radius_i, radius_j)}
    loads = MODELS[model].loads if model in MODELS else ("shear", "bending", "torsion")
    if {"shear", "bending"} <= set(loads):
        shear = stiffness("shear", radius_i, radius_j)
        turn_j = stiffness("bending", radius_i, radius_j)
        turn_i = stiffness("bending", radius_j, radius_i)
        length = radius_i + radius_j + gap
        lever = (length + (turn_j - turn_i) / (shear * length)) / 2
        found |= {
            "shear": shear,
            "bending": np.maximum(turn_j - shear * lever**2, 0.0),
            "pivot": np.clip(1 - lever / length, 0.0, 1.0),
        }
    if "torsion" in loads:
        found["torsion"] = stiffness("torsion", radius_i, radius_j)
    return {name: values[same] for name, values in found.items()}
