"""Third, independent discretisation: one cell in three dimensions, curved P2 tetrahedra.

It knows nothing of Fourier modes, axes or half cells: Cartesian displacements of a quarter of the
whole cell in the plain displacement form. What it shares with the axisymmetric ones is the table of
loads alone, so it is the check of how those are reduced to the meridional section. It is a check
and no way to many digits: a few ten thousand unknowns give three of them.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from time import perf_counter

import numpy as np
from numpy.typing import NDArray

from bondcell.cell import Cell, FloatArray
from bondcell.errors import InputError, UnsupportedLoad, Violation
from bondcell.fem.level import Level
from bondcell.fem.tet_mesh import MATRIX, PARTICLE_I, PARTICLE_J, Body, tet_mesh
from bondcell.fem.tet_stiffness import assemble
from bondcell.fem.two_level import TwoLevelSolver

Motion = Callable[[FloatArray], FloatArray]
"""Unit rigid motion: coordinates from end plane j's centre -> displacements, both (3, nodes)."""

CLEARANCE = 0.05
"""Smallest clearance between sphere and side [cylinder radii]: cusps are for the section meshes."""

LARGEST_SIZE = 0.5
"""Larger elements would not follow the spheres without turning inside out."""

RESIDUAL = 1e-8
"""Relative residual of the iterative solve; the energy's error is its square."""

_FLAT = 1e-9
_MATERIALS = {MATRIX: "m", PARTICLE_I: "i", PARTICLE_J: "j"}

X, Y, Z = range(3)


@dataclass(frozen=True)
class Load:
    """A load on the quarter ``x >= 0, y >= 0`` of the cell (theory: table of section 1).

    Parameters
    ----------
    ends
        Components prescribed on both end planes.
    plane_x, plane_y
        Components that vanish on the cut planes ``x = 0`` and ``y = 0``: the normal one where the
        load is symmetric, the two others where it is antisymmetric.
    motions
        Motions of end plane j; end plane i is at rest.
    index
        Which of them is the load's own.
    """

    ends: tuple[int, ...]
    plane_x: tuple[int, ...]
    plane_y: tuple[int, ...]
    motions: tuple[Motion, ...]
    index: int = 0


def _push(p: FloatArray) -> FloatArray:
    """Translation along the axis."""
    return np.stack([0 * p[X], 0 * p[X], np.ones_like(p[X])])


def _shift(p: FloatArray) -> FloatArray:
    """Translation along x."""
    return np.stack([np.ones_like(p[X]), 0 * p[X], 0 * p[X]])


def _twist(p: FloatArray) -> FloatArray:
    """Rotation about the axis."""
    return np.stack([-p[Y], p[X], 0 * p[X]])


def _tilt(p: FloatArray) -> FloatArray:
    """Rotation about y."""
    return np.stack([p[Z], 0 * p[X], -p[X]])


LOADS = {
    "normal": Load((Z,), (X,), (Y,), (_push,)),
    "torsion": Load((X, Y, Z), (Y, Z), (X, Z), (_twist,)),
    "shear": Load((X, Y, Z), (Y, Z), (Y,), (_shift, _tilt)),
    "bending": Load((X, Y, Z), (Y, Z), (Y,), (_shift, _tilt), index=1),
}
"""The loads; the normal one is on rollers. Shear and bending are one system with two motions."""


def find_load(load: str) -> Load:
    """The entry of `LOADS`."""
    if load not in LOADS:
        raise UnsupportedLoad([Violation("load", load, ", ".join(sorted(LOADS)))])
    return LOADS[load]


