"""Everything about one geometry, order and load that does not depend on the materials."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from skfem import Basis

from bondcell.cell import FloatArray
from bondcell.fem.cell_mesh import CellMesh
from bondcell.fem.curved_mapping import lobatto_points
from bondcell.fem.element_matrices import ElementMatrices, cell_basis, element_matrices
from bondcell.fem.half_cell import MATRIX, PARTICLE_I, PARTICLE_J
from bondcell.fem.substructure import Condensed, Substructure
from bondcell.fem.supports import Motion, Supports
from bondcell.fem.symmetric_solve import solve_symmetric


@dataclass(frozen=True)
class Materials:
    """Elastic constants of one cell: Young's moduli [Pa] and Poisson's ratios."""

    young_i: float
    young_j: float
    young_m: float
    poisson_i: float
    poisson_j: float
    poisson_m: float

    @property
    def is_mirrored(self) -> bool:
        """Whether both particles are of one material."""
        return (self.young_i, self.poisson_i) == (self.young_j, self.poisson_j)

    @property
    def shear_m(self) -> float:
        """Shear modulus of the matrix [Pa]."""
        return shear_modulus(self.young_m, self.poisson_m)

    @property
    def particles(self) -> tuple[tuple[float, float], tuple[float, float]]:
        """Shear modulus [Pa] and Poisson's ratio of both particles."""
        return (
            (shear_modulus(self.young_i, self.poisson_i), self.poisson_i),
            (shear_modulus(self.young_j, self.poisson_j), self.poisson_j),
        )


def shear_modulus(young: float, poisson: float) -> float:
    """``E / (2 (1 + nu))``, same unit as ``E``."""
    return young / (2 * (1 + poisson))


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
        self, mesh: CellMesh, order: int, supports: Supports, projected: bool = True
    ) -> None:
        basis = cell_basis(mesh.topology, mesh.mapping(order), order)
        numbering = _Numbering(mesh, basis, len(supports.mode.components))
        held = numbering.marked(supports.held)
        rigid = _rigid_motions(mesh, numbering, order, supports)
        lifts = _lifts(mesh, numbering, supports, held, rigid)
        matrices = element_matrices(basis, supports.mode, projected)
        self.elements = int(mesh.topology.nelements)
        self.dof = int(held.size - held.sum())
        self.is_half = PARTICLE_J not in mesh.region
        particles = (PARTICLE_I,) if self.is_half else (PARTICLE_I, PARTICLE_J)
        skeleton = {
            part: np.unique(numbering.outer_dofs[mesh.region == part])
            for part in (MATRIX, *particles)
        }
        shared = [np.intersect1d(skeleton[MATRIX], skeleton[part]) for part in particles]
        self._interfaces = [dofs[~held[dofs]] for dofs in shared]

        def part(region: int, interface: NDArray[np.int64], moving: FloatArray) -> Substructure:
            rows = mesh.region == region
            own = ElementMatrices(matrices.shear[rows], matrices.bulk_root[rows])
            dofs = numbering.outer_dofs[rows]
            both = np.tile(rigid, 2)
            return Substructure(
                own, numbering.inner, numbering.outer, dofs, interface, held, moving, both
            )

        self._matrix = part(MATRIX, np.concatenate(self._interfaces), lifts)
        self._followed = rigid[self._interfaces[0]]
        still = np.zeros_like(lifts)
        self._particles = [
            part(region, interface, still)
            for region, interface in zip(particles, self._interfaces, strict=True)
        ]
        self._condensed: dict[tuple[int, float], Condensed] = {}

    def condensed(self, part: int, poisson: float) -> Condensed:
        """Matrix (0) or particle (1, 2) at one Poisson's ratio; kept, for sweeps return to it."""
        key = (part, poisson)
        if key not in self._condensed:
            parts = [self._matrix, *self._particles]
            self._condensed[key] = parts[part].condense(poisson)
        return self._condensed[key]

    def response(self, materials: Materials) -> FloatArray:
        """Stiffness matrix of the motions, shape (motions, motions).

        Of the whole cell also where the mesh is half of it: half the energy at half the motion.
        """
        matrix = self.condensed(MATRIX, materials.poisson_m)
        sizes = [interface.size for interface in self._interfaces]
        starts = np.concatenate(([0], np.cumsum(sizes)))
        extra = matrix.matrix.shape[0] - starts[-1]
        size = starts[-1] + extra * (1 + len(self._particles))
        system = np.zeros((size, size))
        own = np.arange(starts[-1] + extra)
        system[np.ix_(own, own)] = matrix.matrix
        soft = materials.particles[0][0] < materials.shear_m
        count = matrix.own.shape[0] // 2
        lift = slice(count, 2 * count) if soft else slice(0, count)
        right = np.zeros((size, count))
        right[own] = matrix.coupling[:, lift]
        constant = matrix.own[lift, lift].copy()
        free = np.ones(size, dtype=bool)
        for k in range(len(self._particles)):
            modulus, poisson = materials.particles[k]
            pressure = starts[-1] + extra * (k + 1) + np.arange(extra)
            at = np.concatenate((np.arange(starts[k], starts[k + 1]), pressure))
            if np.isinf(modulus):
                free[at] = False
                continue
            particle = modulus / materials.shear_m * self.condensed(k + 1, poisson).matrix
            system[np.ix_(at, at)] += particle
            if soft and k == 0:
                pull = particle[:, : sizes[0]] @ self._followed
                right[at] += pull
                constant += self._followed.T @ pull[: sizes[0]]
        answer = solve_symmetric(system[np.ix_(free, free)], right[free])
        response = materials.shear_m * (constant - right[free].T @ answer)
        return np.asarray(response / 2 if self.is_half else response)


