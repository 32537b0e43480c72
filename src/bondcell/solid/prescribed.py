"""Equilibrium of the matrix material where nodes are moved in a given way."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray

from bondcell.cell import FloatArray
from bondcell.fem.blocks import product
from bondcell.fem.krylov import TOLERANCE, conjugate_gradients
from bondcell.solid.multigrid import PMultigrid
from bondcell.solid.stiffness import Elastic, assemble
from bondcell.solid.tets import MATRIX, Tets


@dataclass(frozen=True)
class Prescribed:
    """Answer of the matrix material to prescribed displacements.

    Parameters
    ----------
    energy
        Energies of pairs of cases [J]; on the diagonal ``2 U``, shape (cases, cases).
    dof, iterations
        Unknowns and steps of the iterative solver.
    """

    energy: FloatArray
    dof: int
    iterations: int


def solve_prescribed(
    mesh: Tets,
    matrix: Elastic,
    held: NDArray[np.bool_],
    values: FloatArray,
    tolerance: float = TOLERANCE,
) -> Prescribed:
    """Move nodes and let the rest of the matrix material follow.

    Parameters
    ----------
    mesh
        The mesh; its particles count for nothing but the nodes on them that are held.
    matrix
        The matrix material.
    held
        Prescribed displacements, shape (nodes, 3).
    values
        Their values [m], shape (nodes, 3, cases).
    tolerance
        Error in the energy norm; the energy's error is its square.
    """
    part, nodes = mesh.part(mesh.material == MATRIX)
    stiffness = assemble(part, matrix, None)
    solver = PMultigrid(part, stiffness, held[nodes], many=True)
    start = np.where(held[nodes][..., np.newaxis], values[nodes], 0.0)
    field = start.reshape(-1, values.shape[2])
    right = -product(stiffness.fine, field) * solver.free[:, np.newaxis]
    step, iterations = conjugate_gradients(
        partial(product, solver.matrix), solver, right, tolerance
    )
    field += step
    energy = field.T @ product(stiffness.fine, field)
    return Prescribed(energy, int(solver.free.sum()), iterations)
