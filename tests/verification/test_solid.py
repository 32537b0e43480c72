"""Particles in a matrix in three dimensions, against exact fields and direct solutions."""

from functools import cache

import numpy as np
import pytest
from scipy.sparse import csc_array, csr_array
from scipy.sparse.linalg import splu
from skfem import MeshTet2

from bondcell.errors import InputError
from bondcell.fem import tet_stiffness
from bondcell.fem.krylov import conjugate_gradients
from bondcell.lattice.packing import packing
from bondcell.lattice.rigid_modes import rigid_modes
from bondcell.solid.elastic import solve_elastic
from bondcell.solid.elements import (
    element_matrices,
    lattice_of,
    physical_gradients,
    quadrature,
    reference_nodes,
    shape_gradients,
    shape_values,
)
from bondcell.solid.layer_cells import Layer, triangle_energies
from bondcell.solid.memory import check_memory
from bondcell.solid.moduli import elastic_of, moduli_family
from bondcell.solid.multigrid import PMultigrid
from bondcell.solid.particles import mean_motions, rigid_motions
from bondcell.solid.raise_order import raise_order
from bondcell.solid.rigid import condense
from bondcell.solid.size_field import size_field
from bondcell.solid.sphere_mesh import sphere_mesh
from bondcell.solid.stiffness import Elastic, assemble
from bondcell.solid.tets import MATRIX, second_order
from bondcell.solid.wall_margin import wall_stiffness

SOFT, STIFF = Elastic(1.4, 0.46), Elastic(3e4, 0.25)
CENTRES = [[-1.25, 1.9, 0], [1.25, 1.9, 0], [0, 0, 0]]
BOX = [[-2.6, 2.6], [0, 3.3], [0, 1.4]]


def three():
    return packing(CENTRES, 1.0, BOX)


@cache
def mesh(per_gap=2.0):
    return sphere_mesh(three(), per_gap)


def supports(own):
    held = np.zeros((len(own.points), 3), dtype=bool)
    held[own.on_plane(1, 0.0)] = True
    held[own.on_plane(2, 0.0), 2] = True
    return held


def eliminate(matrix, right):
    factors = splu(
        csc_array(matrix),
        permc_spec="MMD_AT_PLUS_A",
        diag_pivot_thresh=0.0,
        options={"SymmetricMode": True},
    )
    return factors.solve(right)


@cache
def condensed(tolerance=1e-9):
    return condense(mesh(), three(), SOFT, supports(mesh()), keep_fields=True, tolerance=tolerance)


@cache
def elastic(young=STIFF.young):
    cases = np.array([[1e-2, 0.0], [0.0, 1e-2]])
    return solve_elastic(
        mesh(), three(), SOFT, Elastic(young, 0.25), supports(mesh()), np.array([0]), cases, 1e-8
    )


@pytest.mark.parametrize("order", [1, 2, 3, 4])
def test_shape_functions(order):
    nodes = reference_nodes(order)
    np.testing.assert_allclose(shape_values(nodes, order), np.eye(len(nodes)), atol=1e-14)
    points = np.random.default_rng(0).dirichlet(np.ones(4), 5)[:, 1:]
    values = shape_values(points, order)
    np.testing.assert_allclose(values @ (nodes**order), points**order, atol=1e-14)
    step = 1e-6
    for axis in range(3):
        shift = step * np.eye(3)[axis]
        more, less = (shape_values(points + side * shift, order) for side in (1, -1))
        slope = (more - less) / (2 * step)
        np.testing.assert_allclose(shape_gradients(points, order)[:, :, axis], slope, atol=1e-8)
    linear = np.concatenate([1 - points.sum(axis=1, keepdims=True), points], axis=1)
    np.testing.assert_allclose(values @ lattice_of(order) / order, linear, atol=1e-14)


def test_element_matrices_are_the_form_s():
    grid = MeshTet2.init_ball(1)
    nodes = grid.dofs.element_dofs.T
    points, weights = quadrature(tet_stiffness.QUADRATURE_ORDER)
    corners = grid.doflocs.T[nodes]
    gradients, volumes = physical_gradients(corners, shape_gradients(points), weights)
    lam, mu = np.full((2, len(nodes)), [[0.7], [1.3]])
    form = tet_stiffness.element_matrices(grid, np.arange(len(nodes)), 0.7, 1.3)
    np.testing.assert_allclose(element_matrices(gradients, abs(volumes), lam, mu), form, atol=1e-13)


