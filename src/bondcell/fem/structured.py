"""The first discretisation: curved quadrilaterals of high order, any load, any materials."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, fields
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from bondcell.cell import Cell, FloatArray
from bondcell.errors import UnsupportedLoad, Violation
from bondcell.fem.cell_mesh import CellMesh, Geometry, Grading, build_cell_mesh
from bondcell.fem.cell_operators import CellOperators
from bondcell.fem.level import Level
from bondcell.fem.materials import Constants, Materials
from bondcell.fem.supports import (
    BEAM,
    BENDING_HALF,
    NORMAL,
    SHEAR_HALF,
    TORSION,
    Supports,
)
from bondcell.fem.sweep import respond
from bondcell.fem.threads import one_thread

OFFSET = 1e-3
"""Interpolation offset in compressibility over gap/R: thinner films are stiffer in volume."""

CORNER = 3e-6
"""Where refinement toward the rims of held end planes, where stress is singular, stops [radii]."""


@dataclass(frozen=True)
class Load:
    """How a load is solved.

    Parameters
    ----------
    whole
        Supports of the whole cell.
    halves
        Supports of the half of a symmetric pair, in the order that ``join`` takes.
    join
        Responses of the halves and the cell's length -> stiffness matrices of the whole, all of
        shape (points, motions, motions).
    index
        Which motion of the whole is the load's own.
    grading
        Mesh grading that the load needs.
    rate
        How much closer to the limit one more order comes usually at least.
    early_cut, usual_cut
        Relative errors of cutting the cusp early beside particles of ratio 100, and where
        ``grading`` cuts it beside particles of the matrix's modulus; see `reference`.
    """

    whole: Supports
    halves: tuple[Supports, ...]
    join: Callable[[list[FloatArray], float], FloatArray]
    index: int
    grading: Grading
    rate: float = 4.0
    early_cut: float = 1e-7
    usual_cut: float = 1.5e-7


def _alone(responses: list[FloatArray], length: float) -> FloatArray:
    return responses[0]


def _beam(responses: list[FloatArray], length: float) -> FloatArray:
    """Shear and bending of a symmetric pair from its two symmetric motions.

    Turning one end plane is half a symmetric turn of both and half an antisymmetric one, and the
    latter is a shift by ``L/2`` seen in a turned frame.
    """
    shear, turn = (response[:, 0, 0] for response in responses)
    coupling = -shear * length / 2
    bending = turn + shear * length**2 / 4
    return np.stack([np.stack([shear, coupling], -1), np.stack([coupling, bending], -1)], -2)


_GRADED = Grading(corner=CORNER)
LOADS = {
    ("normal", "roller"): Load(
        NORMAL["roller"], (NORMAL["roller"],), _alone, 0, Grading(), 4.0, 2e-8, 1.6e-8
    ),
    ("normal", "clamped"): Load(
        NORMAL["clamped"], (NORMAL["clamped"],), _alone, 0, _GRADED, usual_cut=8e-8
    ),
    ("normal", "confined"): Load(
        NORMAL["confined"],
        (NORMAL["confined"],),
        _alone,
        0,
        Grading(foot=2e-6),
        usual_cut=1e-8,
    ),
    ("torsion", None): Load(TORSION, (TORSION,), _alone, 0, Grading(), 10.0, 2e-8, 2e-8),
    ("shear", None): Load(BEAM, (SHEAR_HALF,), _alone, 0, _GRADED),
    ("bending", None): Load(BEAM, (SHEAR_HALF, BENDING_HALF), _beam, 1, _GRADED),
}
"""Load and boundary condition (for the normal load) -> how it is solved."""


def find_load(load: str, bc: str | None) -> Load:
    """The entry of `LOADS`; boundary conditions other than of the normal load do not exist."""
    key = (load, bc if load == "normal" else None)
    if key in LOADS:
        return LOADS[key]
    known = sorted({name for name, _ in LOADS})
    if load in known:
        choices = ", ".join(str(c) for name, c in LOADS if name == load)
        raise UnsupportedLoad([Violation("bc", bc, choices)])
    raise UnsupportedLoad([Violation("load", load, ", ".join(known))])


@dataclass(frozen=True)
class Sweep:
    """Many points of one geometry and order, arrays of shape (points,).

    Parameters
    ----------
    stiffness
        Stiffness of the load's own motion, NaN where the system is singular.
    reduction_error
        Bound of what a reduced basis added, same unit; zero where none was used.
    way
        `sweep.Way` of each point.
    coupling
        Force across the axis for a unit rotation of end plane j [N/rad]; NaN for other loads.
    """

    stiffness: FloatArray
    reduction_error: FloatArray
    way: NDArray[np.int8]
    coupling: FloatArray


class CellSolver:
    """Operators of one geometry, load and order.

    Parameters
    ----------
    geometry
        Dimensions of the cell.
    load
        How the load is solved.
    half
        Solve half of a symmetric pair.
    order
        Polynomial order.
    mesh
        The mesh, if it is there already.
    projected
        Mixed form (default) or displacement form.
    lag
        How many orders the particles stay behind the matrix; see `particle_lag`.
    """

    def __init__(
        self,
        geometry: Geometry,
        load: Load,
        half: bool,
        order: int,
        mesh: CellMesh | None = None,
        projected: bool = True,
        lag: int = 0,
    ) -> None:
        self._load, self._half = load, half
        self._length = geometry.radius_i + geometry.radius_j + geometry.gap
        self._gap_ratio = geometry.gap / max(geometry.radius_i, geometry.radius_j)
        mesh = mesh or build_cell_mesh(geometry, load.grading, half)
        supports = load.halves if half else (load.whole,)
        self._operators = [CellOperators(mesh, order, s, projected, lag) for s in supports]

    @cached_property
    def dof(self) -> int:
        """Unknowns of all systems solved for a point."""
        return sum(operators.dof for operators in self._operators)

    @property
    def elements(self) -> int:
        """Elements of the mesh."""
        return self._operators[0].elements

    def stiffness_matrix(self, constants: Constants) -> FloatArray:
        """Stiffness of the end plane's motions: one, or shear and rotation with their coupling."""
        responses = [operators.response(constants)[None] for operators in self._operators]
        return self._join(responses)[0]

    def stiffness(self, constants: Constants) -> float:
        """Stiffness of the load's own motion [N/m, or N m/rad for rotations]."""
        return float(self._own(self.stiffness_matrix(constants)[None])[0])

    def sweep(self, materials: Materials, tolerance: float) -> Sweep:
        """Stiffness of many points; ``tolerance`` is what a reduction may add, relative."""
        offset = OFFSET * self._gap_ratio
        answers = [respond(o, materials, tolerance, offset) for o in self._operators]
        joined = self._join([answer.matrix for answer in answers])
        coupling = np.full(len(joined), np.nan) if joined.shape[1] == 1 else joined[:, 0, 1]
        errors = [a.error[:, :, None] * np.eye(a.error.shape[1]) for a in answers]
        way = np.max([answer.way for answer in answers], axis=0)
        return Sweep(self._own(joined), self._own(self._join(errors)), way, coupling)

    def by_ratio(self, poisson_m: float, poisson: float, ratios: FloatArray) -> FloatArray:
        """Stiffness over the matrix's shear modulus of equal particles at many modulus ratios.

        Parameters
        ----------
        poisson_m, poisson
            Poisson's ratios of matrix and particles.
        ratios
            Shear modulus of the particles over the matrix's, infinite if rigid.
        """
        pencils = [o.pencil(poisson_m, [poisson] * 2, 1.0) for o in self._operators]
        return self._own(self._join([pencil.response(ratios) for pencil in pencils]))

    def _join(self, responses: list[FloatArray]) -> FloatArray:
        return self._load.join(responses, self._length) if self._half else responses[0]

    def _own(self, matrices: FloatArray) -> FloatArray:
        index = min(self._load.index, matrices.shape[1] - 1)
        return matrices[:, index, index]


