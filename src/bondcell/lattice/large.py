"""Plane lattices with large displacements and rotations."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from bondcell.cell import FloatArray
from bondcell.errors import BondcellError, InputError, Violation
from bondcell.lattice.arrays import spread
from bondcell.lattice.bonds import bond_lengths
from bondcell.lattice.large_pockets import add_pockets, add_springs, outer
from bondcell.lattice.lattice import Lattice

MOST_NEWTON = 30
"""Newton iterations of a load step."""

WORK = 1e-16
"""Newton stops when a step's work on the unbalanced forces is this part of the energy."""


@dataclass(frozen=True)
class LargeSolution:
    """A plane lattice in equilibrium after large motions.

    Parameters
    ----------
    motion
        Displacements (x, y) [m] and rotations [rad], shape (nodes, 3).
    reactions
        Forces [N] and moments [N m] on what is held, zero elsewhere, same shape.
    energies
        Energy by mode [J].
    newton
        Iterations of all load steps.
    """

    motion: FloatArray
    reactions: FloatArray
    energies: dict[str, float]
    newton: int

    @property
    def energy(self) -> float:
        """Energy of all modes [J]."""
        return sum(self.energies.values())


def solve_large(
    lattice: Lattice, held: ArrayLike, values: ArrayLike, steps: int = 4
) -> LargeSolution:
    """Move the supports of a plane lattice far.

    Parameters
    ----------
    lattice
        In the plane; a lattice without rotations resists along its bonds alone.
    held, values
        As in `bondcell.lattice.solve.solve`; reached in ``steps`` equal parts.

    Raises
    ------
    InputError
        The lattice is not plane, or has what is linear only: offsets, walls, pockets that resist
        rotations.
    BondcellError
        Newton's method does not converge.

    Notes
    -----
    Each spring keeps its stiffness and follows the motion: with l the distance of a bond's nodes,
    L its natural length and alpha the angle its axis has turned by, the strains are ``l - L``,
    ``L (alpha - p th_i - (1-p) th_j)`` and ``th_j - th_i``; a pocket's are those of its triangle,
    the first one the true change of area.

    Examples
    --------
    A bond that is turned with its nodes is not strained:

    >>> from bondcell.lattice.bonds import bonds
    >>> from bondcell.lattice.lattice import lattice
    >>> pair = lattice([[0, 0], [1, 0]], bonds([[0, 1]], 1.0, 1.0, 1.0))
    >>> quarter = [[0, 0, np.pi / 2], [-1, 1, np.pi / 2]]
    >>> abs(round(solve_large(pair, True, quarter).energy, 12))
    0.0
    """
    _check(lattice)
    shape = (lattice.count, lattice.width)
    fixed = spread("held", held, shape, bool)
    given = np.where(fixed, spread("values", values, shape, float), 0.0)
    free = ~fixed.ravel()
    motion, newton = np.zeros(shape), 0
    for step in range(1, steps + 1):
        target = given * step / steps
        # The tangent carries the new part of the prescribed motion to the free nodes.
        _, force, tangent = _state(lattice, motion)
        jump = np.where(fixed, target - motion, 0.0).ravel()
        right = -(force + tangent @ jump)[free]
        move = jump.copy()
        move[free] = np.linalg.solve(tangent[free][:, free], right)
        motion = motion + move.reshape(shape)
        motion, used = _newton(lattice, motion, free)
        newton += used + 1
    energies, force, _ = _state(lattice, motion)
    reactions = np.where(fixed, force.reshape(shape), 0.0)
    whole = np.zeros((lattice.count, 3))
    whole[:, : lattice.width] = motion
    pulls = np.zeros_like(whole)
    pulls[:, : lattice.width] = reactions
    return LargeSolution(whole, pulls, energies, newton)


def _check(lattice: Lattice) -> None:
    violations = []
    if lattice.dimension != 2:
        violations.append(Violation("points", lattice.points.shape, "shape (nodes, 2)"))
    if lattice.bonds.offset.any():
        violations.append(Violation("bonds.offset", lattice.bonds.offset.tolist(), "0 m"))
    if lattice.pockets.turns:
        constants = lattice.pockets.constants()[:, 3:5].tolist()
        violations.append(Violation("pockets.turning, pockets.twist", constants, "0 J"))
    if lattice.walls:
        violations.append(Violation("walls", len(lattice.walls), "none"))
    if violations:
        raise InputError(violations)


