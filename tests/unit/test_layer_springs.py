"""Pockets and border bonds return the energies of the cells that they were taken from."""

import numpy as np
import pytest

from bondcell.lattice.bonds import bonds
from bondcell.lattice.lattice import lattice
from bondcell.lattice.pockets import pockets, triangles
from bondcell.lattice.solve import solve
from bondcell.solid.layer_cells import BorderEnergies, TriangleEnergies
from bondcell.solid.layer_springs import PairSprings, border_bond, pocket_springs

LENGTH = 2.0
BOND = PairSprings(3.0, 1.0, 0.7)
TRIANGLE = TriangleEnergies(dilation=30.0, deviator=11.0, turn=5.0, twist=3.0)
HEIGHT = np.sqrt(3) / 2 * LENGTH


@pytest.mark.parametrize(
    ("strain", "turns", "energy"),
    [
        ([1, 1], [0, 0, 0], TRIANGLE.dilation),
        ([1, -1], [0, 0, 0], TRIANGLE.deviator),
        ([0, 0], [1, 1, 1], TRIANGLE.turn),
        ([0, 0], [1, 1, -1], TRIANGLE.twist),
    ],
)
def test_triangle_with_half_of_its_bonds(strain, turns, energy):
    corners = np.array([[0, 0], [LENGTH, 0], [LENGTH / 2, HEIGHT]])
    pairs = [[0, 1], [1, 2], [0, 2]]
    half = bonds(pairs, BOND.normal / 2, BOND.shear / 2, BOND.bending / 2)
    own = lattice(corners, half, pockets([[0, 1, 2]], **pocket_springs(TRIANGLE, BOND, LENGTH)))
    motion = np.column_stack([corners * strain, turns])
    assert 2 * solve(own, True, motion).energy == pytest.approx(energy, rel=1e-12)


def test_row_at_a_border():
    """The work on one sphere while all of the row move."""
    pocket = pocket_springs(TRIANGLE, BOND, LENGTH)
    border = BorderEnergies(np.array([[60.0, 2.0], [2.0, 14.0]]), 12.0)
    found = border_bond(border, BOND, pocket, LENGTH)
    row, below = LENGTH * np.arange(-2, 3), LENGTH * np.arange(-1.5, 2)
    heights = np.repeat([0, -HEIGHT], [5, 4])
    points = np.column_stack([np.concatenate([row, below]), heights])
    distance = np.linalg.norm(points[:, None] - points, axis=2)
    pairs = np.argwhere(np.triu((distance > 0) & (distance < 1.1 * LENGTH)))
    in_row = (pairs < 5).all(axis=1)
    # The way goes to the right along the row: away from the layer is to the left.
    values = {
        name: np.where(in_row, getattr(found, name), getattr(BOND, name))
        for name in ("normal", "shear", "bending", "offset")
    }
    own = lattice(points, bonds(pairs, **values), pockets(triangles(pairs, 9), **pocket))
    motions = np.zeros((9, 3, 3))
    motions[:5, 0, 0] = motions[:5, 2, 1] = [1, -1, 1, -1, 1]
    motions[:5, 2, 2] = 1
    force = (own.matrix() @ motions.reshape(-1, 3)).reshape(9, 3, 3)[2]
    np.testing.assert_allclose(force[[0, 2], :2], border.alternate, atol=1e-12)
    assert force[2, 2] == pytest.approx(border.turn)
