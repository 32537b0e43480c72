"""Every load in three dimensions against the axisymmetric reference, at the rate of the mesh."""

from functools import cache

import numpy as np
import pytest
from skfem import Basis, BilinearForm, ElementTetP2, ElementVector, MeshTet2

from bondcell.cell import Cell
from bondcell.errors import InputError, UnsupportedLoad
from bondcell.fem.materials import Materials
from bondcell.fem.structured import CellSolver, find_load, geometry_of
from bondcell.fem.tet_mesh import MATRIX, PARTICLE_I, PARTICLE_J, Body, tet_mesh
from bondcell.fem.tet_stiffness import QUADRATURE_ORDER, element_matrices, strain_energy
from bondcell.fem.tetrahedra import TetrahedralSolver, solve_level

BASE = {
    "radius_i": 7.5e-3,
    "gap": 2.25e-3,
    "cylinder_radius": 9e-3,
    "young_i": 2.8e7,
    "young_m": 1.4e6,
    "poisson_i": 0.25,
    "poisson_m": 0.3,
}
CASES = {
    "equal": {},
    "unequal": {"radius_j": 4.5e-3, "young_j": 7e6, "poisson_j": 0.1},
    "soft": {"young_i": 1.4e5},
    "rigid": {"young_j": np.inf},
}


def cell(**changes):
    return Cell.from_values(**BASE | changes)


@cache
def reference(name, load):
    """Right to 1e-5, a hundredth of what it is compared with."""
    case = cell(**CASES[name]).ravel()
    geometry, materials = geometry_of(case), Materials.of(case)
    half = geometry.is_mirrored and bool(materials.is_mirrored[0])
    entry = find_load("bending" if load == "shear" else load, "roller")
    return CellSolver(geometry, entry, half, order=6).stiffness_matrix(materials.constants(0))


@cache
def solver(name, size):
    return TetrahedralSolver(cell(**CASES[name]), size)


def errors(name, size, load):
    """Relative errors: of one stiffness, or of shear, both couplings and bending."""
    return solver(name, size).stiffness_matrix(load) / reference(name, load) - 1


@pytest.mark.parametrize("load", ["normal", "torsion", "shear"])
@pytest.mark.parametrize("name", ["equal", "unequal"])
def test_coarse_meshes_approach_the_reference_from_above(name, load):
    coarse, finer = (errors(name, size, load) for size in (0.5, 0.35))
    assert (finer > 0).all()
    assert (finer < coarse / 1.5).all()
    assert (finer < 6e-3).all()


@pytest.mark.slow
@pytest.mark.parametrize("load", ["normal", "torsion", "shear"])
@pytest.mark.parametrize("name", CASES)
def test_halving_the_elements_leads_to_the_reference(name, load):
    """It lies below, by less than half of what the refinement gave: the order is at least 1.6.

    Smooth loads converge as h^4; the rims of held end planes make it less.
    """
    coarse, fine = (errors(name, size, load) for size in (0.35, 0.175))
    assert (fine > 0).all()
    assert (fine < (coarse - fine) / 2).all()
    assert (fine < 1.5e-3).all()


def test_element_matrices_are_the_form_s():
    grid = MeshTet2.init_ball(1)
    elements = np.arange(grid.nelements)
    basis = Basis(grid, ElementVector(ElementTetP2()), intorder=QUADRATURE_ORDER)
    form = BilinearForm(strain_energy).elemental(basis, lam=0.7, mu=1.3).tolocal()
    np.testing.assert_allclose(element_matrices(grid, elements, 0.7, 1.3), form, atol=1e-14)


def test_level_is_the_load_s_own_motion_and_scales_by_dimensions():
    large = {name: BASE[name] * 1e3 for name in ("radius_i", "gap", "cylinder_radius")}
    level = solve_level(cell(**large), 0.5, "bending")
    expected = solver("equal", 0.5).stiffness_matrix("shear")[1, 1] * 1e9
    assert level.stiffness == pytest.approx(expected, rel=1e-6)
    assert level.dof == solver("equal", 0.5).dof("bending")
    assert level.seconds > 0


def test_coupling_is_symmetric_and_that_of_a_symmetric_pair():
    """The mesh is not symmetric itself, hence within its error only."""
    (shear, one), (other, _) = solver("equal", 0.5).stiffness_matrix("shear")
    assert one == pytest.approx(other, rel=1e-6)
    assert one == pytest.approx(-shear * float(cell().length) / 2, rel=1e-3)


@pytest.mark.parametrize("poisson", [-0.5, 0.45])
def test_homogeneous_cylinder(poisson):
    case = cell(young_i=1.4e6, poisson_i=poisson, poisson_m=poisson)
    same = TetrahedralSolver(case, 0.5)
    radius, length = float(case.cylinder_radius), float(case.length)
    stretch, shear = np.pi * 1.4e6 * radius**2 / length, 1.4e6 / (2 * (1 + poisson))
    # The side of the cylinder is as round as second-order elements make it.
    assert same.stiffness("normal") == pytest.approx(stretch, rel=3e-4)
    twist = np.pi * shear * radius**4 / (2 * length)
    assert same.stiffness("torsion") == pytest.approx(twist, rel=6e-4)


@pytest.mark.parametrize("body", [Body(0.8, 0.8, 0.2), Body(0.3, 0.9, 0.1), Body(0.5, 0.3, 2.0)])
def test_mid_nodes_lie_on_the_spheres_and_materials_fill_their_volumes(body):
    mesh = tet_mesh(body, 0.5)
    for material, height, radius in body.spheres:
        surface = np.intersect1d(mesh.nodes_of(material), mesh.nodes_of(MATRIX))
        x, y, z = mesh.points[:, surface]
        distance = np.sqrt(x**2 + y**2 + (z - height) ** 2)
        np.testing.assert_allclose(distance, radius, rtol=1e-12)
    balls = {m: np.pi / 6 * radius**3 for m, _, radius in body.spheres}
    expected = balls | {MATRIX: np.pi / 4 * body.length - sum(balls.values())}
    determinant = mesh.grid.mapping().detDF(np.full((3, 1), 0.25))[:, 0]
    for material in (MATRIX, PARTICLE_I, PARTICLE_J):
        volume = determinant[mesh.material == material].sum() / 6
        assert volume == pytest.approx(expected[material], rel=0.02)


@pytest.mark.parametrize(
    ("changes", "size", "fields"),
    [
        ({"poisson_m": 0.5}, 0.5, ["poisson_m"]),
        ({"cylinder_radius": 7.5e-3}, 0.5, ["cylinder_radius"]),
        ({"poisson_i": 0.5}, 0.8, ["poisson_i", "poisson_j", "size"]),
        ({"gap": [1e-3, 2e-3]}, 0.5, ["cell"]),
    ],
)
def test_bad_input_names_every_field(changes, size, fields):
    with pytest.raises(InputError) as caught:
        solve_level(cell(**changes), size)
    assert [violation.field for violation in caught.value.violations] == fields


def test_unknown_load_is_refused():
    with pytest.raises(UnsupportedLoad, match="torsion"):
        solve_level(cell(), 0.5, "twist")
