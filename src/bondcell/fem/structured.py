"""The first discretisation: curved quadrilaterals of high order, one set of operators a geometry."""

from __future__ import annotations

import time
from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.linalg
from numpy.typing import NDArray

from bondcell.cell import Cell, FloatArray
from bondcell.fem.cell_mesh import (
    MATRIX,
    PARTICLE_I,
    PARTICLE_J,
    CellMesh,
    Geometry,
    Grading,
    build_cell_mesh,
)
from bondcell.fem.element_matrices import ElementMatrices, cell_basis, element_matrices
from bondcell.fem.level import Level
from bondcell.fem.substructure import Condensed, Substructure
from bondcell.fem.supports import NORMAL, Supports


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


def shear_modulus(young: float, poisson: float) -> float:
    """``E / (2 (1 + nu))``, same unit as ``E``."""
    return young / (2 * (1 + poisson))


class CellOperators:
    """Everything about one geometry, order and load that does not depend on the materials.

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
    stiffness is ``own - coupling . X^-1 . coupling`` with ``X`` the sum of the condensed parts: the
    matrix, and each particle times its shear modulus over the matrix's. The particles' energy never
    meets the rigid motion, so round-off stays at the matrix's scale however stiff they are.
    """

    def __init__(
        self, mesh: CellMesh, order: int, supports: Supports, projected: bool = True
    ) -> None:
        basis = cell_basis(mesh.topology, mesh.mapping(order), order)
        matrices = element_matrices(basis, supports.mode, projected)
        self.order = order
        self.elements = int(mesh.topology.nelements)
        self.is_half = PARTICLE_J not in mesh.region
        self._scalar_count = int(basis.N)
        self._components = len(supports.mode.components)
        inner, outer = self._split(order)
        scalar = np.asarray(basis.element_dofs, dtype=np.int64).T
        dofs = np.concatenate(
            [scalar + c * self._scalar_count for c in range(self._components)], axis=1
        )
        held = self._marked(mesh, basis, supports.held)
        motion = self._motion(mesh, basis, supports.moved)
        self.dof = int(self._components * self._scalar_count - held.sum())
        used = {
            part: np.unique(dofs[mesh.region == part][:, outer])
            for part in (MATRIX, PARTICLE_I, PARTICLE_J)
        }
        shared_i = np.intersect1d(used[MATRIX], used[PARTICLE_I])
        shared_j = np.intersect1d(used[MATRIX], used[PARTICLE_J])
        self._interfaces = [shared[~held[shared]] for shared in (shared_i, shared_j)]
        parts = [(MATRIX, np.concatenate(self._interfaces), motion)]
        still = np.zeros_like(motion)
        parts.append((PARTICLE_I, self._interfaces[0], still))
        if not self.is_half:
            parts.append((PARTICLE_J, self._interfaces[1], still))
        self._parts = []
        for part, interface, moving in parts:
            rows = mesh.region == part
            own = ElementMatrices(matrices.shear[rows], matrices.bulk_root[rows])
            self._parts.append(
                Substructure(own, inner, outer, dofs[rows][:, outer], interface, held, moving)
            )
        self._condensed: dict[tuple[int, float], Condensed] = {}

    def _split(self, order: int) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """Local unknowns inside the element and on its boundary."""
        shapes, boundary = (order + 1) ** 2, 4 * order
        local = np.arange(self._components)[:, None] * shapes + np.arange(shapes)
        return local[:, boundary:].ravel(), local[:, :boundary].ravel()

    def _marked(
        self, mesh: CellMesh, basis: Any, where: dict[str, tuple[int, ...]]
    ) -> NDArray[np.bool_]:
        marked = np.zeros(self._components * self._scalar_count, dtype=bool)
        for name, components in where.items():
            if name in mesh.boundary and mesh.boundary[name].size:
                scalar = basis.get_dofs(facets=mesh.boundary[name]).all()
                for c in components:
                    marked[scalar + c * self._scalar_count] = True
        return marked

    def _motion(self, mesh: CellMesh, basis: Any, moved: dict[str, tuple[int, ...]]) -> FloatArray:
        """Unit motion of the moved boundaries, and of the whole of particle j.

        A constant is the sum of the vertex functions; edge and inner functions stay zero.
        """
        motion = np.zeros(self._components * self._scalar_count)
        vertices = [
            np.unique(mesh.topology.facets[:, mesh.boundary[name]])
            for name in moved
            if name in mesh.boundary
        ]
        vertices.append(np.unique(mesh.topology.t[:, mesh.region == PARTICLE_J]))
        (components,) = set(moved.values())
        for c in components:
            scalar = basis.nodal_dofs[0, np.concatenate(vertices).astype(np.int64)]
            motion[scalar + c * self._scalar_count] = 1.0
        return motion

    def condensed(self, part: int, poisson: float) -> Condensed:
        """One part at one Poisson's ratio; kept, since sweeps come back to it."""
        key = (part, poisson)
        if key not in self._condensed:
            self._condensed[key] = self._parts[part].condense(poisson)
        return self._condensed[key]

    def stiffness(self, materials: Materials) -> float:
        """Stiffness of the whole cell for one set of materials [N/m]."""
        matrix = self.condensed(0, materials.poisson_m)
        shear_m = materials.shear_m
        particles = [
            (materials.young_i, materials.poisson_i),
            (materials.young_j, materials.poisson_j),
        ]
        sizes = [interface.size for interface in self._interfaces]
        starts = np.concatenate(([0], np.cumsum(sizes)))
        pressures = np.arange(len(self._parts)) + starts[-1]
        system = np.zeros((pressures[-1] + 1, pressures[-1] + 1))
        own = np.concatenate((np.arange(starts[-1]), pressures[:1]))
        system[np.ix_(own, own)] = matrix.matrix
        right = np.zeros(len(system))
        right[own] = matrix.coupling
        free = np.ones(len(system), dtype=bool)
        for k in range(len(self._parts) - 1):
            young, poisson = particles[k]
            at = np.concatenate((np.arange(starts[k], starts[k + 1]), pressures[k + 1 : k + 2]))
            if np.isinf(young):
                free[at] = False
                continue
            ratio = shear_modulus(young, poisson) / shear_m
            system[np.ix_(at, at)] += ratio * self.condensed(k + 1, poisson).matrix
        answer = scipy.linalg.solve(
            system[np.ix_(free, free)], right[free], assume_a="gen", check_finite=False
        )
        stiffness = shear_m * (matrix.own - right[free] @ answer)
        return float(stiffness / 2 if self.is_half else stiffness)


