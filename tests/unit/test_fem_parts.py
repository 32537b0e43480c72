"""The building blocks of the structured discretisation, each against its definition."""

import numpy as np
import pytest
from skfem import Basis
from skfem.element import ElementQuadP, ElementVector

from bondcell.fem.cell_basis import cell_basis, gauss_square
from bondcell.fem.cell_mesh import Geometry, Grading, build_cell_mesh
from bondcell.fem.curved_mapping import lagrange_tables, lobatto_points
from bondcell.fem.element_matrices import element_matrices
from bondcell.fem.forms import axial_bulk, axial_shear
from bondcell.fem.half_cell import MATRIX, PARTICLE_I
from bondcell.fem.numbering import Numbering
from bondcell.fem.orientation import orient
from bondcell.fem.strain import AXIAL
from bondcell.fem.substructure import bulk_to_shear

GEOMETRIES = [
    Geometry(1.0, 1.0, 1 / 15, 1.0),
    Geometry(1.0, 1.0, 1e-4, 1.0),
    Geometry(1.0, 0.3, 0.01, 1.0),
    Geometry(1.0, 1.0, 4.0, 2.5),
    Geometry(0.02, 1.0, 0.5, 1.1),
    Geometry(1.0, 0.999999, 0.1, 1.0),
]


def test_lagrange_polynomials_reproduce_polynomials_and_their_derivatives():
    at = np.linspace(0, 1, 17)
    for order in (1, 3, 8, 14):
        values, derivatives = lagrange_tables(order, at)
        nodal = lobatto_points(order) ** order
        assert np.allclose(nodal @ values, at**order, atol=1e-13)
        assert np.allclose(nodal @ derivatives, order * at ** (order - 1), atol=1e-11)


@pytest.mark.parametrize("geometry", GEOMETRIES)
def test_mesh_volumes_are_those_of_spheres_and_cylinder(geometry):
    mesh = build_cell_mesh(geometry, Grading(foot=1e-4), half=False)
    order = 12
    basis = cell_basis(mesh.topology, mesh.mapping(order), order)
    volume = (2 * np.pi * basis.global_coordinates()[0] * basis.dx).sum(axis=1)
    hemispheres = 2 / 3 * np.pi * np.array([geometry.radius_i, geometry.radius_j]) ** 3
    length = geometry.radius_i + geometry.radius_j + geometry.gap
    total = np.pi * geometry.cylinder_radius**2 * length
    assert volume[mesh.region == PARTICLE_I].sum() == pytest.approx(hemispheres[0], rel=1e-10)
    assert volume[mesh.region > PARTICLE_I].sum() == pytest.approx(hemispheres[1], rel=1e-10)
    matrix = total - hemispheres.sum()
    assert volume[mesh.region == MATRIX].sum() == pytest.approx(matrix, rel=1e-9)


@pytest.mark.parametrize("geometry", GEOMETRIES)
@pytest.mark.parametrize("corner", [0.0, 1e-5])
def test_mesh_is_conforming_and_closed(geometry, corner):
    mesh = build_cell_mesh(geometry, Grading(corner=corner), half=False)
    topology = mesh.topology
    edges, vertices = topology.facets.shape[1], topology.p.shape[1]
    assert vertices - edges + topology.nelements == 1
    named = np.concatenate(list(mesh.boundary.values()))
    unnamed = np.setdiff1d(topology.boundary_facets(), named)
    # Only where the cusp is cut off, at the foot of a sphere that touches the lateral surface.
    r, z = topology.p[:, np.unique(topology.facets[:, unnamed])]
    below_i = z + geometry.radius_i + geometry.gap / 2
    above_j = geometry.radius_j + geometry.gap / 2 - z
    assert (r > geometry.cylinder_radius * (1 - 1e-5)).all()
    assert (np.minimum(below_i, above_j) <= 2.1e-3 * geometry.cylinder_radius).all()
    assert np.unique(topology.p.round(14), axis=1).shape[1] == vertices


