"""Slender cells under shear and bending: what two short cells say of a long one."""

from dataclasses import replace

import numpy as np
import pytest

from bondcell.cell import Cell
from bondcell.fem.reference import solve
from bondcell.fem.slender import LARGEST_ERROR, SLENDER, is_slender
from bondcell.fem.structured import find_load, solve_level
from bondcell.status import Status


def cell_of(**changes):
    """Particles of radius one, a gap just above where cells count as slender."""
    values = {"radius_i": 1.0, "gap": 1.05 * SLENDER, "young_i": 1e4, "young_m": 1.0}
    return Cell.from_values(**values | {"poisson_i": 0.25, "poisson_m": 0.3} | changes).ravel()


@pytest.mark.parametrize("load", ["shear", "bending"])
@pytest.mark.parametrize(
    "changes",
    [
        {},
        {"poisson_m": 0.5, "young_i": np.inf},
        {"poisson_m": -0.9},
        pytest.param({"young_i": 0.1}, marks=pytest.mark.slow),
        pytest.param({"radius_j": 0.5}, marks=pytest.mark.slow),
        {"radius_i": 0.6, "young_j": 3.0},
    ],
    ids=["stiff", "incompressible", "auxetic", "soft", "unequal", "unlike"],
)
def test_agrees_with_elements_along_the_whole_column(load, changes):
    gap = 1.05 * SLENDER * max(1.0, changes.get("radius_j", 0), changes.get("radius_i", 0))
    cell = cell_of(gap=gap, **changes)
    assert is_slender(cell, load)
    answer = solve(cell, load)
    assert answer.error_estimate[0] < (1e-6 if cell.young_i[0] > 1 else 1e-5)
    # What remains is round-off of the long elements; the cut matters beside the soft particles.
    grading = replace(find_load(load, None).grading, foot=1e-4)
    whole = solve_level(cell, 11, load=load, grading=grading).stiffness
    allowed = answer.error_estimate[0] + 2e-7
    assert answer.stiffness[0] == pytest.approx(whole, rel=allowed)


def test_homogeneous_beam_with_its_own_shear():
    """Thin beams: ``K_s = 12 EI / L^3``, ``K_b = 4 EI / L`` and a coupling of ``K_s L / 2``."""
    cell = cell_of(gap=1e4, young_i=1.0, poisson_i=0.0, poisson_m=0.0)
    rigidity, length = np.pi / 4, float(cell.length[0])
    shear, bending = solve(cell, "shear"), solve(cell, "bending")
    # Shear takes 12 EI / (k G A L^2) of it, a few times 1e-8 here.
    np.testing.assert_allclose(shear.stiffness, 12 * rigidity / length**3, rtol=3e-7)
    np.testing.assert_allclose(bending.stiffness, 4 * rigidity / length, rtol=3e-7)
    np.testing.assert_allclose(bending.coupling, -shear.stiffness * length / 2, rtol=1e-8)
    assert np.isnan(shear.coupling).all()


@pytest.mark.parametrize("load", ["shear", "bending"])
def test_the_longest_cells_meet_the_tolerance(load):
    cell = cell_of(gap=1e3, young_i=[1e4, np.inf, 1e4], poisson_m=[0.3, 0.5, -0.9])
    answer = solve(cell, load)
    assert (answer.status == Status.ok).all()
    assert (answer.error_estimate < 1e-6).all()


@pytest.mark.slow
def test_swapped_ends_have_one_stiffness():
    cell = cell_of(radius_j=0.5, young_j=20.0, gap=300.0)
    one, other = (solve(own, "shear").stiffness for own in (cell, cell.swapped()))
    np.testing.assert_allclose(one, other, rtol=1e-7)


@pytest.mark.slow
def test_values_of_unknown_error_are_withheld():
    """Beside particles a million times softer the short cells are wrong by far too much."""
    cell = cell_of(gap=1e3, young_i=1e-6, poisson_m=-0.9)
    answer = solve(cell, "bending")
    assert answer.status[0] == Status.limit_exceeded or answer.error_estimate[0] <= LARGEST_ERROR
    assert np.isnan(answer.stiffness[0]) == (answer.status[0] == Status.limit_exceeded)


@pytest.mark.parametrize(
    ("young", "gap"), [(1e-2, 15.0), pytest.param(1e-6, 1.0, marks=pytest.mark.slow)]
)
def test_estimates_cover_the_round_off_of_bending(young, gap):
    """What a change of units of length does is round-off, which soft particles raise."""
    scales = np.array([1.0, 1.7])
    answers = [
        solve(cell_of(radius_i=s, gap=gap * s, young_i=young, poisson_m=-0.9), "bending")
        for s in scales
    ]
    values = np.concatenate([answer.stiffness for answer in answers]) / scales**3
    assert np.ptp(values) < 2 * answers[0].error_estimate[0] * np.mean(values)
