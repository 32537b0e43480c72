"""Files for ParaView hold what was computed."""

import meshio
import numpy as np

from bondcell.lattice.bonds import bonds
from bondcell.lattice.lattice import lattice
from bondcell.lattice.packing import packing
from bondcell.lattice.solve import solve
from bondcell.solid.tets import MATRIX, second_order
from bondcell.specimen.vtk import write_lattice, write_solid


def test_solid(tmp_path):
    points = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 1]])
    cells = np.array([[0, 1, 2, 3], [1, 2, 3, 4]])
    mesh = second_order(points, cells, np.array([MATRIX, MATRIX]), packing([[5.0, 5, 5]], 1.0))
    field = mesh.points @ np.diag([0.1, 0.2, 0.3])
    write_solid(tmp_path / "solid.vtu", mesh, field)
    read = meshio.read(tmp_path / "solid.vtu")
    np.testing.assert_allclose(read.points, mesh.points)
    np.testing.assert_allclose(read.point_data["displacement"], field)
    assert read.cells_dict["tetra10"].tolist() == mesh.nodes.tolist()
    assert read.cell_data["particle"][0].tolist() == [0, 0]
    # A mid-node of the format lies between the corners it belongs to.
    pairs = [(0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)]
    corners = read.points[read.cells_dict["tetra10"]]
    for k, (a, b) in enumerate(pairs):
        np.testing.assert_allclose(corners[:, 4 + k], (corners[:, a] + corners[:, b]) / 2)


def test_lattice(tmp_path):
    own = lattice([[0, 0], [1, 0], [1, 1]], bonds([[0, 1], [1, 2]], 2.0, 1.0, 1.0))
    held = np.array([[True] * 3, [False] * 3, [True] * 3])
    found = solve(own, held, [[0, 0, 0], [0, 0, 0], [0.1, 0.2, 0]])
    write_lattice(tmp_path / "lattice.vtu", own, found)
    read = meshio.read(tmp_path / "lattice.vtu")
    np.testing.assert_allclose(read.points[:, :2], own.points + found.motion[:, :2])
    np.testing.assert_allclose(read.cell_data["normal_force"][0], found.bond_forces[:, 0])
    assert read.cells_dict["line"].tolist() == [[0, 1], [1, 2]]
    np.testing.assert_allclose(read.point_data["rotation"].ravel(), found.motion[:, 2])