class TetrahedralSolver:
    """One meshed and assembled cell, for any load.

    Parameters
    ----------
    cell
        A single cell (one point), thicker than its spheres and compressible.
    size
        Largest element relative to the larger sphere, see `bondcell.fem.tet_mesh.tet_mesh`.

    Raises
    ------
    InputError
        What is said about ``cell`` and ``size`` does not hold.
    """

    def __init__(self, cell: Cell, size: float) -> None:
        self._point = _single_point(cell, size)
        unit = self._point["cylinder_radius"]
        body = Body(**{name: self._point[name] / unit for name in ("radius_i", "radius_j", "gap")})
        started = perf_counter()
        self._mesh = tet_mesh(body, size).scaled(unit)
        meshed = perf_counter()
        self._length = body.length * unit
        self._stiffness = assemble(
            self._mesh,
            {
                material: (
                    self._point[f"young_{name}"] / self._point["young_m"],
                    self._point[f"poisson_{name}"],
                )
                for material, name in _MATERIALS.items()
            },
        )
        self.seconds_mesh, self.seconds_assembly = meshed - started, perf_counter() - meshed

    @property
    def elements(self) -> int:
        """Elements of the mesh."""
        return int(self._mesh.material.size)

    def dof(self, load: str) -> int:
        """Unknowns solved for."""
        return int(np.count_nonzero(~self._held(find_load(load))))

    def stiffness_matrix(self, load: str) -> FloatArray:
        """Stiffness of the load's motions [N/m, N, N m], shape (motions, motions).

        Notes
        -----
        With the lifts ``l_a`` = particle j and its end plane moved rigidly and ``A w_a = -A l_a``
        on the free unknowns, ``K_ab = l_a.A.(l_b + w_b)``, four times for the four quarters. A
        rigid motion strains no particle: ``A l = A_m l``.
        """
        entry, parts = find_load(load), self._stiffness
        lifts = np.stack([self._lift(motion) for motion in entry.motions], axis=1)
        pulls = parts.matrix @ lifts
        free = ~self._held(entry)
        coarse = free[: parts.embedding.shape[1]]
        solver = TwoLevelSolver(parts.total[free][:, free], parts.embedding[free][:, coarse])
        answer = lifts.copy()
        for k in range(len(entry.motions)):
            answer[free, k] -= solver.solve(pulls[free, k], RESIDUAL)
        return np.asarray(4 * self._point["young_m"] * (pulls.T @ answer))

    def stiffness(self, load: str) -> float:
        """Stiffness of the load's own motion [N/m, or N m/rad for rotations]."""
        index = find_load(load).index
        return float(self.stiffness_matrix(load)[index, index])

    def _on(self, component: int, position: float) -> NDArray[np.bool_]:
        """Nodes on a plane across an axis."""
        distance = self._mesh.points[component] - position
        return np.asarray(np.abs(distance) < _FLAT * self._length)

    def _held(self, load: Load) -> NDArray[np.bool_]:
        """Prescribed unknowns, shape (3 nodes,)."""
        held = np.zeros((self._mesh.points.shape[1], 3), dtype=bool)
        for axis, position, components in (
            (Z, 0.0, load.ends),
            (Z, self._length, load.ends),
            (X, 0.0, load.plane_x),
            (Y, 0.0, load.plane_y),
        ):
            nodes = np.flatnonzero(self._on(axis, position))
            held[nodes[:, np.newaxis], components] = True
        for material in (PARTICLE_I, PARTICLE_J):
            if np.isinf(self._point[f"young_{_MATERIALS[material]}"]):
                held[self._mesh.nodes_of(material)] = True
        return held.ravel()

    def _lift(self, motion: Motion) -> FloatArray:
        """Rigid motion of particle j and its end plane, shape (3 nodes,)."""
        moved = self._on(Z, self._length)
        moved[self._mesh.nodes_of(PARTICLE_J)] = True
        centre = np.array([[0.0], [0.0], [self._length]])
        return np.where(moved, motion(self._mesh.points - centre), 0.0).T.ravel()


def solve_level(cell: Cell, size: float, load: str = "normal") -> Level:
    """Solve one cell at one size and time the stages.

    Parameters
    ----------
    cell
        A single cell (one point), thicker than its spheres and compressible.
    size
        Largest element relative to the larger sphere, see `bondcell.fem.tet_mesh.tet_mesh`.
    load
        ``normal`` (on rollers), ``shear``, ``torsion`` or ``bending``.

    Examples
    --------
    A homogeneous cylinder is twisted by ``K = pi G R_c^4 / (2 L)``:

    >>> cell = Cell.from_values(
    ...     radius_i=1.0,
    ...     gap=0.5,
    ...     cylinder_radius=1.2,
    ...     young_i=1.0,
    ...     young_m=1.0,
    ...     poisson_i=0.25,
    ...     poisson_m=0.25,
    ... )
    >>> level = solve_level(cell, size=0.5, load="torsion")
    >>> abs(level.stiffness / (np.pi * 0.4 * 1.2**4 / 5) - 1) < 1e-3
    True
    """
    find_load(load)
    solver = TetrahedralSolver(cell, size)
    started = perf_counter()
    stiffness = solver.stiffness(load)
    return Level(
        stiffness=stiffness,
        dof=solver.dof(load),
        elements=solver.elements,
        seconds_mesh=solver.seconds_mesh,
        seconds_assembly=solver.seconds_assembly,
        seconds_solve=perf_counter() - started,
    )


def _single_point(cell: Cell, size: float) -> dict[str, float]:
    """Values of the cell as plain numbers; raise what `TetrahedralSolver` says."""
    if int(np.prod(cell.shape)) != 1:
        raise InputError([Violation("cell", cell.shape, "a single cell: shape () or (1,)")])
    point = {name: float(value[0]) for name, value in cell.ravel().as_dict().items()}
    violations = [
        Violation(name, point[name], "(-1, 0.5) for the displacement form")
        for name in ("poisson_i", "poisson_j", "poisson_m")
        if point[name] >= 0.5
    ]
    thinnest = max(point["radius_i"], point["radius_j"]) / (1 - CLEARANCE)
    if point["cylinder_radius"] < thinnest:
        allowed = f"[{thinnest}, inf) m: clear of the spheres"
        violations.append(Violation("cylinder_radius", point["cylinder_radius"], allowed))
    if not 0 < size <= LARGEST_SIZE:
        violations.append(Violation("size", size, f"(0, {LARGEST_SIZE}]"))
    if violations:
        raise InputError(violations)
    return point
