"""Large displacements of particles in a neo-Hookean matrix, by load steps with Newton's method."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bondcell.cell import FloatArray
from bondcell.errors import BondcellError
from bondcell.fem.blocks import IndexArray
from bondcell.lattice.packing import Packing
from bondcell.solid.mean_system import MeanSystem
from bondcell.solid.multigrid import PMultigrid
from bondcell.solid.neo_hookean import NeoHookean
from bondcell.solid.particles import mean_motions
from bondcell.solid.stiffness import Elastic
from bondcell.solid.tets import MATRIX, Tets

STEPS = 2
"""Load steps, unless more are needed."""

MOST_NEWTON = 12
"""Iterations of one load step."""

WORK = 1e-7
"""Newton stops when a step's work on the unbalanced forces is this part of the energy."""

LINEAR_TOLERANCE = 1e-3
"""Of each linear solve: Newton corrects what it leaves."""


@dataclass(frozen=True)
class FiniteStrain:
    """The end of a load path.

    Parameters
    ----------
    energy
        Energy [J].
    field
        Displacements of the nodes [m], shape (nodes, 3).
    motion
        Mean motion of the particles as in `particles.MOTIONS`, shape (particles, 3).
    newton, dof
        Newton iterations of all steps, unknowns.
    path
        Energy after each load step [J], shape (steps,).
    """

    energy: float
    field: FloatArray
    motion: FloatArray
    newton: int
    dof: int
    path: FloatArray


def solve_finite_strain(
    mesh: Tets,
    packing: Packing,
    matrix: Elastic,
    particle: Elastic,
    held: NDArray[np.bool_],
    loaded: IndexArray,
    displacement: FloatArray,
    steps: int = STEPS,
) -> FiniteStrain:
    """Move the mean of some particles by a finite displacement.

    Parameters
    ----------
    mesh, packing, matrix, particle, held, loaded
        As in `bondcell.solid.elastic.solve_elastic`.
    displacement
        Displacement (x, y) of the loaded particles [m].
    steps
        Load steps.

    Raises
    ------
    BondcellError
        Newton's method does not converge: take more steps.
    """
    inside = mesh.material != MATRIX
    lam, mu = np.empty((2, inside.size))
    lam[~inside], mu[~inside] = matrix.lame
    lam[inside], mu[inside] = particle.lame
    solid = NeoHookean(mesh, lam, mu)
    functionals = mean_motions(mesh, packing)
    free = (~held).astype(np.float64).reshape(-1, 1)
    means = functionals[:, loaded, :2].reshape(len(free), -1) * free
    goal = np.tile(displacement, loaded.size)
    field, newton, path = np.zeros_like(mesh.points), 0, []
    for step in range(1, steps + 1):
        target = goal * step / steps
        try:
            field, energy, used = _equilibrium(solid, mesh, held, means, target, field)
        except BondcellError as error:
            text = f"no equilibrium in load step {step} of {steps} ({error}): take more load steps"
            raise BondcellError(text) from error
        newton += used
        path.append(energy)
    motion = np.einsum("upm,u->pm", functionals, field.ravel())
    dof = int(free.sum())
    return FiniteStrain(path[-1], field, motion, newton, dof, np.array(path))


def _equilibrium(
    solid: NeoHookean,
    mesh: Tets,
    held: NDArray[np.bool_],
    means: FloatArray,
    goal: FloatArray,
    field: FloatArray,
) -> tuple[FloatArray, float, int]:
    """Newton's method for one load step."""
    energy, forces = solid.energy_and_forces(field)
    for iteration in range(1, MOST_NEWTON + 1):
        tangent = solid.tangent(field)
        system = MeanSystem(tangent.fine, PMultigrid(mesh, tangent, held), means)
        missing = goal - means.T @ field.ravel()
        step, _, _ = system.solve(missing[:, np.newaxis], -forces.reshape(-1, 1), LINEAR_TOLERANCE)
        change = step.reshape(field.shape)
        work = abs(float(np.sum(change * system.unbalanced(forces.reshape(-1, 1)).reshape(-1, 3))))
        field, energy, forces, whole = _advance(solid, field, change)
        arrived = np.abs(missing).max() <= 1e-9 * np.abs(goal).max()
        if arrived and whole and work <= WORK * energy:
            return field, energy, iteration
    raise BondcellError(f"{MOST_NEWTON} Newton iterations")


def _advance(
    solid: NeoHookean, field: FloatArray, change: FloatArray
) -> tuple[FloatArray, float, FloatArray, bool]:
    """Go as far along a step as no element turns inside out; whether that is all of it."""
    for halvings in range(12):
        part = 0.5**halvings
        energy, forces = solid.energy_and_forces(field + part * change)
        if np.isfinite(energy):
            return field + part * change, energy, forces, halvings == 0
    raise BondcellError("an element turns inside out at any part of a Newton step")
