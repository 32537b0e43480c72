"""Accuracy atlas: its key in a scene, tables by region, best models."""

import pytest

from bondcell.errors import SceneError
from bondcell.scene import parse_scene

CELL = {"radius_i": "7.5 mm", "young_i": "30 GPa", "young_m": "1.4 MPa", "poisson_i": 0.25}
SWEEP = {"gap_ratio": [0.01, 0.1], "modulus_ratio": [1, "rigid"], "poisson_m": [0, 0.5]}
ATLAS = {
    "title": "Atlas",
    "cell": CELL,
    "sweep": SWEEP,
    "models": ["fsi"],
    "reference": {"bc": "roller"},
    "atlas": True,
}


def test_an_atlas_is_off_by_default():
    assert parse_scene(ATLAS).atlas
    assert not parse_scene(ATLAS | {"atlas": False}).atlas
    assert not parse_scene({key: value for key, value in ATLAS.items() if key != "atlas"}).atlas


@pytest.mark.parametrize("without", ["models", "reference", "gap_ratio", "poisson_m"])
def test_an_atlas_needs_its_axes_models_and_a_reference(without):
    scene = {key: value for key, value in ATLAS.items() if key != without}
    scene["sweep"] = {axis: values for axis, values in SWEEP.items() if axis != without}
    scene["cell"] = CELL | {"gap": "1 mm", "poisson_m": 0.3}
    with pytest.raises(SceneError, match="atlas = True") as caught:
        parse_scene(scene)
    assert "gap_ratio, modulus_ratio, poisson_m" in str(caught.value)