def solve_level(
    cell: Cell,
    order: int,
    bc: str = "roller",
    grading: Grading | None = None,
    projected: bool = True,
) -> Level:
    """Solve one cell at one order and time the stages.

    Parameters
    ----------
    cell
        A single cell (every field of size one).
    order
        Polynomial order, at least 2.
    bc
        ``roller``, ``clamped`` or ``confined``.
    grading, projected
        Mesh grading and form; see `Grading` and `element_matrices`.
    """
    geometry, materials = split_cell(cell)
    started = time.perf_counter()
    half = geometry.is_mirrored and materials.is_mirrored
    mesh = build_cell_mesh(geometry, grading or Grading(), half)
    meshed = time.perf_counter()
    operators = CellOperators(mesh, order, NORMAL[bc], projected)
    assembled = time.perf_counter()
    stiffness = operators.stiffness(materials)
    solved = time.perf_counter()
    return Level(
        stiffness=stiffness,
        dof=operators.dof,
        elements=operators.elements,
        seconds_mesh=meshed - started,
        seconds_assembly=assembled - meshed,
        seconds_solve=solved - assembled,
    )


def split_cell(cell: Cell) -> tuple[Geometry, Materials]:
    """Geometry and materials of a single cell."""
    values = {name: float(np.squeeze(value)) for name, value in cell.as_dict().items()}
    names = ("radius_i", "radius_j", "gap", "cylinder_radius")
    geometry = Geometry(**{name: values.pop(name) for name in names})
    return geometry, Materials(**values)