class _Numbering:
    """Unknowns of a displacement, component by component; all share one scalar basis."""

    def __init__(self, mesh: CellMesh, basis: Basis, components: int) -> None:
        self.mesh, self.basis, self.components = mesh, basis, components
        self.count = int(basis.N)
        scalar = np.asarray(basis.element_dofs, dtype=np.int64).T
        self.scalar_dofs = scalar
        shapes, boundary = scalar.shape[1], 4 * basis.elem.p
        local = np.arange(components)[:, None] * shapes + np.arange(shapes)
        self.inner, self.outer = local[:, boundary:].ravel(), local[:, :boundary].ravel()
        self.outer_dofs = np.concatenate(
            [scalar[:, :boundary] + c * self.count for c in range(components)], axis=1
        )

    def marked(self, where: Mapping[str, tuple[int, ...]]) -> NDArray[np.bool_]:
        """Unknowns of the given components on the given boundaries."""
        marked = np.zeros(self.components * self.count, dtype=bool)
        for name, chosen in where.items():
            facets = self.mesh.boundary.get(name, np.empty(0))
            if facets.size:
                scalar = self.basis.get_dofs(facets=facets).all()
                for c in chosen:
                    marked[scalar + c * self.count] = True
        return marked


def _rigid_motions(
    mesh: CellMesh, numbering: _Numbering, order: int, supports: Supports
) -> FloatArray:
    """Coefficients of the unit motions of the whole cell, shape (unknowns, motions)."""
    return np.stack(
        [_interpolate(mesh, numbering, order, motion) for motion in supports.motions], axis=1
    )


def _lifts(
    mesh: CellMesh,
    numbering: _Numbering,
    supports: Supports,
    held: NDArray[np.bool_],
    rigid: FloatArray,
) -> FloatArray:
    """Motions that the displacement starts from: the stiff lifts, then the soft ones.

    Both follow the rigid motion on particle j and in the prescribed components of the moved
    boundaries. The stiff lift vanishes elsewhere; the soft one goes on through the matrix up to
    what is prescribed to be at rest.
    """
    moved = {name: supports.held[name] for name in supports.moved if name in mesh.boundary}
    prescribed = numbering.marked(moved) & held

    def on(chosen: NDArray[np.bool_]) -> NDArray[np.bool_]:
        scalar = np.unique(numbering.scalar_dofs[chosen])
        marked = np.zeros_like(held)
        for c in range(numbering.components):
            marked[scalar + c * numbering.count] = True
        return marked

    stiff = prescribed | on(mesh.region == PARTICLE_J)
    soft = stiff | (on(mesh.region != PARTICLE_I) & ~held)
    return np.concatenate([np.where(lift[:, None], rigid, 0.0) for lift in (stiff, soft)], axis=1)


def _interpolate(mesh: CellMesh, numbering: _Numbering, order: int, motion: Motion) -> FloatArray:
    """Coefficients of a motion, which the isoparametric space contains exactly."""
    points = lobatto_points(order)
    tensor = np.array([np.repeat(points, order + 1), np.tile(points, order + 1)])
    element = numbering.basis.elem
    shapes = np.array([element.lbasis(tensor, k)[0] for k in range(tensor.shape[1])])
    r, z = mesh.mapping(order).nodes.reshape(2, mesh.topology.nelements, -1)
    nodal = motion(r, z - mesh.end_height)
    coefficients = np.linalg.solve(shapes.T, nodal.reshape(-1, shapes.shape[1]).T).T
    result = np.zeros((numbering.components, numbering.count))
    result[:, numbering.scalar_dofs] = coefficients.reshape(nodal.shape)
    return result.ravel()