def test_mid_nodes_lie_on_the_spheres_and_materials_fill_their_volumes():
    own = mesh()
    points, weights = quadrature(5)
    _, volumes = physical_gradients(own.points[own.nodes], shape_gradients(points), weights)
    volume = volumes.sum(axis=1)
    ball = 4 / 3 * np.pi
    for particle, share in enumerate((0.5, 0.5, 0.25)):
        inside = own.material == particle
        surface = np.intersect1d(own.nodes[inside], own.nodes[own.material == MATRIX])
        distance = np.linalg.norm(own.points[surface] - CENTRES[particle], axis=1)
        np.testing.assert_allclose(distance, 1, rtol=1e-9)
        assert volume[inside].sum() == pytest.approx(share * ball, rel=2e-3)
    assert volume.sum() == pytest.approx(np.ptp(BOX, axis=1).prod(), rel=1e-9)


def test_mesh_is_the_same_every_time():
    again = sphere_mesh(three(), 2.0)
    np.testing.assert_array_equal(again.points, mesh().points)


def test_expected_elements_are_about_right():
    for per_gap in (2.0, 0.7):
        expected = size_field(three(), per_gap, 0.4).elements
        assert 0.5 < expected / len(mesh(per_gap).nodes) < 2.5


def test_rigid_motions_cost_nothing():
    own = mesh()
    modes = rigid_modes(own.points, rotates=True)[:, :3].reshape(-1, 6)
    stiffness = assemble(own, SOFT, STIFF)
    for matrix, part in (
        (stiffness.fine, modes),
        # A rotation is not linear on a curved element.
        (stiffness.coarse, modes[: 3 * own.corners, :3]),
    ):
        np.testing.assert_allclose(matrix @ part, 0, atol=1e-7 * abs(matrix.data).max() / 1e3)
        np.testing.assert_allclose((matrix - matrix.T).data, 0, atol=1e-10 * STIFF.young)


@pytest.mark.parametrize("order", [3, pytest.param(4, marks=pytest.mark.slow)])
def test_higher_orders_fill_the_balls_better_and_are_softer(order):
    own, ball = raise_order(mesh(), order, three()), 4 / 3 * np.pi
    points, weights = quadrature(7)
    _, volumes = physical_gradients(own.points[own.nodes], shape_gradients(points, order), weights)
    volume = volumes.sum(axis=1)
    for particle, share in enumerate((0.5, 0.5, 0.25)):
        inside = own.material == particle
        surface = np.intersect1d(own.nodes[inside], own.nodes[own.material == MATRIX])
        distance = np.linalg.norm(own.points[surface] - CENTRES[particle], axis=1)
        np.testing.assert_allclose(distance, 1, rtol=1e-9)
        assert volume[inside].sum() == pytest.approx(share * ball, rel=1e-4)
    assert volume.sum() == pytest.approx(np.ptp(BOX, axis=1).prod(), rel=1e-9)
    way = np.array([[1e-2, 0.0]])
    lower = raise_order(mesh(), order - 1, three())
    finer, rough = (
        solve_elastic(grid, three(), SOFT, STIFF, supports(grid), np.array([0]), way).energy[0]
        for grid in (own, lower)
    )
    assert 0.9 * rough < finer < 0.998 * rough


def test_orders_that_are_not_offered():
    assert refusal(raise_order, mesh(), 5, three()) == ["order"]


def test_layer_of_the_specimen():
    """Fourth-order elements of half the gap give 73.98, 31.06, 8.481 and 4.638 J."""
    layer = Layer(7.5e-3, 0.5e-3, 18e-3, Elastic(1.4e6, 0.46))
    found = triangle_energies(layer, 2.0)
    assert found.dilation == pytest.approx(73.98, rel=1e-2)
    assert found.deviator == pytest.approx(31.06, rel=1e-2)
    assert found.turn == pytest.approx(8.481, rel=2e-3)
    assert found.twist == pytest.approx(4.638, rel=5e-3)


