"""Equilibrium of a linear lattice: direct where it is small, multigrid where it is large."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.sparse import bsr_array, csc_array
from scipy.sparse.linalg import splu

from bondcell.cell import FloatArray
from bondcell.errors import InputError, Violation
from bondcell.lattice.arrays import spread
from bondcell.lattice.bonds import MODES
from bondcell.lattice.lattice import Lattice
from bondcell.lattice.mechanisms import check_supported
from bondcell.lattice.rigid_modes import rigid_modes

LARGEST_DIRECT = {2: 200_000, 3: 6_000}
"""Unknowns up to which the matrix is factorised, by the dimension of the lattice."""

TOLERANCE = 1e-8
"""Error of the iterative solve in the energy norm; the energy's error is its square."""

_STRAIN_MODES = {
    2: ("normal", "shear", "bending"),
    3: ("normal", "shear", "shear", "bending", "bending", "torsion"),
}


@dataclass(frozen=True)
class Solution:
    """A lattice in equilibrium.

    Parameters
    ----------
    motion
        Displacements [m], then rotations [rad] of the nodes, shape (nodes, width).
    reactions
        Forces [N] and moments [N m] on the prescribed unknowns, zero elsewhere, same shape.
    bond_forces
        Force or moment of each strain of each bond [N, N m], shape (bonds, strains).
    energies
        Energy by mode [J]: those of `bonds.MODES`, ``pocket`` and ``ground``.
    dof
        Unknowns solved for.
    iterations
        Steps of the iterative solver, 0 for a direct solve.
    """

    motion: FloatArray
    reactions: FloatArray
    bond_forces: FloatArray
    energies: dict[str, float]
    dof: int
    iterations: int

    @property
    def energy(self) -> float:
        """Energy of all modes [J]."""
        return sum(self.energies.values())


def solve(lattice: Lattice, held: ArrayLike, values: ArrayLike = 0.0) -> Solution:
    """Move the supports and find the rest.

    Parameters
    ----------
    lattice
        The lattice.
    held
        Prescribed unknowns, booleans that broadcast to (nodes, width).
    values
        Their values [m, rad], broadcast likewise; what is not held is not looked at.

    Raises
    ------
    InputError
        Shapes that do not fit; a free mechanism: all of them are named.
    BondcellError
        The iterative solver does not converge.

    Examples
    --------
    >>> from bondcell.lattice.bonds import bonds
    >>> from bondcell.lattice.lattice import lattice
    >>> pair = lattice([[0, 0], [0.0155, 0]], bonds([[0, 1]], normal=1.6e5))
    >>> pulled = solve(pair, held=[[True, True], [True, True]], values=[[0, 0], [1e-3, 0]])
    >>> round(pulled.energies["normal"], 12), round(float(pulled.reactions[1, 0]), 9)
    (0.08, 160.0)
    """
    shape = (lattice.count, lattice.width)
    fixed = spread("held", held, shape, bool)
    given = spread("values", values, shape, float)
    if not np.isfinite(given[fixed]).all():
        raise InputError([Violation("values", float("nan"), "finite prescribed displacements")])
    matrix = lattice.matrix()
    check_supported(lattice, matrix, fixed)
    start = np.where(fixed, given, 0.0).ravel()
    motion, iterations = start, 0
    dof = int(np.count_nonzero(~fixed))
    if dof:
        right = np.where(fixed.ravel(), 0.0, -(matrix @ start))
        step, iterations = _free_motion(lattice, matrix, fixed, right)
        motion = start + step
    forces = np.where(fixed.ravel(), matrix @ motion, 0.0).reshape(shape)
    rows = motion.reshape(shape)
    bond_forces, energies = _by_mode(lattice, rows)
    return Solution(rows, forces, bond_forces, energies, dof, iterations)


def _free_motion(
    lattice: Lattice, matrix: bsr_array, held: NDArray[np.bool_], right: FloatArray
) -> tuple[FloatArray, int]:
    """Solve for the free unknowns; zero at the others."""
    free = ~held.ravel()
    if np.count_nonzero(free) > LARGEST_DIRECT[lattice.dimension]:
        from bondcell.lattice.multigrid import solve_iteratively

        modes = rigid_modes(lattice.points, lattice.rotates)
        return solve_iteratively(matrix, held, modes, right, TOLERANCE)
    scale = 1 / np.sqrt(matrix.diagonal()[free])
    inner = csc_array(matrix.tocsr()[free][:, free])
    inner = csc_array(inner.multiply(scale).multiply(scale[:, np.newaxis]))
    factors = splu(
        inner,
        permc_spec="MMD_AT_PLUS_A",
        diag_pivot_thresh=0.0,
        options={"SymmetricMode": True},
    )
    result = np.zeros(right.size)
    result[free] = scale * factors.solve(scale * right[free])
    # One step of refinement: stiffnesses of very different size share the matrix.
    rest = (right - matrix @ result)[free]
    result[free] += scale * factors.solve(scale * rest)
    return result, 0


def _by_mode(lattice: Lattice, motion: FloatArray) -> tuple[FloatArray, dict[str, float]]:
    """Forces of the bonds, and energies by mode."""
    own = lattice.bonds
    ends = np.concatenate([motion[own.first], motion[own.second]], axis=1)
    strain = np.einsum("bsu,bu->bs", lattice.bond_strains(), ends)
    forces = lattice.bond_stiffness() * strain
    each = 0.5 * (forces * strain).sum(axis=0)
    energies = dict.fromkeys(MODES[lattice.dimension], 0.0)
    for mode, energy in zip(_STRAIN_MODES[lattice.dimension], each.tolist(), strict=False):
        energies[mode] += energy
    corners = motion[lattice.pockets.corners].reshape(lattice.pockets.count, 3 * lattice.width)
    change = np.einsum("psu,pu->ps", lattice.pocket_strains(), corners)
    energies["pocket"] = float(0.5 * (lattice.pockets.constants() * change**2).sum())
    energies["ground"] = float(0.5 * (lattice.ground * motion**2).sum())
    for wall in lattice.walls:
        own_motion = motion[wall.nodes].ravel()
        energies["ground"] += float(0.5 * own_motion @ wall.stiffness @ own_motion)
    return forces, energies
