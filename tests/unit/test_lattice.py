"""Lattices: bonds, pockets, equilibrium, energies; what is refused."""

import numpy as np
import pytest

from bondcell.errors import InputError
from bondcell.lattice.bonds import bonds
from bondcell.lattice.lattice import lattice
from bondcell.lattice.packing import packing
from bondcell.lattice.pockets import pockets, triangles
from bondcell.lattice.rigid_modes import rigid_modes
from bondcell.lattice.solve import solve
from bondcell.lattice.specimen_geometry import GAP, RADIUS, specimen_packing
from bondcell.lattice.walls import wall


def random_lattice(dimension, seed=0, **changes):
    """Nodes joined to all that are near, with springs of all kinds and pockets."""
    rng = np.random.default_rng(seed)
    points = rng.uniform(0, 1, (14, dimension))
    distance = np.linalg.norm(points[:, None] - points[None], axis=2)
    pairs = np.argwhere(np.triu(distance < 0.75, 1))
    draw = {
        name: rng.uniform(0.5, 2, len(pairs)) for name in ("normal", "shear", "bending", "torsion")
    }
    own = bonds(pairs, pivot=rng.uniform(0.3, 0.7, len(pairs)), **draw | changes)
    corners = triangles(pairs, len(points))[:6]
    return lattice(points, own, pockets(corners, 0.3, -0.01, -0.02, 0.05))


def specimen(own, **more):
    centres = specimen_packing().centres[:, :2]
    return lattice(centres, own, **more)


def supports(own, axis=0, distance=5e-4):
    held, values = np.zeros((2, own.count, own.width))
    held[11:18], held[:3, :2] = 1, 1
    values[:3, axis] = distance
    return held.astype(bool), values


@pytest.mark.parametrize("dimension", [2, 3])
def test_rigid_motions_cost_nothing(dimension):
    own = random_lattice(dimension)
    modes = rigid_modes(own.points, own.rotates).reshape(own.count * own.width, -1)
    matrix = own.matrix().toarray()
    np.testing.assert_allclose(matrix @ modes, 0, atol=1e-11)
    np.testing.assert_allclose(matrix, matrix.T, atol=1e-13)
    values = np.linalg.eigvalsh(matrix)
    assert np.count_nonzero(values < 1e-9) == modes.shape[1]


@pytest.mark.parametrize("dimension", [2, 3])
def test_uniform_strain_of_equal_springs_is_followed(dimension):
    """Patch test: a regular grid under a displacement of its border moves affinely inside."""
    axes = [np.arange(4.0)] * dimension
    points = np.stack(np.meshgrid(*axes, indexing="ij"), -1).reshape(-1, dimension)
    distance = np.linalg.norm(points[:, None] - points[None], axis=2)
    pairs = np.argwhere(np.triu(distance < 1.5, 1))
    own = lattice(points, bonds(pairs, 1 / distance[tuple(pairs.T)]))
    strain = np.random.default_rng(1).normal(size=(dimension, dimension))
    affine = points @ (strain + strain.T)
    border = ((points == 0) | (points == 3)).any(axis=1)
    held = np.broadcast_to(border[:, None], affine.shape)
    found = solve(own, held, np.where(held, affine, 0.0))
    np.testing.assert_allclose(found.motion, affine, atol=1e-12)


def test_two_particles_are_the_bond():
    """Each load of the bond cell on a lattice of two nodes gives that cell's stiffness."""
    length, normal, shear, torsion, pure = 0.0155, 1.6e5, 3e4, 0.5, 0.8
    pair = lattice([[0, 0, 0], [0, 0, length]], bonds([[0, 1]], normal, shear, pure, torsion))
    held = np.ones((2, 6), bool)

    def moved(unknown):
        values = np.zeros((2, 6))
        values[1, unknown] = 1.0
        return solve(pair, held, values)

    bending = pure + shear * length**2 / 4
    expected = {0: shear, 1: shear, 2: normal, 3: bending, 4: bending, 5: torsion}
    for unknown, stiffness in expected.items():
        assert 2 * moved(unknown).energy == pytest.approx(stiffness, rel=1e-12)
    # The force across the axis for a unit rotation is K_s L / 2.
    tilted = moved(4).reactions[1]
    assert abs(tilted[0]) == pytest.approx(shear * length / 2, rel=1e-12)