def test_wall_beside_one_sphere():
    """Stiff across, softer along; the farther the less. The sphere hangs over the bottom."""

    def beside(distance):
        box = [[-1.3, distance], [0, 2.6], [0, 1.3]]
        found, moving = wall_stiffness(packing([[0, 1.3, 0]], 1.0, box), SOFT, 1, [2], 1.0)
        assert moving.tolist() == [0]
        return found

    near, far = beside(1.3), beside(1.8)
    for found in (near, far):
        assert np.linalg.eigvalsh(found).min() > -1e-6 * found.max()
        assert found[0, 0] > found[1, 1] > 0
    assert (np.diag(far) < 0.7 * np.diag(near)).all()


def test_coarse_matrix_is_the_fine_one_on_linear_functions():
    own = mesh()
    stiffness = assemble(own, SOFT, SOFT)
    solver = PMultigrid(own, stiffness, np.zeros((len(own.points), 3), dtype=bool))
    coarse = np.random.default_rng(1).normal(size=(3 * own.corners, 2))
    fine = solver.extend(coarse)
    expected = solver.restrict(stiffness.fine @ fine)
    np.testing.assert_allclose(stiffness.coarse @ coarse, expected, atol=1e-11)


@pytest.mark.parametrize("order", [2, 3, pytest.param(4, marks=pytest.mark.slow)])
def test_patch(order):
    """One material everywhere: a linear field on the border is the field inside."""
    own = raise_order(mesh(), order, three())
    strain = np.random.default_rng(2).normal(size=(3, 3))
    affine = own.points @ strain
    held = np.zeros_like(affine, dtype=bool)
    for axis, walls in enumerate(BOX):
        for wall in walls:
            held[own.on_plane(axis, wall)] = True
    stiffness = assemble(own, SOFT, SOFT)
    solver = PMultigrid(own, stiffness, held)
    start = np.where(held, affine, 0.0).reshape(-1, 1)
    free = solver.free[:, None]
    step, iterations = conjugate_gradients(
        lambda x: (stiffness.fine @ x) * free, solver, -(stiffness.fine @ start) * free, 1e-12
    )
    assert iterations < {2: 40, 3: 60, 4: 100}[order]
    np.testing.assert_allclose((start + step).reshape(-1, 3), affine, atol=1e-9)


def test_means_of_rigid_motions_are_those_motions():
    functionals = mean_motions(mesh(), three()).reshape(-1, 9)
    every = np.zeros((len(mesh().points), 3, 9))
    for k, centre in enumerate(np.array(CENTRES)):
        arm = mesh().points - centre
        every[:, 0, 3 * k] = every[:, 1, 3 * k + 1] = 1
        every[:, 0, 3 * k + 2], every[:, 1, 3 * k + 2] = -arm[:, 1], arm[:, 0]
    found = functionals.T @ every.reshape(-1, 9)
    for k in range(3):
        own = slice(3 * k, 3 * k + 3)
        np.testing.assert_allclose(found[own, own], np.eye(3), atol=1e-12)


def test_condensed_is_the_direct_solution():
    """All free nodes and the particles' motions as one system, eliminated directly."""
    own, held = mesh(), supports(mesh())
    part, nodes = own.part(own.material == MATRIX)
    matrix = csr_array(assemble(part, SOFT, None).fine)
    motions = csr_array(rigid_motions(part, three(), np.array([0, 1])))
    fixed = held[nodes].ravel()
    inside = np.isin(nodes, np.unique(own.nodes[own.material != MATRIX]))
    free = np.flatnonzero(~(fixed | np.repeat(inside, 3)))
    inner, mixed = matrix[free][:, free], (matrix @ motions)[free].toarray()
    direct = (motions.T @ matrix @ motions).toarray() - mixed.T @ eliminate(inner, mixed)
    found = condensed()
    assert found.moving.tolist() == [0, 1]
    np.testing.assert_allclose(found.stiffness, direct, atol=1e-8 * direct.max())
    rough = condensed(1e-3)
    assert np.linalg.eigvalsh(rough.stiffness - direct).min() > -1e-8 * direct.max()
    np.testing.assert_allclose(rough.stiffness, direct, atol=1e-3 * direct.max())


def test_condensed_field_has_the_condensed_energy():
    found = condensed()
    part, _ = mesh().part(mesh().material == MATRIX)
    matrix = assemble(part, SOFT, None).fine
    energy = found.fields.T @ (matrix @ found.fields)
    np.testing.assert_allclose(energy, found.stiffness, atol=1e-8 * energy.max())


