"""Shear, torsion and bending of the structured reference: closed forms, symmetries and limits."""

from dataclasses import replace

import numpy as np
import pytest

from bondcell.cell import Cell
from bondcell.fem.cell_basis import cell_basis
from bondcell.fem.cell_mesh import build_cell_mesh
from bondcell.fem.element_matrices import element_matrices
from bondcell.fem.lifts import rigid_motions
from bondcell.fem.materials import Materials
from bondcell.fem.numbering import Numbering
from bondcell.fem.reference import solve
from bondcell.fem.structured import LOADS, CellSolver, find_load, geometry_of, solve_level
from bondcell.status import Status

BASE = {
    "radius_i": 7.5e-3,
    "gap": 5e-4,
    "young_i": 3e10,
    "young_m": 1.4e6,
    "poisson_i": 0.25,
    "poisson_m": 0.46,
}
UNEQUAL = {"radius_j": 5e-3, "young_j": 2e8, "poisson_j": 0.1}
OTHER_LOADS = ("shear", "torsion", "bending")


def cell(**changes):
    return Cell.from_values(**BASE | changes)


def matrix(case, load="bending", half=False, order=6):
    """Stiffness of the motions of end plane j; of shear and bending: translation and rotation."""
    case = case.ravel()
    solver = CellSolver(geometry_of(case), find_load(load, "roller"), half, order)
    return solver.stiffness_matrix(Materials.of(case).constants(0))


def turned_over(k, length):
    """Stiffness of the cell's other end: the same cell seen upside down.

    Turning the whole cell as a rigid body strains nothing, so a rotation of plane i is as good as
    the opposite rotation of plane j and its shift by ``L``: with ``K_ij`` that of both rotations,
    ``K_s L^2 = K_ii + 2 K_ij + K_jj`` and ``-C L = K_ij + K_jj``.
    """
    motion = np.array([[-1.0, length], [0.0, 1.0]])
    return motion.T @ k @ motion


def timoshenko(case, poisson):
    """Beam with one end held: stiffness of the other's translation and rotation."""
    length, radius = float(case.length), float(case.cylinder_radius)
    flexural, area = 1.4e6 * np.pi * radius**4 / 4, np.pi * radius**2
    kappa = 6 * (1 + poisson) ** 2 / (7 + 12 * poisson + 4 * poisson**2)
    shear = 1.4e6 / (2 * (1 + poisson))
    phi = 12 * flexural / (kappa * shear * area * length**2)
    k = 12 * flexural / (length**3 * (1 + phi))
    bending = flexural / length + k * length**2 / 4
    return np.array([[k, -k * length / 2], [-k * length / 2, bending]])


@pytest.mark.parametrize("poisson", [-0.5, 0.0, 0.3, 0.5])
@pytest.mark.parametrize("shape", [{}, {"radius_j": 2e-3}, {"cylinder_radius": 1e-2}])
def test_torsion_of_a_homogeneous_cylinder_is_exact(poisson, shape):
    case = cell(young_i=1.4e6, poisson_i=poisson, poisson_m=poisson, **shape)
    shear = 1.4e6 / (2 * (1 + poisson))
    exact = np.pi * shear * float(case.cylinder_radius) ** 4 / (2 * float(case.length))
    # What is cut off at the foot is missing.
    assert solve_level(case, 6, load="torsion").stiffness == pytest.approx(exact, rel=3e-8)


@pytest.mark.parametrize("poisson", [-0.4, 0.0, 0.3, 0.5])
@pytest.mark.parametrize("slenderness", [10, 40])
def test_slender_homogeneous_cylinder_is_a_timoshenko_beam(poisson, slenderness):
    """Held ends stiffen it: about a radius of its length contracts less.

    That is an energy of the order of nu^2, relative to ``s = L/R``. What remains at nu = 0 is the
    warping of the section by shear, whose own share of the compliance falls as 1/s^2.
    """
    case = cell(gap=(slenderness - 2) * 7.5e-3, young_i=1.4e6, poisson_i=poisson, poisson_m=poisson)
    excess = matrix(case, half=True, order=5) / timoshenko(case, poisson) - 1
    assert (excess > 0).all()
    assert (excess < 3 * poisson**2 / slenderness + 0.4 / slenderness**3).all()