def _newton(
    lattice: Lattice, motion: FloatArray, free: NDArray[np.bool_]
) -> tuple[FloatArray, int]:
    """Equilibrium of the free unknowns from a start near it."""
    for iteration in range(1, MOST_NEWTON + 1):
        energies, force, tangent = _state(lattice, motion)
        step = np.zeros(free.size)
        if free.any():
            step[free] = -np.linalg.solve(tangent[free][:, free], force[free])
        motion = motion + step.reshape(motion.shape)
        if abs(step @ force) <= WORK * max(sum(energies.values()), np.finfo(float).tiny):
            return motion, iteration
    raise BondcellError(f"no equilibrium within {MOST_NEWTON} Newton iterations: more load steps")


def _state(lattice: Lattice, motion: FloatArray) -> tuple[dict[str, float], FloatArray, FloatArray]:
    """Energies by mode, forces (unknowns,) and tangent (unknowns, unknowns).

    Notes
    -----
    Of an energy ``k e^2 / 2`` the force is ``k e e'`` and the tangent ``k (e' e'^T + e e'')``.
    """
    width, own = lattice.width, lattice.bonds
    size = motion.size
    force, tangent = np.zeros(size), np.zeros((size, size))
    now = lattice.points + motion[:, :2]
    values, slopes, bends = _bond_strains(lattice, now, motion)
    ends = np.stack([own.first, own.second], axis=1)
    unknowns = (width * ends[:, :, np.newaxis] + np.arange(width)).reshape(own.count, -1)
    stiffness = lattice.bond_stiffness()
    energies = {}
    for k, mode in enumerate(("normal", "shear", "bending")[: stiffness.shape[1]]):
        energies[mode] = float((stiffness[:, k] * values[k] ** 2).sum() / 2)
        add_springs(force, tangent, unknowns, stiffness[:, k], values[k], slopes[k], bends[k])
    energies["pocket"] = add_pockets(lattice, motion, force, tangent)
    ground = lattice.ground.ravel()
    energies["ground"] = float((ground * motion.ravel() ** 2).sum() / 2)
    force += ground * motion.ravel()
    tangent[np.diag_indices(size)] += ground
    return energies, force, tangent


def _bond_strains(
    lattice: Lattice, now: FloatArray, motion: FloatArray
) -> tuple[list[FloatArray], list[FloatArray], list[FloatArray]]:
    """Strains of the bonds, their first and second derivatives by both nodes' unknowns."""
    own, width, count = lattice.bonds, lattice.width, lattice.bonds.count
    natural = bond_lengths(lattice.points, own)
    arm = now[own.second] - now[own.first]
    length = np.linalg.norm(arm, axis=1)
    along = arm / length[:, np.newaxis]
    across = np.stack([-along[:, 1], along[:, 0]], axis=1)
    relative = np.array([[-1.0], [1.0]])

    def by_nodes(vector: FloatArray) -> FloatArray:
        full = np.zeros((count, 2, width))
        full[:, :, :2] = relative * vector[:, np.newaxis]
        return full.reshape(count, -1)

    n, t = by_nodes(along), by_nodes(across)
    tt, nt = outer(t, t), outer(n, t)
    values = [length - natural]
    slopes, bends = [n], [tt / length[:, None, None]]
    if lattice.rotates:
        start = lattice.points[own.second] - lattice.points[own.first]
        cross = start[:, 0] * arm[:, 1] - start[:, 1] * arm[:, 0]
        angle = np.arctan2(cross, (start * arm).sum(axis=1))
        i, j = motion[own.first, 2], motion[own.second, 2]
        # Angles count beyond half a turn: the bond's is taken near that of its nodes.
        angle += 2 * np.pi * np.round(((i + j) / 2 - angle) / (2 * np.pi))
        values += [natural * (angle - own.pivot * i - (1 - own.pivot) * j), j - i]
        turn = t / length[:, np.newaxis]
        slide, bend = turn.copy(), np.zeros_like(turn)
        slide[:, 2], slide[:, width + 2] = -own.pivot, -(1 - own.pivot)
        bend[:, 2], bend[:, width + 2] = -1.0, 1.0
        slopes += [natural[:, np.newaxis] * slide, bend]
        second = -(nt + nt.transpose(0, 2, 1)) * (natural / length**2)[:, None, None]
        bends += [second, np.zeros_like(second)]
    return values, slopes, bends