def test_condensed_symmetry_and_balance():
    """Mirror images of each other but for the mesh; twice the energy is force times way."""
    stiffness = condensed().stiffness
    mirror = np.kron([[0, 1], [1, 0]], np.diag([-1, 1, -1]))
    np.testing.assert_allclose(mirror @ stiffness @ mirror, stiffness, atol=0.03 * stiffness.max())
    way = np.array([0.01, 0.02])
    motion, forces, energy = condensed().solve(np.array([0]), way)
    np.testing.assert_allclose(motion[0, :2], way)
    np.testing.assert_allclose(forces[1], 0, atol=1e-12)
    assert 2 * energy == pytest.approx(forces[0, :2] @ way, rel=1e-10)
    assert motion[1, 0] > 0


def test_elastic_is_the_saddle_point():
    own, held = mesh(), supports(mesh())
    free = np.flatnonzero(~held.ravel())
    matrix = csr_array(assemble(own, SOFT, STIFF).fine)[free][:, free]
    means = csr_array(mean_motions(own, three())[free, 0, :2])
    compliance = means.T @ (fields := eliminate(matrix, means.toarray()))
    forces = 1e-2 * np.linalg.inv(compliance)
    expected = 1e-2 * np.diag(forces) / 2
    found = elastic()
    np.testing.assert_allclose(found.energy, expected, rtol=1e-7)
    field = found.field.reshape(-1, 2)[free]
    np.testing.assert_allclose(field, fields @ forces, atol=1e-6 * abs(field).max())
    np.testing.assert_allclose(found.motion[0, :2], 1e-2 * np.eye(2), atol=1e-12)


def test_elastic_particles_are_softer_than_rigid_ones_and_tend_to_them():
    rigid = [condensed().solve(np.array([0]), way)[2] for way in 1e-2 * np.eye(2)]
    soft, stiff = (elastic(young).energy / rigid for young in (30.0, 3e4))
    assert (soft < 0.97).all()
    assert ((stiff < 1) & (stiff > 0.999)).all()


def refusal(call, *arguments, **more):
    with pytest.raises(InputError) as caught:
        call(*arguments, **more)
    return [violation.field for violation in caught.value.violations]


def test_bad_input_is_refused_before_the_work():
    assert refusal(sphere_mesh, three(), 3.0, 0.9) == ["per_gap", "largest"]
    assert refusal(sphere_mesh, packing(CENTRES, 1.0), 1.0) == ["box"]
    assert refusal(sphere_mesh, three(), 0.05, memory=1e9) == ["elements"]
    assert refusal(check_memory, 10**9, 1e9) == ["elements"]
    assert refusal(Elastic, -1.0, 0.5) == ["young", "poisson"]


def test_inverted_element_is_refused():
    """A ball that its flat facets do not follow."""
    corners = np.array([[0.0, 0, 1], [0.1, 0, 0.99], [0, 0.1, 0.99], [0.02, 0.02, 1.001]])
    corners[:3] /= np.linalg.norm(corners[:3], axis=1, keepdims=True)
    inner = np.vstack([corners, [[0.0, 0, 0]]])
    cells = np.array([[0, 1, 2, 4], [0, 1, 2, 3]])
    ball = packing([[0.0, 0, 0]], 1.0)
    from bondcell.errors import BondcellError

    with pytest.raises(BondcellError, match="inside out"):
        second_order(inner, cells, np.array([0, MATRIX]), ball)


def test_family_of_moduli_meets_solutions_it_has_not_seen():
    family = moduli_family(
        mesh(), three(), supports(mesh()), np.array([0.6, 0.2, 0.06, 0.02]), 1e-7
    )
    for ratio in (0.6, 0.25, 0.05):
        own = elastic_of(1.7, 1.7 * ratio)
        direct = condense(mesh(), three(), own, supports(mesh()), tolerance=1e-7).stiffness
        found = family.at(1.7, 1.7 * ratio).stiffness
        np.testing.assert_allclose(found, direct, atol=3e-4 * direct.max())
        assert np.linalg.eigvalsh(found - direct).min() > -1e-8 * direct.max()
    np.testing.assert_allclose(
        family.at(2.0, 1.2).stiffness, 2 * family.at(1.0, 0.6).stiffness, rtol=1e-9, atol=1e-12
    )