def test_neighbouring_elements_agree_on_their_common_edge():
    mesh = build_cell_mesh(GEOMETRIES[2], Grading(), half=False)
    order = 6
    scalar = ElementQuadP(order)
    mapping = mesh.mapping(order)
    basis = Basis(mesh.topology, scalar, mapping=mapping, quadrature=gauss_square(9))
    t = np.linspace(0, 1, 9)
    sides = [(t, 0 * t), (0 * t + 1, t), (t, 0 * t + 1), (0 * t, t)]
    rng = np.random.default_rng(1)
    coefficients = rng.standard_normal(basis.N)
    seen = {}
    for local, (x, y) in enumerate(sides):
        points = np.array([x, y])
        shapes = np.array([scalar.lbasis(points, k)[0] for k in range((order + 1) ** 2)])
        value = coefficients[basis.element_dofs].T @ shapes
        place = mapping.F(points)
        for element, edge in enumerate(mesh.topology.t2f[local]):
            trace = np.array([*place[:, element], value[element]])
            if edge in seen:
                assert np.allclose(trace, seen[edge], atol=1e-12)
            seen[edge] = trace


def test_orientation_gives_shared_edges_one_direction():
    quads = np.array([[0, 1, 2, 3], [2, 1, 4, 5], [6, 3, 2, 5]])
    start = {}
    for a, b, c, d in orient(quads):
        for tail, head in ((a, b), (b, c), (d, c), (a, d)):
            assert start.setdefault(frozenset((tail, head)), tail) == tail


@pytest.mark.parametrize("order", [3, 5])
def test_batched_matrices_equal_the_forms(order):
    mesh = build_cell_mesh(GEOMETRIES[0], Grading(foot=0.1), half=True)
    mapping = mesh.mapping(order)
    scalar = cell_basis(mesh.topology, mapping, order)
    vector = Basis(
        mesh.topology,
        ElementVector(ElementQuadP(order)),
        mapping=mapping,
        quadrature=(scalar.X, scalar.W),
    )
    matrices = element_matrices(scalar.points, AXIAL, projected=False)
    bulk = matrices.bulk_root.transpose(0, 2, 1) @ matrices.bulk_root
    # The vector element numbers components fastest; the batched matrices cut off what is inside.
    numbering = Numbering(mesh, scalar, 2)
    place = np.argsort(np.concatenate((numbering.inner, numbering.outer)))
    swap = place.reshape(2, (order + 1) ** 2).T.ravel()
    for batched, form in ((matrices.shear, axial_shear), (bulk, axial_bulk)):
        local = form.elemental(vector).tolocal()
        assert np.allclose(batched[:, swap[:, None], swap], local, rtol=0, atol=1e-12 * local.max())


def test_projection_only_removes_dilatation():
    mesh = build_cell_mesh(GEOMETRIES[0], Grading(foot=0.1), half=True)
    basis = cell_basis(mesh.topology, mesh.mapping(5), 5)
    roots = [
        element_matrices(basis.points, AXIAL, projected).bulk_root for projected in (True, False)
    ]
    projected, full = (root.transpose(0, 2, 1) @ root for root in roots)
    scale = np.abs(full).max(axis=(1, 2))
    assert (np.linalg.eigvalsh(full - projected).min(axis=1) > -1e-12 * scale).all()
    mean = [root[:, 0] for root in roots]
    assert np.allclose(np.abs(mean[0]), np.abs(mean[1]), atol=1e-12)


def test_ratio_of_bulk_and_shear_modulus():
    assert bulk_to_shear(0.5) == np.inf
    assert bulk_to_shear(0.0) == pytest.approx(2 / 3)
    assert bulk_to_shear(0.25) == pytest.approx(5 / 3)


def test_elements_of_order_two_are_silent(capfd):
    from bondcell.cell import Cell
    from bondcell.fem.reference import solve

    cell = Cell.from_values(
        radius_i=7.5e-3, gap=5e-4, young_i=3e10, young_m=1.4e6, poisson_i=0.25, poisson_m=0.46
    )
    solve(cell.ravel(), tolerance=1e-2)
    assert capfd.readouterr() == ("", "")
