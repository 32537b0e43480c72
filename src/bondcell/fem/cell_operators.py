"""Everything about one geometry, order and load that does not depend on the materials."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from bondcell.cell import FloatArray
from bondcell.fem.cell_mesh import CellMesh
from bondcell.fem.cell_parts import CellParts
from bondcell.fem.half_cell import PARTICLE_J
from bondcell.fem.materials import Constants
from bondcell.fem.pencil import Pencil
from bondcell.fem.substructure import Condensed
from bondcell.fem.supports import Supports
from bondcell.fem.symmetric_solve import eliminated


class CellOperators:
    """Condensed parts of one mesh at one order, ready to be summed for any materials.

    Parameters
    ----------
    mesh
        Structured mesh, of the whole cell or of a symmetric pair's half.
    order
        Polynomial order of displacement and geometry.
    supports
        Load and boundary condition.
    projected
        Mixed form (default) or displacement form; see `element_matrices`.
    lag
        How many orders the particles stay behind the matrix; see `particle_lag`.

    Notes
    -----
    With the displacement ``u = lift + w``, where the lift moves particle j as a rigid body, the
    stiffness is ``own - coupling^T X^-1 coupling`` with ``X`` the sum of the condensed parts: the
    matrix, and each particle times its shear modulus over the matrix's. The particles' energy never
    meets the rigid motion, so round-off stays at the matrix's scale however stiff they are. Where
    particle i is softer than the matrix another lift does the same for the matrix: it follows
    particle j, and all the strain is left to particle i.
    """

    def __init__(
        self,
        mesh: CellMesh,
        order: int,
        supports: Supports,
        projected: bool = True,
        lag: int = 0,
    ) -> None:
        parts = CellParts(mesh, order, supports, projected, lag)
        self.elements, self.dof = int(mesh.topology.nelements), parts.dof
        self.is_half = PARTICLE_J not in mesh.region
        self.motions = parts.followed.shape[1]
        self._matrix, self._particles = parts.matrix, parts.particles
        self._followed = parts.followed
        interfaces = [particle.interface for particle in parts.particles]
        self._layout(interfaces, pressures=min(1, parts.matrix.matrices.pressures))
        self._systems: dict[float, Condensed] = {}
        self._particle_systems: dict[tuple[int, float], FloatArray] = {}
        self._joined: dict[tuple[tuple[float, ...], float], FloatArray] = {}

    def _layout(self, interfaces: list[NDArray[np.int64]], pressures: int) -> None:
        """Where each part's unknowns stand: interfaces first, then one pressure a part."""
        ends = np.concatenate(([0], np.cumsum([interface.size for interface in interfaces])))
        interface_size = int(ends[-1])
        self.size = interface_size + pressures * (1 + len(interfaces))
        self.of_matrix = np.arange(interface_size + pressures)
        self.of_particle = [
            np.concatenate(
                (
                    np.arange(ends[k], ends[k + 1]),
                    interface_size + pressures * (k + 1) + np.arange(pressures),
                )
            )
            for k in range(len(interfaces))
        ]
        self.is_displacement = np.arange(self.size) < interface_size

    def matrix_system(self, poisson: float) -> Condensed:
        """The matrix at one Poisson's ratio in the layout of all unknowns, unit shear modulus.

        Motions count twice: with the stiff lift, then with the soft one. Kept, for sweeps return.
        """
        if poisson not in self._systems:
            own = self._matrix.condense(poisson)
            matrix = np.zeros((self.size, self.size))
            matrix[np.ix_(self.of_matrix, self.of_matrix)] = own.matrix
            coupling = np.zeros((self.size, own.coupling.shape[1]))
            coupling[self.of_matrix] = own.coupling
            self._systems[poisson] = Condensed(matrix, coupling, own.own)
        return self._systems[poisson]

    def particle_system(self, particle: int, poisson: float) -> FloatArray:
        """Particle 0 or 1 at one Poisson's ratio on its own unknowns, unit shear modulus."""
        key = (particle, poisson)
        if key not in self._particle_systems:
            self._particle_systems[key] = self._particles[particle].condense(poisson).matrix
        return self._particle_systems[key]

    def response(self, constants: Constants) -> FloatArray:
        """Stiffness matrix of the motions, shape (motions, motions).

        Of the whole cell also where the mesh is half of it: half the energy at half the motion.
        """
        matrix = self.matrix_system(constants.poisson_m)
        soft = constants.shear[0] < constants.shear_m
        lift = slice(self.motions, None) if soft else slice(0, self.motions)
        system, right = matrix.matrix.copy(), matrix.coupling[:, lift].copy()
        constant = matrix.own[lift, lift].copy()
        free = np.ones(self.size, dtype=bool)
        for k, at in enumerate(self.of_particle):
            if np.isinf(constants.shear[k]):
                free[at] = False
                continue
            ratio = constants.shear[k] / constants.shear_m
            particle = ratio * self.particle_system(k, constants.poisson[k])
            system[np.ix_(at, at)] += particle
            if soft and k == 0:
                pull = particle[:, : len(self._followed)] @ self._followed
                right[at] += pull
                constant += self._followed.T @ pull[: len(self._followed)]
        moving, others = (
            np.flatnonzero(free & self.is_displacement),
            np.flatnonzero(free & ~self.is_displacement),
        )
        lost = eliminated(
            system[np.ix_(moving, moving)],
            np.concatenate((right[moving].T, system[np.ix_(others, moving)])),
            np.concatenate((right[others].T, system[np.ix_(others, others)])),
        )
        response = constants.shear_m * (constant - lost)
        return np.asarray(response / 2 if self.is_half else response)

    def pencil(self, poisson_m: float, poisson: Sequence[float], share: float) -> Pencil:
        """The system at one set of Poisson's ratios, ready for particles of any modulus.

        Parameters
        ----------
        poisson_m, poisson
            Poisson's ratios of the matrix and of each particle.
        share
            Shear modulus of particle j over that of particle i.
        """
        system = self.matrix_system(poisson_m)
        moving = int(self.is_displacement.sum())
        m = self.motions
        matrix, coupling, own = _eliminate(
            system.matrix, system.coupling[:, :m], system.own[:m, :m], self.of_matrix[moving:]
        )
        particles = self._joined_particles(tuple(poisson), share)
        return Pencil(matrix[:moving, :moving], particles, coupling[:moving], own, self.is_half)

    def _joined_particles(self, poisson: tuple[float, ...], share: float) -> FloatArray:
        """The particles on all displacements of the interfaces, pressures eliminated."""
        key = (poisson, share)
        if key not in self._joined:
            joined = np.zeros((self.size, self.size))
            for k, at in enumerate(self.of_particle):
                own = self.particle_system(k, poisson[k])
                joined[np.ix_(at, at)] = own if k == 0 else share * own
            moving = self.is_displacement
            others = np.setdiff1d(np.flatnonzero(~moving), self.of_matrix)
            nothing = np.zeros((self.size, 0))
            joined, _, _ = _eliminate(joined, nothing, np.zeros((0, 0)), others)
            self._joined[key] = joined[np.ix_(moving, moving)]
        return self._joined[key]


def _eliminate(
    matrix: FloatArray, coupling: FloatArray, own: FloatArray, gone: NDArray[np.int64]
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Eliminate some unknowns, whose rows are left to be ignored."""
    if not gone.size:
        return matrix, coupling, own
    rows = np.concatenate((matrix[gone], coupling[gone]), axis=1)
    solved = np.linalg.solve(matrix[np.ix_(gone, gone)], rows)
    size = len(matrix)
    return (
        matrix - rows[:, :size].T @ solved[:, :size],
        coupling - rows[:, :size].T @ solved[:, size:],
        own - rows[:, size:].T @ solved[:, size:],
    )