@pytest.mark.parametrize("load", ["normal", "torsion", "bending"])
@pytest.mark.parametrize(
    "changes", [{}, {"gap": 7.5e-6}, {"cylinder_radius": 1e-2, "poisson_m": 0.3}]
)
def test_whole_of_a_symmetric_pair_equals_twice_its_half(load, changes):
    """So the coupling of the whole is ``-K_s L / 2``, by which the halves are joined."""
    half, whole = (matrix(cell(**changes), load, half) for half in (True, False))
    np.testing.assert_allclose(whole, half, rtol=3e-9)


@pytest.mark.parametrize("load", ["normal", "torsion", "bending"])
def test_rigid_motions_are_in_the_space_and_strain_no_element(load):
    entry, order = find_load(load, "roller"), 5
    mesh = build_cell_mesh(geometry_of(cell(**UNEQUAL).ravel()), entry.grading, half=False)
    basis = cell_basis(mesh.topology, mesh.mapping(order), order)
    supports = entry.whole
    numbering = Numbering(mesh, basis, len(supports.mode.components))
    coefficients = rigid_motions(mesh, numbering, order, supports).T
    fields = coefficients.reshape(-1, numbering.components, numbering.count)
    local = fields[:, :, numbering.scalar_dofs].transpose(0, 2, 1, 3)
    local = local.reshape(*local.shape[:2], -1)
    local = local[:, :, np.concatenate((numbering.inner, numbering.outer))]
    matrices = element_matrices(basis.points, supports.mode, projected=True)
    forces = np.einsum("eab,meb->mea", matrices.shear, local)
    dilations = np.einsum("epb,meb->mep", matrices.bulk_root, local)
    largest = np.abs(local).max(axis=2, keepdims=True)
    stiffness = np.abs(matrices.shear).max(axis=(1, 2))[:, None]
    assert np.abs(forces / largest / stiffness).max() < 1e-11
    assert np.abs(dilations / largest / np.sqrt(stiffness)).max(initial=0) < 1e-11


@pytest.mark.parametrize(
    "changes", [UNEQUAL, {"radius_j": 1e-3, "gap": 5e-5}, {"young_i": 1.4e5, "young_j": 2e6}]
)
def test_rotating_the_whole_cell_strains_nothing(changes):
    """The other end's stiffness is known from this end's, and so is the swapped cell's."""
    case = cell(**changes)
    expected = turned_over(matrix(case), float(case.length))
    np.testing.assert_allclose(matrix(case.swapped()), expected, rtol=1e-7)
    np.testing.assert_allclose(expected, expected.T, rtol=1e-8)
    assert (np.linalg.eigvalsh(expected) > 0).all()


@pytest.mark.parametrize("changes", [UNEQUAL, {"radius_j": 1e-3, "gap": 5e-5, "poisson_m": 0.5}])
def test_swapping_the_particles_does_not_change_torsion(changes):
    case = cell(**changes)
    swapped = solve_level(case.swapped(), 6, load="torsion").stiffness
    assert swapped == pytest.approx(solve_level(case, 6, load="torsion").stiffness, rel=1e-9)


@pytest.mark.parametrize(("length", "modulus"), [(1e3, 1e-2), (4e-3, 7e5)])
@pytest.mark.parametrize("load", ["torsion", "bending"])
def test_dimensional_scaling(length, modulus, load):
    values = BASE | UNEQUAL | {"gap": 2e-3, "cylinder_radius": 8e-3}
    scaled = {
        name: value
        * (length if name in ("radius_i", "radius_j", "gap", "cylinder_radius") else 1)
        * (modulus if name.startswith("young") else 1)
        for name, value in values.items()
    }
    motion = np.diag([length**1.5] if load == "torsion" else [length**0.5, length**1.5])
    expected = modulus * motion @ matrix(Cell.from_values(**values), load, order=4) @ motion
    second = matrix(Cell.from_values(**scaled), load, order=4)
    np.testing.assert_allclose(second, expected, rtol=1e-8)


