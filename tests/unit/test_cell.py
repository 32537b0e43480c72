import pickle

import numpy as np
import pytest

from bondcell.cell import REQUIRED, UNITS, Cell
from bondcell.errors import InputError

GOOD = {
    "radius_i": 7.5e-3,
    "gap": 5e-4,
    "young_i": 3e10,
    "young_m": 1.4e6,
    "poisson_i": 0.25,
    "poisson_m": 0.46,
}


def violations(**changes: object) -> dict[str, str]:
    """Fields that are complained about, with what is allowed."""
    with pytest.raises(InputError) as caught:
        Cell.from_values(**{**GOOD, **changes})
    found = caught.value.violations
    assert len({violation.field for violation in found}) == len(found), "one complaint a field"
    return {violation.field: violation.allowed for violation in found}


def test_defaults() -> None:
    cell = Cell.from_values(**GOOD)
    assert cell.radius_j == cell.radius_i
    assert cell.young_j == cell.young_i
    assert cell.poisson_j == cell.poisson_i
    assert cell.cylinder_radius == cell.radius_i
    assert Cell.from_values(**GOOD, radius_j=8e-3).cylinder_radius == 8e-3
    assert cell.length == pytest.approx(0.0155, rel=1e-15)


@pytest.mark.parametrize("name", ["radius_i", "radius_j", "gap", "cylinder_radius", "young_m"])
@pytest.mark.parametrize("bad", [0.0, -1e-3, np.nan, np.inf, -np.inf])
def test_lengths_and_matrix_modulus_are_positive_and_finite(name: str, bad: float) -> None:
    found = violations(**{name: bad})
    assert list(found) == [name]
    assert "(0, inf)" in found[name]


@pytest.mark.parametrize("name", ["young_i", "young_j"])
@pytest.mark.parametrize("bad", [0.0, -1.0, np.nan])
def test_particle_moduli_are_positive(name: str, bad: float) -> None:
    assert "(0, inf]" in violations(**{name: bad})[name]


def test_rigid_particles_are_allowed() -> None:
    assert np.isinf(Cell.from_values(**{**GOOD, "young_i": np.inf}).young_j)


@pytest.mark.parametrize("name", ["poisson_i", "poisson_j", "poisson_m"])
@pytest.mark.parametrize("bad", [-1.0, np.nextafter(0.5, 1), np.nan, 2])
def test_poisson_range(name: str, bad: float) -> None:
    assert violations(**{name: bad}) == {name: "(-1, 0.5]"}


def test_poisson_range_includes_one_half() -> None:
    assert Cell.from_values(**{**GOOD, "poisson_m": 0.5}).poisson_m == 0.5


@pytest.mark.parametrize("bad", ["7.5 mm", None, True, [1.0, "x"], 1j, {"a": 1}, [[1.0], [1.0, 2]]])
def test_not_a_number(bad: object) -> None:
    assert violations(gap=bad) == {"gap": "numbers [m]"}


def test_no_numbers() -> None:
    assert violations(gap=[]) == {"gap": "at least one number"}


def test_every_violation_at_once() -> None:
    values = {"radius_i": -1.0, "gap": "wide", "young_i": 0.0, "poisson_m": 0.6, "radius": 1.0}
    with pytest.raises(InputError) as caught:
        Cell.from_values(**values)
    fields = {violation.field for violation in caught.value.violations}
    assert fields == {*values, "young_m", "poisson_i"}
    assert "7 violations" in str(caught.value)
    for name in fields:
        assert name in str(caught.value)


def test_value_and_count_of_bad_array_elements() -> None:
    with pytest.raises(InputError) as caught:
        Cell.from_values(**{**GOOD, "gap": [[1e-3, -2e-3], [0.0, 1e-3]]})
    (violation,) = caught.value.violations
    assert violation.value == -2e-3
    assert "2 such values" in violation.allowed


def test_thin_cylinder() -> None:
    found = violations(cylinder_radius=[8e-3, 7e-3], radius_j=[[1e-3], [7.5e-3]])
    assert "here at least 0.0075 m" in found["cylinder_radius"]
    assert "2 such values" in found["cylinder_radius"]


def test_thin_cylinder_beside_a_wrong_radius() -> None:
    assert set(violations(cylinder_radius=1e-3, radius_j=-1.0)) == {"cylinder_radius", "radius_j"}
    assert set(violations(cylinder_radius=1.0, radius_j=np.nan)) == {"radius_j"}


@pytest.mark.parametrize("name", ["radius_j", "gap", "cylinder_radius", "poisson_m"])
def test_shapes_that_do_not_broadcast(name: str) -> None:
    found = violations(**{"radius_i": [1e-3, 2e-3], name: np.full(3, 0.1)})
    assert found == {"shapes": "shapes that broadcast against each other"}


def test_shapes_are_named_with_the_other_violations() -> None:
    found = violations(radius_i=[1e-3, 2e-3], gap=[1e-3, -1.0, 1.0])
    assert set(found) == {"shapes", "gap"}


def test_unknown_names_list_the_known_ones() -> None:
    allowed = violations(radius=1.0)["radius"]
    assert all(name in allowed for name in UNITS)


@pytest.mark.parametrize("name", REQUIRED)
def test_required(name: str) -> None:
    with pytest.raises(InputError) as caught:
        Cell.from_values(**{key: value for key, value in GOOD.items() if key != name})
    assert [violation.field for violation in caught.value.violations] == [name]


def test_integers_become_floats() -> None:
    cell = Cell.from_values(**{**GOOD, "radius_i": 1, "gap": [1, 2]})
    assert all(value.dtype == np.float64 for value in cell.as_dict().values())


def test_shape_ravel_take_swapped() -> None:
    cell = Cell.from_values(
        **{**GOOD, "gap": [[1e-3], [2e-3]], "poisson_m": [0.0, 0.2, 0.4]}, radius_j=8e-3
    )
    assert cell.shape == (2, 3)
    flat = cell.ravel()
    assert all(value.shape == (6,) for value in flat.as_dict().values())
    assert flat.take([1, 5]).poisson_m.tolist() == [0.2, 0.4]
    assert flat.take([1, 5]).gap.tolist() == [1e-3, 2e-3]
    assert cell.swapped().radius_i == 8e-3
    again = cell.swapped().swapped().as_dict()
    assert all(np.array_equal(value, again[name]) for name, value in cell.as_dict().items())


def test_input_error_survives_pickling() -> None:
    with pytest.raises(InputError) as caught:
        Cell.from_values(**{**GOOD, "gap": -1.0})
    assert pickle.loads(pickle.dumps(caught.value)).violations == caught.value.violations