def test_pivot_moves_the_coupling():
    for pivot in (0.0, 0.25, 1.0):
        pair = lattice([[0, 0], [2, 0]], bonds([[0, 1]], 5.0, 3.0, 1.0, pivot=pivot))
        turned = solve(pair, True, [[0, 0, 0], [0, 0, 1.0]])
        assert turned.reactions[1, 2] == pytest.approx(1.0 + 3.0 * (2 * (1 - pivot)) ** 2)
        assert turned.reactions[1, 1] == pytest.approx(-3.0 * 2 * (1 - pivot))


@pytest.mark.parametrize("dimension", [2, 3])
def test_energy_balance_and_equilibrium(dimension):
    own = random_lattice(dimension, seed=3)
    held = np.zeros((own.count, own.width), bool)
    held[:3] = True
    values = np.random.default_rng(4).normal(size=held.shape)
    found = solve(own, held, values)
    work = (found.reactions * np.where(held, values, 0)).sum()
    assert 2 * found.energy == pytest.approx(work, rel=1e-10)
    modes = rigid_modes(own.points, own.rotates)
    np.testing.assert_allclose(np.einsum("nw,nwm->m", found.reactions, modes), 0, atol=1e-10)


def test_ground_springs_share_the_load():
    own = lattice([[0, 0], [1, 0]], bonds([[0, 1]], 2.0), ground=[[3.0, 1.0], [0.0, 1.0]])
    found = solve(own, [[False, False], [True, False]], [[0, 0], [1.0, 0]])
    assert found.motion[0, 0] == pytest.approx(2 / 5)
    assert found.energies["ground"] == pytest.approx(0.5 * 3 * (2 / 5) ** 2)
    assert found.energy == pytest.approx(0.5 * 6 / 5)


def test_pocket_is_the_change_of_area():
    corners = np.array([[0.0, 0.0], [1.0, 0.0], [0.3, 0.8]])
    own = lattice(corners, bonds([[0, 1]], 0.0), pockets([[0, 1, 2]], 7.0))
    step = 1e-6 * np.random.default_rng(0).normal(size=(3, 2))

    def area(p):
        (a, b), (c, d) = p[1] - p[0], p[2] - p[0]
        return (a * d - b * c) / 2

    change = (area(corners + step) - area(corners - step)) / (2 * area(corners))
    assert own.pocket_strains()[0, 0] @ step.ravel() == pytest.approx(change, rel=1e-8)
    motion = step.ravel()
    energy = motion @ own.matrix().toarray() @ motion / 2
    assert energy == pytest.approx(7.0 * change**2 / 2, rel=1e-8)
    strain = np.array([[3.0, 0.5], [0.5, -1.0]])
    both = lattice(corners, own.bonds, pockets([[0, 1, 2]], 7.0, -2.0))
    motion = (corners @ strain).ravel()
    expected = (7.0 * 2**2 - 2.0 * (4**2 + 1**2)) / 2
    assert motion @ both.matrix().toarray() @ motion / 2 == pytest.approx(expected)
    motion = step.ravel()
    flat = lattice(np.pad(corners, ((0, 0), (0, 1))), own.bonds, own.pockets)
    space = np.pad(step, ((0, 0), (0, 1))).ravel()
    assert space @ flat.matrix().toarray() @ space / 2 == pytest.approx(energy, rel=1e-12)


def test_specimen_has_the_paper_s_counts():
    packed = specimen_packing()
    pairs = packed.neighbours(1e-3)
    np.testing.assert_allclose(packed.gaps(pairs), GAP, rtol=1e-9)
    assert (len(pairs), len(triangles(pairs, 18))) == (37, 20)
    half_spheres = packed.on_wall(2)
    assert half_spheres.sum() == 7
    volume = 4 / 3 * np.pi * RADIUS**3 * (18 - 7 / 2)
    assert volume / np.ptp(packed.box, axis=1).prod() == pytest.approx(0.35, abs=0.005)


def test_specimen_is_its_mirror_image():
    """Pushed to the right from the left is pushed to the left from the right."""
    mirror = np.concatenate([start + np.arange(n)[::-1] for start, n in ((0, 5), (5, 6), (11, 7))])
    pairs = specimen_packing().neighbours(1e-3)
    own = specimen(bonds(pairs, 1e5, 2e4, 0.8))
    held, values = supports(own)
    right = solve(own, held, values)
    left = solve(own, held[mirror], -values[mirror])
    expected = right.motion[mirror] * [-1, 1, -1]
    np.testing.assert_allclose(left.motion, expected, atol=1e-15)


