"""Lattices of any spheres with bonds of the bond cell's models."""

from importlib import import_module

import numpy as np
import pytest
import xarray as xr

import bondcell

MATERIAL = {
    "young_particle": 3e10, "poisson_particle": 0.25, "young_matrix": 1.4e6, "poisson_matrix": 0.46
}  # fmt: skip
PAIR = [[0, 0, 0], [0, 0, 0.018]]
RADII = [7.5e-3, 1e-2]


def study(swapped=False):
    shape = {"radius_i": RADII[swapped], "radius_j": RADII[not swapped], "gap": 5e-4}
    moduli = {"young_i": 3e10, "poisson_i": 0.25, "young_m": 1.4e6, "poisson_m": 0.46}
    return xr.Dataset(shape | moduli)


def evaluated(load, swapped=False):
    return float(bondcell.evaluate(study(swapped), model="generatrix", load=load).stiffness)


def response(net, component, node):
    """2 U of a unit motion of one node while the other one is held."""
    values = np.zeros((2, 6))
    values[node, component] = 1.0
    return 2 * bondcell.solve_lattice(net, True, values).energy


def test_two_unequal_spheres_are_their_cell():
    """Normal, shear, torsion; bending of the cell is turning either sphere, the other one held."""
    net = bondcell.bonded_lattice(PAIR, RADII, 1e-3, model="generatrix", **MATERIAL)
    assert response(net, 2, 1) == pytest.approx(evaluated("normal"), rel=1e-9)
    assert response(net, 0, 1) == pytest.approx(evaluated("shear"), rel=1e-9)
    assert response(net, 5, 1) == pytest.approx(evaluated("torsion"), rel=1e-9)
    assert response(net, 3, 1) == pytest.approx(evaluated("bending"), rel=1e-9)
    assert response(net, 3, 0) == pytest.approx(evaluated("bending", swapped=True), rel=1e-9)


def test_pivot_is_that_of_the_coupling_force():
    """The reference gives the force itself, the levers follow from both bending stiffnesses."""
    net = bondcell.bonded_lattice(PAIR, RADII, 1e-3, model="fe", **MATERIAL)
    coupling = float(bondcell.evaluate(study(), model="fe", load="bending").coupling)
    lever = abs(coupling) / net.bonds.shear[0]
    assert net.bonds.pivot[0] == pytest.approx(1 - lever / 0.018, rel=1e-5)
    film = bondcell.bonded_lattice(PAIR, RADII, 1e-3, model="film", **MATERIAL)
    assert film.bonds.pivot[0] == pytest.approx(net.bonds.pivot[0], rel=2e-3)


def test_model_of_the_normal_load_has_no_rotations():
    net = bondcell.bonded_lattice(PAIR, RADII, 1e-3, model="fsi", **MATERIAL)
    assert not net.rotates


def test_equal_pairs_are_evaluated_once(monkeypatch):
    module = import_module("bondcell.bonded_lattice")
    asked = []
    real = module.evaluate

    def counted(study, **more):
        asked.append(study.sizes["pair"])
        return real(study, **more)

    monkeypatch.setattr(module, "evaluate", counted)
    grid = np.stack(np.meshgrid(*[0.0155 * np.arange(4)] * 3), -1).reshape(-1, 3)
    net = module.bonded_lattice(grid, 7.5e-3, 1e-3, model="fsi", **MATERIAL)
    assert (net.bonds.count, asked) == (144, [1])


@pytest.mark.parametrize(
    ("changes", "field"),
    [
        ({"cutoff": 1e-4}, "cutoff"),
        ({"radii": 1e-2}, "centres[0, 1]"),
        ({"centres": [["a", 0, 0]]}, "centres"),
        ({"centres": np.zeros((0, 3))}, "centres"),
        ({"centres": 1e200 * np.asarray(PAIR)}, "centres[1]"),
        ({"young_particle": [3e10, 2e10]}, "young_particle"),
        ({"model": "rod"}, "model"),
        ({"poisson_matrix": 0.6}, "poisson_matrix"),
        ({"box": [[-1, 1], [-1, 1], [-0.005, 1]]}, "centres[0].z"),
    ],
)
def test_bad_input(changes, field):
    given = {"centres": PAIR, "radii": RADII, "cutoff": 1e-3, "model": "fsi"} | MATERIAL | changes
    with pytest.raises(bondcell.InputError) as caught:
        bondcell.bonded_lattice(**given)
    assert [violation.field for violation in caught.value.violations] == [field]


def test_supports_of_another_shape():
    net = bondcell.bonded_lattice(PAIR, RADII, 1e-3, model="fsi", **MATERIAL)
    for held, values, field in (
        (np.ones((3, 3)), 0.0, "held"),
        (True, np.ones(2), "values"),
        (None, 0.0, "held"),
    ):
        with pytest.raises(bondcell.InputError) as caught:
            bondcell.solve_lattice(net, held, values)
        assert [violation.field for violation in caught.value.violations] == [field]
