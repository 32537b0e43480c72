"""Elastic particles: the mean displacement of some is prescribed, everything else is free."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bondcell.cell import FloatArray
from bondcell.fem.blocks import IndexArray
from bondcell.fem.krylov import TOLERANCE
from bondcell.lattice.packing import Packing
from bondcell.solid.mean_system import MeanSystem
from bondcell.solid.multigrid import PMultigrid
from bondcell.solid.particles import mean_motions
from bondcell.solid.stiffness import Elastic, assemble
from bondcell.solid.tets import Tets


@dataclass(frozen=True)
class ElasticSolution:
    """Load cases of a solid with elastic particles.

    Parameters
    ----------
    field
        Displacements of the nodes [m], shape (nodes, 3, cases).
    motion
        Mean motion of the particles as in `particles.MOTIONS`, shape (particles, 3, cases).
    forces
        Forces that move the loaded particles (x, y) [N], shape (loaded, 2, cases).
    energy
        Energy [J], shape (cases,).
    dof, iterations
        Unknowns and steps of the iterative solver.
    """

    field: FloatArray
    motion: FloatArray
    forces: FloatArray
    energy: FloatArray
    dof: int
    iterations: int


def solve_elastic(
    mesh: Tets,
    packing: Packing,
    matrix: Elastic,
    particle: Elastic,
    held: NDArray[np.bool_],
    loaded: IndexArray,
    displacements: FloatArray,
    tolerance: float = TOLERANCE,
) -> ElasticSolution:
    """Prescribe the mean displacement of some particles.

    Parameters
    ----------
    mesh, packing
        The mesh and its spheres.
    matrix, particle
        Materials.
    held
        Displacements that are zero, shape (nodes, 3).
    loaded
        The particles moved.
    displacements
        Displacement (x, y) of all of them in each case [m], shape (cases, 2).
    tolerance
        Error in the energy norm; the energy's error is its square.

    """
    stiffness = assemble(mesh, matrix, particle)
    solver = PMultigrid(mesh, stiffness, held)
    free = solver.free[:, np.newaxis]
    functionals = mean_motions(mesh, packing)
    means = functionals[:, loaded, :2].reshape(len(free), -1) * free
    given = np.tile(displacements, loaded.size).T
    system = MeanSystem(stiffness.fine, solver, means)
    answer, forces, iterations = system.solve(given, tolerance=tolerance)
    cases = len(displacements)
    return ElasticSolution(
        field=answer.reshape(-1, 3, cases),
        motion=np.einsum("upm,uc->pmc", functionals, answer),
        forces=forces.reshape(loaded.size, 2, cases),
        energy=np.einsum("fc,fc->c", given, forces) / 2,
        dof=int(solver.free.sum()),
        iterations=iterations,
    )
