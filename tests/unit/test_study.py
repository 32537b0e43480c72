"""From scene to study: labelled inputs on the swept axes."""

import numpy as np
import pytest

from bondcell.cell import UNITS
from bondcell.inputs import cell_from_study
from bondcell.scenes.parsing import parse_scene
from bondcell.scenes.study import build_study

CELL = {
    "radius_i": "7.5 mm",
    "gap": "0.5 mm",
    "young_i": "30 GPa",
    "poisson_i": 0.25,
    "young_m": "1.4 MPa",
    "poisson_m": 0.46,
}


def study(cell=CELL, **sweep):
    scene = {"title": "A title", "cell": cell, "models": ["fsi"]}
    return build_study(parse_scene(scene | ({"sweep": sweep} if sweep else {}), name="a_scene"))


def test_single_point():
    inputs = study()
    assert dict(inputs.sizes) == {}
    assert set(inputs.data_vars) == set(UNITS)
    assert float(inputs.gap) == 5e-4
    assert inputs.attrs == {"title": "A title", "scene": "a_scene"}


def test_defaults_are_filled_in():
    inputs = study()
    for name in ("radius", "young", "poisson"):
        assert float(inputs[f"{name}_j"]) == float(inputs[f"{name}_i"])
    assert float(inputs.cylinder_radius) == 7.5e-3


def test_dimensions_are_the_axes_in_order():
    inputs = study(poisson_m=[0, 0.46], gap=["1 mm", "2 mm", "3 mm"], modulus_ratio=[1])
    assert dict(inputs.sizes) == {"poisson_m": 2, "gap": 3, "modulus_ratio": 1}


@pytest.mark.parametrize("name", UNITS)
def test_every_input_has_unit_and_name(name):
    inputs = study(gap=["1 mm", "2 mm"], modulus_ratio=[1, 10])
    assert inputs[name].attrs["units"] == UNITS[name]
    assert inputs[name].attrs["long_name"]
    assert inputs[name].dtype == np.float64


def test_ratios_are_labelled():
    inputs = study(modulus_ratio=[1, 10], gap_ratio=[0.1], radius_ratio=[0.5])
    for name in ("modulus_ratio", "gap_ratio", "radius_ratio"):
        assert inputs[name].attrs["units"] == "1"
        assert "ratio" in inputs[name].attrs["long_name"]


def test_modulus_ratio_keeps_the_particles():
    inputs = study(modulus_ratio=[1, 1e3])
    assert inputs.young_m.dims == ("modulus_ratio",)
    np.testing.assert_array_equal(inputs.young_m, [3e10, 3e7])
    assert inputs.young_i.shape == ()


def test_gap_ratio_follows_a_swept_radius():
    inputs = study(gap_ratio=[0.1, 0.2], radius_i=[1e-3, 2e-3, 3e-3])
    assert inputs.gap.dims == ("gap_ratio", "radius_i")
    np.testing.assert_allclose(inputs.gap, np.outer([0.1, 0.2], [1e-3, 2e-3, 3e-3]))


def test_particle_j_follows_particle_i():
    inputs = study(radius_i=["1 mm", "2 mm"], poisson_i=[0.1, 0.2], young_i=["1 GPa", "rigid"])
    assert inputs.radius_j.dims == ("radius_i",)
    np.testing.assert_array_equal(inputs.radius_j, [1e-3, 2e-3])
    assert inputs.poisson_j.dims == ("poisson_i",)
    assert np.isinf(inputs.young_j.values[1])


def test_radius_ratio_and_cylinder():
    inputs = study(radius_ratio=[0.5, 1, 2])
    np.testing.assert_array_equal(inputs.radius_j, [3.75e-3, 7.5e-3, 15e-3])
    np.testing.assert_array_equal(inputs.cylinder_radius, [7.5e-3, 7.5e-3, 15e-3])


def test_given_cylinder_is_kept():
    inputs = study({**CELL, "cylinder_radius": "2 cm"}, radius_ratio=[0.5, 1, 2])
    assert float(inputs.cylinder_radius) == 0.02


def test_study_is_what_evaluate_takes():
    inputs = study(gap_ratio=[0.1, 0.2], modulus_ratio=[1, 10, 100], poisson_m=[0, 0.46])
    cell, dims = cell_from_study(inputs)
    assert set(dims) == {"gap_ratio", "modulus_ratio", "poisson_m"}
    assert cell.shape == tuple(inputs.sizes[dim] for dim in dims)
    np.testing.assert_array_equal(np.unique(cell.gap), [0.1 * 7.5e-3, 0.2 * 7.5e-3])
