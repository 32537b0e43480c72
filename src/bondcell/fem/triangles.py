"""Second, independent discretisation: unstructured P2 triangles in the plain displacement form.

It shares nothing with the structured one but the cell: another mesh, other elements, another
formulation and another solver, so that an error in either shows as a difference. It converges as
h^4 in the energy, bounds the stiffness from above (up to the geometry's own h^4), and needs finer
meshes as Poisson's ratio approaches 1/2, where it locks.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from time import perf_counter
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csc_matrix
from scipy.sparse.linalg import splu
from skfem import Basis, BilinearForm, ElementTriP2, ElementVector, MeshTri2

from bondcell.cell import Cell, FloatArray
from bondcell.errors import InputError, Violation
from bondcell.fem.gmsh_mesh import Section, expected_triangles, triangle_mesh
from bondcell.fem.level import Level
from bondcell.fem.section_mesh import MATRIX, PARTICLE_I, PARTICLE_J, IntArray, TriangleMesh

CONDITIONS = ("roller", "clamped", "confined")
"""Boundary conditions of the normal load (theory: table of section 1)."""

MOST_TRIANGLES = 1_000_000
"""Meshes that would be larger are refused."""

QUADRATURE_ORDER = 5
"""Exact for the strain energy of straight P2 triangles, radius included."""

R, Z = 0, 1


def strain(u: Any, r: FloatArray) -> tuple[Any, Any, Any, Any]:
    """Axisymmetric strain (e_rr, e_tt, e_zz, e_rz) of the displacement (u_r, u_z)."""
    return u.grad[R, R], u[R] / r, u.grad[Z, Z], (u.grad[R, Z] + u.grad[Z, R]) / 2


def strain_energy(u: Any, v: Any, w: Any) -> Any:
    """``2 pi r [lambda tr e(u) tr e(v) + 2 mu e(u) : e(v)]``, to be integrated over the section."""
    r = w.x[R]
    rr, tt, zz, rz = strain(u, r)
    rr_, tt_, zz_, rz_ = strain(v, r)
    trace = (rr + tt + zz) * (rr_ + tt_ + zz_)
    product = rr * rr_ + tt * tt_ + zz * zz_ + 2 * rz * rz_
    return 2 * np.pi * r * (w["lam"] * trace + 2 * w["mu"] * product)


@dataclass(frozen=True)
class _Stiffness:
    """Global matrices in units of ``E_m R_c``, and where a node's unknowns are.

    ``matrix`` is the part of the matrix material, ``total`` all of the cell; ``dof`` has shape
    (2, nodes) for u_r and u_z.
    """

    matrix: csc_matrix
    total: csc_matrix
    dof: IntArray


def solve_level(cell: Cell, size: float, bc: str = "roller", *, symmetry: bool = True) -> Level:
    """Stiffness of one cell under the normal load.

    Parameters
    ----------
    cell
        A single cell (one point).
    size
        Element size relative to the local scale, see `bondcell.fem.gmsh_mesh.triangle_mesh`.
    bc
        One of `CONDITIONS`.
    symmetry
        Solve half of a cell whose particles are equal.

    Returns
    -------
    Level
        Stiffness [N/m], unknowns, triangles and the time of each stage.

    Raises
    ------
    InputError
        More than one cell, an unknown condition, a size that is not positive or asks for too many
        elements, or an incompressible material (the displacement form needs ``nu < 1/2``).

    Notes
    -----
    With the lift ``l`` = particle j moved rigidly by d = 1 and ``A w = -A l`` on the free unknowns,
    ``K = 2 U / d^2 = l.A.(l + w)``. A rigid motion strains no particle, so ``A l = A_m l``: the
    particles' large numbers never meet the matrix's small ones in a difference.

    A whole number of layers fits into the film between the spheres, so where the film governs
    (narrow gap, nu_m near 1/2) the error falls in steps: read an order off sizes below 1/2.

    Examples
    --------
    >>> cell = Cell.from_values(
    ...     radius_i=7.5e-3,
    ...     gap=5e-4,
    ...     young_i=3e10,
    ...     young_m=1.4e6,
    ...     poisson_i=0.25,
    ...     poisson_m=0.46,
    ... )
    >>> level = solve_level(cell, size=0.5)
    >>> abs(level.stiffness / 162460.7672 - 1) < 1e-3
    True
    """
    point = _single_point(cell, size, bc)
    half = symmetry and all(
        point[f"{k}_i"] == point[f"{k}_j"] for k in ("radius", "young", "poisson")
    )
    clock = _Clock()
    with clock("mesh"):
        mesh = triangle_mesh(_section(point, half, bc), size)
    with clock("assembly"):
        stiffness = _assemble(mesh, point)
    with clock("solve"):
        held, lift = _constraints(mesh, stiffness.dof, point, bc, half)
        relative = _solve(stiffness, held, lift)
    # Half a cell is one of two equal springs in series.
    unit = point["young_m"] * point["cylinder_radius"] * (0.5 if half else 1.0)
    return Level(
        stiffness=relative * unit,
        dof=int(np.count_nonzero(~held)),
        elements=mesh.material.size,
        seconds_mesh=clock.seconds["mesh"],
        seconds_assembly=clock.seconds["assembly"],
        seconds_solve=clock.seconds["solve"],
    )


class _Clock:
    """Wall time of named stages."""

    def __init__(self) -> None:
        self.seconds: dict[str, float] = {}

    @contextmanager
    def __call__(self, stage: str) -> Iterator[None]:
        started = perf_counter()
        yield
        self.seconds[stage] = perf_counter() - started


def _single_point(cell: Cell, size: float, bc: str) -> dict[str, float]:
    """Values of the cell as plain numbers; raise what `solve_level` says."""
    if int(np.prod(cell.shape)) != 1:
        raise InputError([Violation("cell", cell.shape, "a single cell: shape () or (1,)")])
    point = {name: float(value[0]) for name, value in cell.ravel().as_dict().items()}
    violations = [
        Violation(name, point[name], "(-1, 0.5) for the displacement form")
        for name in ("poisson_i", "poisson_j", "poisson_m")
        if point[name] >= 0.5
    ]
    if bc not in CONDITIONS:
        violations.append(Violation("bc", bc, f"one of {', '.join(CONDITIONS)}"))
    if not (np.isfinite(size) and size > 0):
        violations.append(Violation("size", size, "(0, inf)"))
    elif expected_triangles(_section(point, False, bc), size) > MOST_TRIANGLES:
        violations.append(Violation("size", size, f"one that needs <= {MOST_TRIANGLES} triangles"))
    if violations:
        raise InputError(violations)
    return point


def _section(point: dict[str, float], half: bool, bc: str) -> Section:
    unit = point["cylinder_radius"]
    return Section(
        radius_i=point["radius_i"] / unit,
        radius_j=point["radius_j"] / unit,
        gap=point["gap"] / unit,
        half=half,
        fine_corners=bc == "clamped",
    )


def _assemble(mesh: TriangleMesh, point: dict[str, float]) -> _Stiffness:
    """Assemble material by material; a rigid particle has no stiffness of its own."""
    triangulation = MeshTri2(mesh.points, mesh.triangles)
    element = ElementVector(ElementTriP2())
    form = BilinearForm(strain_energy)
    local = Basis(triangulation, element, intorder=1).element_dofs
    dof = np.empty((2, mesh.points.shape[1]), dtype=np.int64)
    dof[R, mesh.triangles], dof[Z, mesh.triangles] = local[R::2], local[Z::2]
    parts = {}
    for material, name in ((MATRIX, "m"), (PARTICLE_I, "i"), (PARTICLE_J, "j")):
        elements = np.flatnonzero(mesh.material == material)
        modulus, poisson = point[f"young_{name}"] / point["young_m"], point[f"poisson_{name}"]
        if elements.size == 0 or np.isinf(modulus):
            continue
        basis = Basis(triangulation, element, elements=elements, intorder=QUADRATURE_ORDER)
        lam = modulus * poisson / ((1 + poisson) * (1 - 2 * poisson))
        parts[name] = form.assemble(basis, lam=lam, mu=modulus / (2 * (1 + poisson)))
    return _Stiffness(matrix=parts["m"], total=sum(parts.values()), dof=dof)


def _constraints(
    mesh: TriangleMesh, dof: IntArray, point: dict[str, float], bc: str, half: bool
) -> tuple[NDArray[np.bool_], FloatArray]:
    """Which unknowns are prescribed, and the lift that carries their values."""
    held = np.zeros(dof.size, dtype=bool)
    lift = np.zeros(dof.size)
    lines = mesh.lines
    lift[dof[Z, lines["top"]]] = 1.0
    lift[dof[Z, mesh.nodes_of(PARTICLE_J)]] = 1.0
    held[dof[R, lines["axis"]]] = True
    held[dof[Z, lines["bottom"]]] = held[dof[Z, lines["top"]]] = True
    if bc == "confined":
        held[dof[R, lines["lateral"]]] = True
    if bc == "clamped":
        held[dof[R, lines["bottom"]]] = True
        if not half:  # the mid-plane of a symmetric pair is free to slide
            held[dof[R, lines["top"]]] = True
    for material, name in ((PARTICLE_I, "young_i"), (PARTICLE_J, "young_j")):
        if np.isinf(point[name]):
            held[dof[:, mesh.nodes_of(material)]] = True
    return held, lift


def _solve(stiffness: _Stiffness, held: NDArray[np.bool_], lift: FloatArray) -> float:
    """``l.A_m.(l + w)`` with ``A w = -A_m l`` on the free unknowns."""
    free = np.flatnonzero(~held)
    load = stiffness.matrix @ lift
    factors = splu(
        stiffness.total[free][:, free].tocsc(),
        permc_spec="MMD_AT_PLUS_A",
        diag_pivot_thresh=0.0,
        options={"SymmetricMode": True},
    )
    displacement = lift.copy()
    displacement[free] -= factors.solve(load[free])
    return float(load @ displacement)
