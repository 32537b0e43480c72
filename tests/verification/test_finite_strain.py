"""Finite strain of the solid: derivatives, objectivity, exact states, the linear limit."""

from functools import cache

import numpy as np
import pytest

from bondcell.errors import BondcellError
from bondcell.lattice.packing import packing
from bondcell.solid.elastic import solve_elastic
from bondcell.solid.finite_strain import solve_finite_strain
from bondcell.solid.neo_hookean import NeoHookean
from bondcell.solid.sphere_mesh import sphere_mesh
from bondcell.solid.stiffness import Elastic, assemble

SOFT, STIFF = Elastic(1.4, 0.46), Elastic(3e3, 0.25)
BOX = [[-1.15, 1.15], [0, 3.45], [0, 1.2]]


def pair():
    return packing([[0, 2.25, 0], [0, 0, 0]], 1.0, BOX)


@cache
def mesh():
    return sphere_mesh(pair(), 2.0)


def supports():
    held = np.zeros((len(mesh().points), 3), dtype=bool)
    held[mesh().on_plane(1, 0.0)] = True
    held[mesh().on_plane(2, 0.0), 2] = True
    return held


@cache
def solid():
    inside = mesh().material >= 0
    lam, mu = (
        np.where(inside, STIFF.lame[0], SOFT.lame[0]),
        np.where(inside, STIFF.lame[1], SOFT.lame[1]),
    )
    return NeoHookean(mesh(), lam, mu)


def affine(gradient):
    return mesh().points @ (np.asarray(gradient) - np.eye(3)).T


def test_forces_and_tangent_are_derivatives():
    rng = np.random.default_rng(0)
    field = 0.02 * np.sin(2 * mesh().points[:, [1, 2, 0]])
    step = 1e-6 * rng.normal(size=field.shape)
    ahead, behind = (solid().energy_and_forces(field + sign * step) for sign in (1, -1))
    _, forces = solid().energy_and_forces(field)
    assert (ahead[0] - behind[0]) / 2 == pytest.approx((forces * step).sum(), rel=1e-6)
    change = (ahead[1] - behind[1]) / 2
    expected = (solid().tangent(field).fine @ step.ravel()).reshape(field.shape)
    np.testing.assert_allclose(change, expected, atol=1e-6 * abs(expected).max())


def test_tangent_of_the_natural_state_is_the_linear_stiffness():
    linear = assemble(mesh(), SOFT, STIFF)
    tangent = solid().tangent(np.zeros_like(mesh().points))
    for one, other in ((tangent.fine, linear.fine), (tangent.coarse, linear.coarse)):
        np.testing.assert_allclose(one.data, other.data, atol=1e-10 * abs(other.data).max())


def test_rigid_motions_cost_nothing():
    angle = 0.7
    turn = [[np.cos(angle), -np.sin(angle), 0], [np.sin(angle), np.cos(angle), 0], [0, 0, 1]]
    energy, forces = solid().energy_and_forces(affine(turn) + np.array([0.3, -1.0, 2.0]))
    assert abs(energy) < 1e-9
    np.testing.assert_allclose(forces, 0, atol=1e-9)


def test_uniform_stretch_has_the_energy_of_the_formula():
    lam, mu = SOFT.lame
    every = NeoHookean(mesh(), *np.full((2, len(mesh().nodes)), [[lam], [mu]]))
    stretch = np.diag([1.3, 0.8, 1.1])
    log = np.log(np.linalg.det(stretch))
    density = mu / 2 * (np.trace(stretch @ stretch) - 3 - 2 * log) + lam / 2 * log**2
    volume = np.ptp(BOX, axis=1).prod()
    assert every.energy_and_forces(affine(stretch))[0] == pytest.approx(density * volume)


@cache
def finite(x, y, steps=1):
    way = np.array([x, y])
    return solve_finite_strain(mesh(), pair(), SOFT, STIFF, supports(), np.array([0]), way, steps)


def test_small_displacements_are_linear():
    way = np.array([[1e-5, 0.0]])
    linear = solve_elastic(mesh(), pair(), SOFT, STIFF, supports(), np.array([0]), way, 1e-8)
    found = finite(1e-5, 0.0)
    assert found.energy == pytest.approx(float(linear.energy[0]), rel=1e-4)
    np.testing.assert_allclose(found.motion[0], linear.motion[0, :, 0], atol=1e-9)


def test_compression_of_the_gap_stiffens_and_extension_softens():
    down, up = finite(0.0, -0.05).energy, finite(0.0, 0.05).energy
    linear = (finite(0.0, 1e-5).energy + finite(0.0, -1e-5).energy) / 2 * 5e3**2
    assert up < linear < down
    assert down < 1.5 * linear


@pytest.mark.slow
def test_end_does_not_depend_on_the_steps_and_holds_the_means():
    one, two = finite(0.05, 0.0), finite(0.05, 0.0, 2)
    assert one.energy == pytest.approx(two.energy, rel=1e-6)
    np.testing.assert_allclose(one.motion[0, :2], [0.05, 0.0], atol=1e-12)
    assert (np.diff(two.path) > 0).all()
    assert finite(-0.05, 0.0).energy == pytest.approx(one.energy, rel=2e-3)


def test_too_far_in_one_step_is_an_error():
    with pytest.raises(BondcellError, match="more load steps"):
        finite(0.0, -2.0)
