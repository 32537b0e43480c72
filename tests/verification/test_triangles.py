"""The triangles against independent values at their rate, exact solutions, bounds, symmetries."""

import numpy as np
import pytest

from bondcell.cell import Cell
from bondcell.errors import InputError
from bondcell.fem import structured
from bondcell.fem.triangles import MOST_TRIANGLES, solve_level
from bondcell.models import MODELS

BASE = {
    "radius_i": 7.5e-3,
    "gap": 5e-4,
    "young_i": 3e10,
    "young_m": 1.4e6,
    "poisson_i": 0.25,
    "poisson_m": 0.46,
}
UNEQUAL = {"radius_j": 3e-3, "young_j": 1.4e7, "poisson_j": 0.4}


def cell(**changes):
    return Cell.from_values(**BASE | changes)


def fitted_order(levels, expected):
    """Order in h of the relative error, by least squares over the levels, h ~ dof^(-1/2)."""
    error = [level.stiffness / expected - 1 for level in levels]
    log_h = [-np.log(level.dof) / 2 for level in levels]
    return np.polyfit(log_h, np.log(error), 1)[0]


# Computed with another code and other meshes (NGSolve, order 8 to 10), 7 digits or more.
@pytest.mark.parametrize(
    ("bc", "poisson_m", "expected", "finest_error"),
    [
        ("roller", 0.46, 162460.7672, 5e-5),
        ("confined", 0.46, 307080.034, 3e-5),
        ("roller", 0.0, 87208.2649, 1e-6),
    ],
)
def test_base_case_approaches_another_code_from_above_as_h4(bc, poisson_m, expected, finest_error):
    levels = [solve_level(cell(poisson_m=poisson_m), size, bc) for size in (0.7, 0.5, 0.35, 0.25)]
    stiffness = np.array([level.stiffness for level in levels])
    assert np.all(stiffness > expected)
    assert stiffness[-1] == pytest.approx(expected, rel=finest_error)
    assert fitted_order(levels, expected) == pytest.approx(4, abs=0.6)


def test_clamped_base_case_agrees_with_another_code():
    stiffness = solve_level(cell(), 0.35, "clamped").stiffness
    assert 0 < stiffness / 162469.7398 - 1 < 2e-4


@pytest.mark.parametrize(
    "shape",
    [{}, {"gap": 1e-5}, {"radius_j": 2e-3}, {"cylinder_radius": 9e-3}],
    ids=["equal", "narrow", "unequal", "wide"],
)
@pytest.mark.parametrize("poisson", [-0.5, 0.49])
def test_homogeneous_cylinder_is_exact(shape, poisson):
    same = {"young_i": 2e6, "young_m": 2e6, "poisson_i": poisson, "poisson_m": poisson}
    case = cell(**same, **shape)
    rod = 2e6 * np.pi * case.cylinder_radius**2 / case.length
    oedometric = (1 - poisson) / ((1 + poisson) * (1 - 2 * poisson))
    assert solve_level(case, 1.0).stiffness == pytest.approx(rod, rel=1e-9)
    confined = solve_level(case, 1.0, "confined").stiffness
    assert confined == pytest.approx(rod * oedometric, rel=1e-9)


@pytest.mark.parametrize(
    ("changes", "bc"),
    [
        ({"gap": 7.5e-5}, "roller"),
        ({"young_i": 1.4e6}, "confined"),
        (UNEQUAL, "roller"),
        (UNEQUAL | {"cylinder_radius": 9e-3}, "clamped"),
        ({"gap": 7.5e-3, "young_i": np.inf}, "confined"),
    ],
    ids=["narrow", "soft", "unequal", "wide", "rigid"],
)
def test_both_discretisations_agree(changes, bc):
    case = cell(**changes)
    expected = structured.solve_level(case, 6, bc).stiffness
    errors = [solve_level(case, size, bc).stiffness / expected - 1 for size in (0.7, 0.35)]
    assert 0 < errors[1] < errors[0] / 5
    assert errors[1] < 5e-4


@pytest.mark.parametrize("poisson_m", [-0.3, 0.49])
@pytest.mark.parametrize("young_i", [1.4e5, 3e10])
def test_generatrix_lines_bound_from_below_and_more_supports_stiffen(poisson_m, young_i):
    case = cell(poisson_m=poisson_m, young_i=young_i, radius_j=5e-3)
    lower = MODELS["generatrix"].loads["normal"](case).stiffness
    roller, clamped, confined = (
        solve_level(case, 1.0, bc).stiffness for bc in ("roller", "clamped", "confined")
    )
    assert lower < roller < clamped
    assert roller < confined


def test_exchange_of_the_particles():
    case = cell(**UNEQUAL)
    there, back = solve_level(case, 0.5).stiffness, solve_level(case.swapped(), 0.5).stiffness
    assert there == pytest.approx(back, rel=2e-5)


@pytest.mark.parametrize("bc", ["roller", "clamped", "confined"])
def test_half_of_a_symmetric_pair(bc):
    half, whole = (solve_level(cell(), 0.5, bc, symmetry=half) for half in (True, False))
    assert half.stiffness == pytest.approx(whole.stiffness, rel=2e-4)
    assert whole.dof == pytest.approx(2 * half.dof, rel=0.1)


def test_scaling_by_dimensions():
    lengths = {"radius_i": 7.5, "gap": 0.5}
    moduli = {"young_i": 3e1, "young_m": 1.4e-3}
    scaled = solve_level(cell(**lengths, **moduli), 1.0).stiffness
    assert scaled == pytest.approx(solve_level(cell(), 1.0).stiffness * 1e3 / 1e9, rel=1e-9)


def test_rigid_particles_are_the_limit_without_loss_of_digits():
    rigid = solve_level(cell(young_i=np.inf), 0.7).stiffness
    for ratio in (1e8, 1e10, 1e12):
        softer = solve_level(cell(young_i=1.4e6 * ratio), 0.7).stiffness
        assert 0 <= 1 - softer / rigid + 1e-10 < 30 / ratio + 2e-10


@pytest.mark.parametrize(
    ("changes", "size", "bc", "fields"),
    [
        ({"poisson_m": 0.5}, 1.0, "roller", ["poisson_m"]),
        ({"poisson_i": 0.5}, 1.0, "roller", ["poisson_i", "poisson_j"]),
        ({}, 0.0, "roller", ["size"]),
        ({}, np.nan, "glued", ["bc", "size"]),
        ({}, 1e-3, "roller", ["size"]),
        ({"gap": [1e-3, 2e-3]}, 1.0, "roller", ["cell"]),
    ],
)
def test_bad_input_names_every_field(changes, size, bc, fields):
    with pytest.raises(InputError) as caught:
        solve_level(cell(**changes), size, bc)
    assert [violation.field for violation in caught.value.violations] == fields


def test_too_many_triangles_are_refused_before_meshing():
    with pytest.raises(InputError, match=str(MOST_TRIANGLES)):
        solve_level(cell(gap=1e3), 1.0)