@one_thread()
def solve_level(
    cell: Cell,
    order: int,
    bc: str | None = "roller",
    load: str = "normal",
    grading: Grading | None = None,
    projected: bool = True,
    lag: int = 0,
) -> Level:
    """Solve one cell at one order and time the stages.

    Parameters
    ----------
    cell
        A single cell (every field of size one).
    order
        Polynomial order, at least 2.
    bc
        ``roller``, ``clamped`` or ``confined`` for the normal load.
    load
        ``normal``, ``shear``, ``torsion`` or ``bending``.
    grading, projected, lag
        Mesh grading (the load's own by default), form, and how many orders the particles stay
        behind; see `Grading`, `element_matrices` and `particle_lag`.
    """
    cell = cell.ravel()
    geometry, materials = geometry_of(cell), Materials.of(cell)
    entry = find_load(load, bc)
    half = bool(geometry.is_mirrored and materials.is_mirrored[0])
    started = time.perf_counter()
    mesh = build_cell_mesh(geometry, grading or entry.grading, half)
    meshed = time.perf_counter()
    solver = CellSolver(geometry, entry, half, order, mesh, projected, lag)
    assembled = time.perf_counter()
    stiffness = solver.stiffness(materials.constants(0))
    solved = time.perf_counter()
    return Level(
        stiffness=stiffness,
        dof=solver.dof,
        elements=solver.elements,
        seconds_mesh=meshed - started,
        seconds_assembly=assembled - meshed,
        seconds_solve=solved - assembled,
    )


def geometry_of(cell: Cell) -> Geometry:
    """Dimensions of a raveled cell whose points share them."""
    return Geometry(*(float(getattr(cell, field.name)[0]) for field in fields(Geometry)))