def test_wall_of_single_springs_is_the_ground():
    springs = np.diag([3.0, 2.0, 0.5])
    two = bonds([[0, 1]], 5.0, 2.0, 1.0)
    walled = lattice([[0, 0], [1, 0]], two, walls=[wall([1], springs)])
    grounded = lattice([[0, 0], [1, 0]], two, ground=[[0, 0, 0], np.diag(springs)])
    held, values = [[True] * 3, [False] * 3], [[0.1, 0.2, 0.3], [0, 0, 0]]
    one, other = solve(walled, held, values), solve(grounded, held, values)
    np.testing.assert_allclose(one.motion, other.motion, rtol=1e-12)
    assert one.energies["ground"] == pytest.approx(other.energies["ground"])
    # Forces on the held node are what goes into the wall.
    assert 2 * one.energy == pytest.approx((one.reactions * values).sum())


def test_wall_holds_parts_and_couples_nodes():
    both = np.kron([[2.0, 1.0], [1.0, 2.0]], np.eye(2))
    apart = lattice([[0, 0], [1, 1]], bonds([[0, 1]], 1.0), walls=[wall([0, 1], both)])
    pushed = solve(apart, [[True, True], [False, False]], [[1.0, -1.0], [0, 0]])
    np.testing.assert_allclose(pushed.motion[1], [-0.5, 0.5], atol=1e-12)


@pytest.mark.parametrize(
    ("stiffness", "text"),
    [
        (np.ones((2, 3)), "square"),
        ([[1.0, 0.5], [0.0, 1.0]], "symmetric"),
        ([[1.0, 2.0], [2.0, 1.0]], "negative eigenvalue"),
    ],
)
def test_bad_walls(stiffness, text):
    assert text in str(refusal(wall, [0], stiffness))
    line = bonds([[0, 1]], 1.0)
    error = refusal(lattice, [[0, 0], [1, 0]], line, walls=[wall([7], np.eye(3))])
    assert [v.field for v in error.violations] == ["walls[0].nodes[0]", "walls[0].stiffness"]


def test_offset_is_a_lever_of_the_normal_force():
    """Turning the second body opens a bond that acts to the left of the nodes' line."""
    own = lattice([[0, 0], [2, 0]], bonds([[0, 1]], 3.0, offset=0.5), rotates=True)
    turned = solve(own, True, [[0, 0, 0], [0, 0, 1e-3]])
    assert turned.bond_forces[0, 0] == pytest.approx(-3 * 0.5e-3)
    assert turned.reactions[1, 2] == pytest.approx(3 * 0.5**2 * 1e-3)
    line = bonds([[0, 1]], 1.0, 1.0, 1.0, 1.0, offset=0.5)
    assert "bonds.offset" in str(refusal(lattice, [[0, 0, 0], [1, 0, 0]], line))


def test_pocket_resists_rotations_of_its_corners():
    corners = np.array([[0, 0], [1, 0], [0.4, 0.8]])
    own = lattice(corners, bonds([[0, 1]], 0.0), pockets([[0, 1, 2]], 0.0, 0.0, 2.0, 3.0))
    assert own.rotates
    turn = 1e-3
    whole = np.column_stack([turn * corners @ [[0, 1], [-1, 0]], np.full(3, turn)])
    assert solve(own, True, whole).energy == pytest.approx(0, abs=1e-20)
    places = np.column_stack([np.zeros((3, 2)), [turn, 2 * turn, 3 * turn]])
    expected = (2 * (2 * turn) ** 2 + 3 * 2 * turn**2) / 2
    assert solve(own, True, places).energy == pytest.approx(expected)


def test_iterations_find_what_elimination_finds(monkeypatch):
    from bondcell.lattice import solve as module

    side = np.arange(6.0)
    points = np.stack(np.meshgrid(side, side, side, indexing="ij"), -1).reshape(-1, 3)
    points += np.random.default_rng(5).uniform(-0.1, 0.1, points.shape)
    pairs = packing(points, 0.3).neighbours(1.0)
    stiff = np.random.default_rng(6).lognormal(0, 1, len(pairs))
    own = lattice(points, bonds(pairs, stiff, stiff / 3, stiff / 20, stiff / 30))
    held = np.zeros((own.count, 6), bool)
    held[:36], held[-36:, 2] = True, True
    values = np.where(np.arange(own.count) >= own.count - 36, 0.1, 0.0)[:, None]
    direct = solve(own, held, values)
    monkeypatch.setattr(module, "LARGEST_DIRECT", {2: 0, 3: 0})
    iterated = solve(own, held, values)
    assert 0 < iterated.iterations < 40
    np.testing.assert_allclose(iterated.motion, direct.motion, atol=1e-8)
    assert iterated.energy == pytest.approx(direct.energy, rel=1e-12)