@pytest.mark.parametrize("load", ["normal", "torsion", "bending"])
@pytest.mark.parametrize("name", ["young_i", "young_j", "young_m"])
def test_stiffer_materials_make_every_motion_stiffer(load, name):
    """Every combination of the motions: the matrices' differences are positive definite."""
    ladder = np.geomspace(1e4, 1e10, 7)
    values = BASE | UNEQUAL | {"young_i": 3e7, "poisson_m": 0.3} | {name: ladder}
    cases = Cell.from_values(**values).ravel()
    materials = Materials.of(cases)
    solver = CellSolver(geometry_of(cases), find_load(load, "roller"), half=False, order=4)
    matrices = np.array([solver.stiffness_matrix(materials.constants(k)) for k in range(7)])
    scale = np.sqrt(np.diagonal(matrices[-1]))
    assert (np.linalg.eigvalsh(np.diff(matrices, axis=0) / np.outer(scale, scale)) > 0).all()


@pytest.mark.parametrize("load", OTHER_LOADS)
@pytest.mark.parametrize("changes", [{}, {"radius_j": 3e-3, "poisson_m": 0.5}])
def test_round_off_stays_small_for_stiff_particles(load, changes):
    """The rigid limit is approached as 1/ratio; anything else would be round-off."""
    ratios = np.array([1e8, 1e10, 1e12, np.inf])
    *stiff, rigid = (
        solve_level(cell(**changes, young_i=1.4e6 * ratio), 5, load=load).stiffness
        for ratio in ratios
    )
    deficit = (1 - np.array(stiff) / rigid) * ratios[:-1]
    assert deficit[0] > 0
    assert deficit[1] == pytest.approx(deficit[0], rel=0.05, abs=1e10 * 1e-9)
    assert abs(stiff[2] / rigid - 1) < 1e-9


@pytest.mark.parametrize("load", ["torsion", "bending"])
@pytest.mark.parametrize("nu", [0.4999999, 0.5])
def test_no_locking(load, nu):
    """As near to the limit in the order as elsewhere, and near to what is hardly compressible."""
    limit = matrix(cell(poisson_m=nu), load, half=True, order=10)
    coarse = matrix(cell(poisson_m=nu), load, half=True)
    np.testing.assert_allclose(coarse, limit, rtol=3e-5)
    softer = matrix(cell(poisson_m=0.4999), load, half=True)
    np.testing.assert_allclose(coarse, softer, rtol=5e-3)


def check_estimate(radius_ratio, load, tolerance):
    case = cell(radius_j=7.5e-3 * radius_ratio)
    answer = solve(case, load=load, tolerance=tolerance)
    finer = replace(LOADS[load, None].grading, growth=2.0)
    truth = solve_level(case, int(answer.order[0]) + 2, load=load, grading=finer).stiffness
    assert answer.status[0] == Status.ok
    assert abs(answer.stiffness[0] / truth - 1) <= answer.error_estimate[0] <= tolerance


@pytest.mark.parametrize(("radius_ratio", "load"), [(0.1, "torsion"), (0.4, "bending")])
def test_unequal_radii_meet_the_tolerance_within_the_estimate(radius_ratio, load):
    check_estimate(radius_ratio, load, tolerance=1e-3)


@pytest.mark.slow
@pytest.mark.parametrize("load", OTHER_LOADS)
@pytest.mark.parametrize("radius_ratio", [0.1, 0.4, 0.99])
def test_unequal_radii_meet_a_narrow_tolerance_within_the_estimate(radius_ratio, load):
    check_estimate(radius_ratio, load, tolerance=1e-6)


def test_nearly_equal_spheres_are_near_equal_spheres():
    nearly = cell(radius_j=7.5e-3 * (1 - 1e-7), cylinder_radius=9e-3)
    equal = matrix(cell(cylinder_radius=9e-3), half=True)
    np.testing.assert_allclose(matrix(nearly), equal, rtol=1e-6)
