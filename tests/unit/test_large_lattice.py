"""Plane lattices with large motions."""

import numpy as np
import pytest

from bondcell.errors import InputError
from bondcell.lattice.bonds import bonds
from bondcell.lattice.large import _state, solve_large
from bondcell.lattice.lattice import lattice
from bondcell.lattice.pockets import pockets
from bondcell.lattice.solve import solve
from bondcell.lattice.walls import wall

POINTS = np.array([[0.0, 0.0], [1.0, 0.1], [0.4, 0.9], [1.5, 1.0]])
PAIRS = [[0, 1], [0, 2], [1, 2], [1, 3], [2, 3]]


def net(ground=0.0):
    own = bonds(PAIRS, [2, 3, 1, 2, 1], [1, 0.5, 1, 2, 1], 0.3, pivot=[0.5, 0.4, 0.6, 0.5, 0.3])
    return lattice(POINTS, own, pockets([[0, 1, 2], [3, 2, 1]], 1.5, -0.1), ground)


def test_forces_and_tangent_are_derivatives():
    rng = np.random.default_rng(0)
    motion, step = 0.2 * rng.normal(size=(2, 4, 3))
    step *= 1e-6
    ahead, behind = (_state(net(0.2), motion + sign * step) for sign in (1, -1))
    _, force, tangent = _state(net(0.2), motion)
    energy = [sum(state[0].values()) for state in (ahead, behind)]
    assert (energy[0] - energy[1]) / 2 == pytest.approx(force @ step.ravel(), rel=1e-6)
    np.testing.assert_allclose((ahead[1] - behind[1]) / 2, tangent @ step.ravel(), atol=1e-11)


def test_tangent_at_rest_is_the_linear_matrix():
    _, force, tangent = _state(net(0.2), np.zeros((4, 3)))
    np.testing.assert_allclose(force, 0, atol=1e-14)
    np.testing.assert_allclose(tangent, net(0.2).matrix().toarray(), atol=1e-13)


@pytest.mark.parametrize("angle", [0.5, 2.0, -3.0])
def test_rigid_motions_cost_nothing(angle):
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    moved = POINTS @ turn.T + [0.3, -2.0] - POINTS
    motion = np.column_stack([moved, np.full(4, angle)])
    energies, force, _ = _state(net(), motion)
    assert abs(sum(energies.values())) < 1e-25
    np.testing.assert_allclose(force, 0, atol=1e-12)


def test_small_motions_are_linear_and_work_is_energy():
    held = np.zeros((4, 3), dtype=bool)
    held[0], held[3, :2] = True, True
    values = np.zeros((4, 3))
    values[3] = [1e-6, 2e-6, 0]
    linear, large = solve(net(), held, values), solve_large(net(), held, values, steps=1)
    np.testing.assert_allclose(large.motion, linear.motion, atol=1e-11)
    assert large.energy == pytest.approx(linear.energy, rel=1e-5)
    np.testing.assert_allclose(large.reactions, linear.reactions, rtol=1e-4, atol=1e-11)


def test_end_does_not_depend_on_the_steps():
    held = np.zeros((4, 3), dtype=bool)
    held[0], held[3, :2] = True, True
    values = np.zeros((4, 3))
    values[3] = [0.3, 0.1, 0]
    few, many = (solve_large(net(), held, values, steps=steps) for steps in (2, 8))
    np.testing.assert_allclose(few.motion, many.motion, atol=1e-9)
    free = ~held
    _, force, _ = _state(net(), few.motion)
    np.testing.assert_allclose(force.reshape(4, 3)[free], 0, atol=1e-8)


def test_without_rotations_bonds_only_lengthen():
    own = lattice([[0, 0], [1, 0]], bonds([[0, 1]], 2.0))
    found = solve_large(own, True, [[0, 0], [0.0, 1.0]])
    assert found.energies["normal"] == pytest.approx((np.sqrt(2) - 1) ** 2)


def test_space_is_refused():
    own = lattice([[0, 0, 0], [1, 0, 0]], bonds([[0, 1]], 2.0))
    with pytest.raises(InputError, match="points"):
        solve_large(own, True, 0.0)


def test_what_is_linear_only_is_refused():
    own = lattice(
        POINTS[:3],
        bonds([[0, 1], [1, 2]], 1.0, 1.0, 1.0, offset=0.1),
        pockets([[0, 1, 2]], 1.0, twist=0.1),
        walls=[wall([2], np.eye(3))],
    )
    with pytest.raises(InputError) as caught:
        solve_large(own, True, 0.0)
    fields = [violation.field for violation in caught.value.violations]
    assert fields == ["bonds.offset", "pockets.turning, pockets.twist", "walls"]