def refusal(call, *arguments, **more):
    with pytest.raises(InputError) as caught:
        call(*arguments, **more)
    return caught.value


def test_loose_part_is_named():
    own = lattice([[0, 0], [1, 0], [5, 5], [6, 5]], bonds([[0, 1], [2, 3]], 1.0, 1.0, 1.0))
    error = refusal(solve, own, [[True] * 3, [False] * 3, [False] * 3, [False] * 3])
    assert len(error.violations) == 3
    for violation in error.violations:
        assert violation.field == "free mechanism of nodes 2, 3"
        assert "as one body" in violation.value


def test_part_that_can_still_turn_is_named():
    triangle = lattice([[0, 0], [1, 0], [0, 1]], bonds([[0, 1], [1, 2], [0, 2]], 1.0))
    error = refusal(solve, triangle, [[True, True], [False, False], [False, False]])
    assert [v.field for v in error.violations] == ["free mechanism of nodes 0, 1, 2"]


def test_node_without_resistance_is_named():
    own = lattice([[0, 0], [1, 0], [2, 0]], bonds([[0, 1], [1, 2]], 1.0))
    error = refusal(solve, own, [[True, True], [False, False], [True, True]])
    (violation,) = error.violations
    assert (violation.field, violation.value) == ("free mechanism of node 1", "displacement y")


def test_rotations_that_nothing_resists_are_named():
    own = lattice([[0, 0], [1, 0]], bonds([[0, 1]], 1.0), rotates=True)
    error = refusal(solve, own, [[True, True, True], [True, True, False]])
    assert error.violations[0].value == "rotation"


def test_mechanism_inside_is_named():
    """A hinged square on two supports leans over."""
    square = lattice([[0, 0], [1, 0], [1, 1], [0, 1]], bonds([[0, 3], [1, 2], [2, 3]], 1.0))
    error = refusal(solve, square, [[True, True], [True, True], [False] * 2, [False] * 2])
    (violation,) = error.violations
    assert (violation.field, violation.value) == ("free mechanism of nodes 2, 3", "displacement x")


def test_overlaps_and_pierced_walls_are_all_named():
    centres = [[0, 0, 0], [1.5, 0, 0], [5, 0, 4.5], [5, 0, -6], [9, 0, 0]]
    error = refusal(packing, centres, 1.0, [[-1, 10], [0, 4], [-5, 5]])
    assert [v.field for v in error.violations] == [
        "centres[0, 1]", "centres[0].x", "centres[4].x", "centres[3].z", "centres[2].z",
    ]  # fmt: skip
    many = refusal(packing, np.zeros((30, 3)), 1.0)
    assert len(many.violations) == 21
    assert many.violations[-1].value == 30 * 29 / 2 - 20


@pytest.mark.parametrize(
    ("changes", "field"),
    [
        ({"normal": -1.0}, "bonds.normal"),
        ({"shear": np.nan}, "bonds.shear"),
        ({"pivot": 1.5}, "bonds.pivot"),
        ({"bending": [1.0, 2.0, 3.0]}, "bonds.bending"),
    ],
)
def test_bad_bonds(changes, field):
    error = refusal(bonds, [[0, 1], [1, 2]], **{"normal": 1.0} | changes)
    assert [v.field for v in error.violations] == [field]


def test_bad_lattices():
    assert "pairs[1]" in str(refusal(bonds, [[0, 1], [2, 2]], 1.0))
    assert "bonds[0]" in str(refusal(lattice, [[0, 0], [1, 0]], bonds([[0, 5]], 1.0)))
    assert "ground" in str(refusal(lattice, [[0, 0]], bonds(np.zeros((0, 2)), 1.0), ground=-1.0))
    assert "different places" in str(refusal(lattice, [[0, 0], [0, 0]], bonds([[0, 1]], 1.0)))
    line = refusal(
        lattice, [[0, 0], [1, 0], [2, 0]], bonds([[0, 1]], 1.0), pockets([[0, 1, 2]], 1.0)
    )
    assert "one line" in str(line)
    assert "pockets.stiffness" in str(refusal(pockets, [[0, 1, 2]], -1.0))
    for radii, box, field in (
        ([1.0, 2.0], None, "radii"),
        (-1.0, None, "radii[0]"),
        (1.0, [[0, 1], [1, 0], [0, 1]], "box"),
    ):
        assert refusal(packing, [[0.0, 0.0, 0.0]], radii, box).violations[0].field == field
