"""The surrogate against the reference it comes from, and its data against a new build."""

import json
from importlib.resources import files

import numpy as np
import pytest

from bondcell.cell import Cell
from bondcell.fem import surrogate_build
from bondcell.fem.reference import solve
from bondcell.fem.surrogate_grid import sample
from bondcell.models.surrogate import LOADS, is_inside, stiffness
from bondcell.models.surrogate_axes import AXES, chebyshev_points
from bondcell.models.tucker import Tucker

BASE = {
    "radius_i": 7.5e-3,
    "gap": 5e-4,
    "young_i": 3e10,
    "young_m": 1.4e6,
    "poisson_i": 0.25,
    "poisson_m": 0.46,
}


def test_tucker_tensor_of_a_smooth_function():
    x, y, z = (chebyshev_points(n) for n in (14, 14, 18))
    values = np.exp(x[:, None, None] * y[:, None]) * np.cos(2 * z)
    tensor = Tucker.fit(values, 1e-9)
    assert tensor.core.shape[2] == 1
    at = np.random.default_rng(3).uniform(-1, 1, (3, 5000))
    assert np.allclose(tensor(list(at)), np.exp(at[0] * at[1]) * np.cos(2 * at[2]), atol=1e-8)


def test_coordinates_and_nodes_are_inverse_to_each_other():
    gap = AXES.gap_nodes()[5]
    softness, compressibility, nu = AXES.material_nodes(gap)
    assert softness[0] == compressibility[0] == 0
    assert softness[-1] == pytest.approx(1)
    assert compressibility[-1] == pytest.approx(1.5)
    for values, axis, count in ((softness, 1, 30), (compressibility, 2, 16), (nu, 3, 5)):
        arguments = [np.full(count, v) for v in (gap, 0.1, 0.1, 0.1)]
        arguments[axis] = values
        coordinates = AXES.unit_coordinates(*arguments)[axis]
        assert coordinates == pytest.approx(chebyshev_points(count), abs=1e-12)


@pytest.mark.parametrize(
    ("load", "expected"),
    [("normal", 162460.7672), ("shear", 29585.863), ("torsion", 0.52187948), ("bending", 2.580394)],
)
def test_base_case(load, expected):
    answer = stiffness(Cell.from_values(**BASE), load)
    assert answer.stiffness == pytest.approx(expected, rel=1e-4)
    assert abs(answer.stiffness / expected - 1) <= answer.relative_error <= 3e-4


@pytest.mark.parametrize("load", LOADS)
def test_random_cells_stay_within_the_stored_error(load):
    cells = surrogate_build.random_cells(8, seed=77).ravel()
    answer = stiffness(cells, load)
    for k in range(8):
        true = solve(cells.take(slice(k, k + 1)), load, tolerance=1e-5).stiffness[0]
        assert abs(answer.stiffness[k] / true - 1) <= answer.relative_error[k] + 1e-5


@pytest.mark.parametrize("load", LOADS)
def test_limits_and_monotony(load):
    young = np.geomspace(1.4e6, 1e20, 200)
    values = stiffness(Cell.from_values(**BASE | {"young_i": young}), load).stiffness
    rigid = stiffness(Cell.from_values(**BASE | {"young_i": np.inf}), load).stiffness
    assert (np.diff(values) > -1e-6 * values[1:]).all()
    assert values[-1] == pytest.approx(float(rigid), rel=1e-6)


def test_homogeneous_cylinder():
    cell = Cell.from_values(**BASE | {"young_i": 1.4e6, "poisson_i": 0.3, "poisson_m": 0.3})
    answer = stiffness(cell, "normal")
    assert answer.stiffness == pytest.approx(
        float(np.pi * 1.4e6 * 7.5e-3**2 / cell.length), rel=1e-4
    )


def test_outside_the_data_there_is_no_value():
    changes = [
        {"radius_j": 7e-3},
        {"gap": 7e-7},
        {"gap": 0.1},
        {"young_i": 1e6},
        {"poisson_m": -0.1},
        {"poisson_i": 0.47},
        {"cylinder_radius": 8e-3},
    ]
    for change in changes:
        cell = Cell.from_values(**BASE | change)
        assert not is_inside(cell).any()
        assert np.isnan(stiffness(cell, "normal").stiffness).all()


def shipped():
    source = files("bondcell.models").joinpath("data/surrogate.npz")
    return np.load(source.open("rb"), allow_pickle=False)


def test_data_tells_where_it_comes_from():
    data = shipped()
    about = json.loads(str(data["about"]))
    assert about["nodes"] == list(AXES.shape)
    assert {"order", "seed", "truncation", "source", "versions", "machine"} <= set(about)
    assert all((data[f"{load}_errors"] < 3e-4).all() for load in LOADS)


@pytest.mark.slow
def test_new_build_gives_the_shipped_data(tmp_path):
    """The quickest load in full; the grid of the others at one gap."""
    path = tmp_path / "surrogate.npz"
    surrogate_build.build(path, ["torsion"])
    new, old = np.load(path), shipped()
    at = [np.random.default_rng(4).uniform(-1, 1, 2000) for _ in range(4)]
    tensors = [
        Tucker(data["torsion_core"], tuple(data[f"torsion_factor_{k}"] for k in range(4)))
        for data in (new, old)
    ]
    assert np.allclose(tensors[0](at), tensors[1](at), atol=1e-5)


@pytest.mark.slow
@pytest.mark.parametrize("load", LOADS)
def test_grid_of_one_gap_is_what_the_data_interpolate(load, monkeypatch):
    gap = AXES.gap_nodes()[9]
    monkeypatch.setattr(type(AXES), "gap_nodes", lambda self: np.array([gap]))
    values = sample(load)[0]
    softness, compressibility, nu = AXES.material_nodes(gap)
    grid = np.meshgrid(softness, compressibility, nu, indexing="ij")
    coordinates = AXES.unit_coordinates(np.full(values.size, gap), *(a.ravel() for a in grid))
    data = shipped()
    factors = tuple(data[f"{load}_factor_{k}"] for k in range(4))
    assert np.allclose(
        Tucker(data[f"{load}_core"], factors)(coordinates), values.ravel(), atol=5e-5
    )
