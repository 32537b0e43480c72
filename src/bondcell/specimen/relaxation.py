"""The specimen in a viscoelastic matrix: reaction and energy after a step of displacement."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import lru_cache

import numpy as np
import xarray as xr

from bondcell.cell import Cell, FloatArray
from bondcell.errors import InputError, Violation
from bondcell.lattice import specimen_geometry as given
from bondcell.outputs import TIME
from bondcell.prony.conventions import Relaxing
from bondcell.prony.prony import Prony
from bondcell.prony.sampled_bank import sampled_bank
from bondcell.specimen.bonds import Material, bond_springs
from bondcell.specimen.lattice_variants import VARIANTS, Springs, specimen_lattice
from bondcell.specimen.names import LOADINGS, LOWEST, RELAXING

STATES = 4
"""Ratios of the moduli at which the solid is solved."""

Stiffness = Callable[[Material], FloatArray]


def specimen_relaxation(
    prony: Prony,
    time: Sequence[float],
    methods: Sequence[str] = RELAXING,
    convention: str | None = None,
    walls: str = "free",
    per_gap: float = 1.0,
    material: Material | None = None,
) -> xr.Dataset:
    """Hold particles 1 to 3 displaced by 0.5 mm while the matrix relaxes.

    Parameters
    ----------
    prony
        The matrix's series.
    time
        After the step [s].
    methods
        Names in `RELAXING`.
    convention
        As in `bondcell.prony.conventions.CONVENTIONS`, but for ``separate``.
    walls
        ``free`` or ``fixed``.
    per_gap
        Element size of the solid relative to the gap.
    material
        Elastic constants; the matrix's are what ``prony.relative_to`` says.

    Returns
    -------
    xarray.Dataset
        On ``method``, ``loading``, ``time``: ``reaction`` [N], the force on particles 1 to 3 along
        their displacement, ``energy`` [J], half of force times way (what the step would store were
        the solid elastic with the force of that time); ``fit_error`` (relative) on ``method`` and
        ``loading``.

    Raises
    ------
    InputError
        An unknown method, a bulk series, or a matrix that relaxes below `LOWEST`.

    Notes
    -----
    The reaction is a Stieltjes function of the shear modulus at constant bulk modulus: its values
    at some states give a bank of springs, whose exact series is the answer. With a constant
    Poisson's ratio everything relaxes alike.
    """
    base = material or Material()
    cell = Cell.from_values(**{str(k): float(v) for k, v in base.study().data_vars.items()}).ravel()
    state = Relaxing.of(cell, prony, convention)
    _check(state, methods)
    solve = {"fe_rigid": _solid(state, walls, per_gap)} if "fe_rigid" in methods else {}
    # Several lattices take their springs from the same bonds.
    springs = lru_cache(maxsize=None)(bond_springs)
    solve |= {name: _lattice(name, walls, springs) for name in methods if name in VARIANTS}
    shape = (len(methods), len(LOADINGS), len(time))
    reaction, errors = np.empty(shape), np.empty(shape[:2])
    for k, name in enumerate(methods):
        reaction[k], errors[k] = _series(state, base, solve[name], np.asarray(time, dtype=float))
    dims = ("method", "loading", "time")
    coords = {
        "method": list(methods),
        "loading": list(LOADINGS),
        "time": ("time", np.asarray(time, dtype=float), TIME),
    }
    about = {"units": "N", "long_name": "force on the displaced particles"}
    energy = {"units": "J", "long_name": "half of force times displacement"}
    fit = {"units": "1", "long_name": "relative error of the fitted springs"}
    data = {
        "reaction": (dims, reaction, about),
        "energy": (dims, reaction * given.DISPLACEMENT / 2, energy),
        "fit_error": (dims[:2], errors, fit),
    }
    return xr.Dataset(data, coords, {"convention": state.convention, "walls": walls})


def _check(state: Relaxing, methods: Sequence[str]) -> None:
    violations = [
        Violation("methods", name, f"one of {', '.join(RELAXING)}")
        for name in methods
        if name not in RELAXING
    ]
    if state.convention == "separate":
        violations.append(Violation("convention", "separate", "constant_bulk, constant_poisson"))
    end = float(state.prony.shear.equilibrium)
    if state.convention == "constant_bulk" and end < LOWEST:
        violations.append(Violation("prony", end, f"a long-term share of at least {LOWEST}"))
    if violations:
        raise InputError(violations)


def _at(base: Material, cell: Cell) -> Material:
    young, poisson = float(cell.young_m[0]), float(cell.poisson_m[0])
    return Material(base.young_particle, base.poisson_particle, young, poisson)


def _series(
    state: Relaxing, base: Material, solve: Stiffness, time: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Reactions (loadings, time) and errors of the fit (loadings,)."""
    if state.convention == "constant_poisson":
        start = solve(_at(base, state.cell))
        share = state.prony.shear.relaxation(time)
        return start[:, np.newaxis] * share, np.zeros(start.size)

    def values(shares: FloatArray) -> FloatArray:
        return np.array([solve(_at(base, state.at(float(x)))) for x in shares])

    modulus = np.full(len(LOADINGS), float(state.shear[0]))
    bank, error = sampled_bank(values, modulus, float(state.prony.shear.equilibrium))
    series = bank.relaxation(state.prony.shear, modulus, np.zeros_like(modulus))
    return series.relaxation(time).T, error


def _lattice(name: str, walls: str, springs: Springs) -> Stiffness:
    def solve(material: Material) -> FloatArray:
        own = specimen_lattice(name, material, walls, springs_of=springs)
        ways = [np.array(way) * given.DISPLACEMENT for way in LOADINGS.values()]
        return np.array([2 * own.solve(way).energy / given.DISPLACEMENT for way in ways])

    return solve


def _solid(state: Relaxing, walls: str, per_gap: float) -> Stiffness:
    """The solid's reactions by moduli, from few solutions."""
    from bondcell.solid.moduli import moduli_family
    from bondcell.specimen.solid_half import half_specimen, specimen_mesh, supports

    mesh = specimen_mesh(per_gap)
    start = float(state.shear[0] * state.bulk_compliance[0])
    end = float(state.prony.shear.equilibrium)
    one = state.convention == "constant_poisson"
    ratios = np.array([start]) if one else np.geomspace(end * start, start, STATES)[::-1]
    family = moduli_family(mesh, half_specimen(), supports(mesh, walls), ratios)

    def solve(material: Material) -> FloatArray:
        shear = material.young_matrix / (2 * (1 + material.poisson_matrix))
        bulk = material.young_matrix / (3 * (1 - 2 * material.poisson_matrix))
        condensed = family.at(bulk, shear)
        ways = [np.array(way) * given.DISPLACEMENT for way in LOADINGS.values()]
        energies = [2 * condensed.solve(np.array(given.LOADED), way)[2] for way in ways]
        return 2 * np.array(energies) / given.DISPLACEMENT

    return solve
