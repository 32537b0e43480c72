"""Many shapes of few materials: interpolated values against a solve of each."""

import numpy as np
import pytest

from bondcell.cell import Cell
from bondcell.models import MODELS
from bondcell.models.film import interpolated, loads

DIRECT = {load: getattr(loads, load) for load in ("normal", "shear", "torsion", "bending")}


def packing(count: int, seed: int, **values: object) -> Cell:
    """Bonds of one material between random spheres, either of the two the larger one."""
    draw = np.random.default_rng(seed).uniform
    radius = 1e-3 * 10 ** draw(-0.3, 0, (2, count))
    given = {
        "radius_i": radius[0],
        "radius_j": radius[1],
        "gap": radius.min(axis=0) * 10 ** draw(-3, -0.5, count),
        "young_i": 3e10,
        "young_m": 1.4e6,
        "poisson_i": 0.25,
        "poisson_m": 0.46,
    }
    return Cell.from_values(**given | values).ravel()


def assert_honest(load: str, cell: Cell, some: np.ndarray, interpolates: bool = True) -> None:
    springs = MODELS["film"].loads[load](cell)
    direct = DIRECT[load](cell.take(some))
    off = np.abs(springs.stiffness[some] / direct.stiffness - 1)
    added = springs.relative_error[some] - direct.relative_error
    assert np.all(off <= np.maximum(added, 1e-9))
    assert np.all((added > 0) == interpolates)
    assert springs.relative_error.max() <= direct.relative_error.max() + interpolated.TOLERANCE


def test_equal_spheres_of_many_gaps() -> None:
    gap = 7.5e-3 * np.geomspace(1e-4, 2.9, 400)
    cell = packing(400, 1, radius_i=7.5e-3, radius_j=7.5e-3, gap=gap)
    assert_honest("normal", cell, np.arange(3, 400, 13))


def test_a_polydisperse_packing() -> None:
    cell = packing(1500, 2)
    assert_honest("torsion", cell, np.arange(0, 1500, 20))


def test_two_sizes_are_three_families() -> None:
    """Bending turns plane j alone: small on large is another bond than large on small."""
    size = np.random.default_rng(3).choice([1e-3, 7e-4], (2, 1200))
    gap = 7e-4 * 10 ** np.random.default_rng(4).uniform(-2, -0.5, 1200)
    cell = packing(1200, 3, radius_i=size[0], radius_j=size[1], gap=gap)
    assert_honest("bending", cell, np.arange(0, 1200, 40))


def test_materials_share_their_grid() -> None:
    """Two materials, unequal particles in either order, all in one call."""
    soft = np.random.default_rng(5).random(800) < 0.5
    young = np.where(soft, 1e8, 3e10)
    large = np.random.default_rng(6).random(800) < 0.5
    cell = packing(
        800,
        6,
        radius_i=np.where(large, 1e-3, 6e-4),
        radius_j=np.where(large, 6e-4, 1e-3),
        young_i=np.where(large, young, 2 * young),
        young_j=np.where(large, 2 * young, young),
        gap=6e-4 * 10 ** np.random.default_rng(7).uniform(-3, -0.5, 800),
    )
    assert_honest("torsion", cell, np.arange(0, 800, 20))


def test_every_material_its_own_is_solved_one_by_one() -> None:
    young = 1.4e6 * 10 ** np.random.default_rng(8).uniform(2, 6, 150)
    cell = packing(150, 8, young_i=young)
    assert_honest("torsion", cell, np.arange(0, 150, 10), interpolates=False)


def test_what_is_out_of_range_stays_out_of_the_grid() -> None:
    """Gaps too narrow for the fields and long ones, among many others."""
    gap = 7.5e-3 * np.concatenate([np.geomspace(1e-4, 2.9, 300), [1e-7, 1e-6, 10.0, 1e3]])
    cell = packing(304, 9, radius_i=7.5e-3, radius_j=7.5e-3, gap=gap)
    springs, direct = MODELS["film"].loads["normal"](cell), loads.normal(cell.take(slice(300, 304)))
    assert springs.stiffness[300:] == pytest.approx(direct.stiffness, rel=1e-12)
    assert np.all(np.diff(springs.stiffness[:300]) < 0)


def test_a_repeated_shape_is_no_reason_for_a_grid() -> None:
    cell = packing(2000, 10, radius_i=1e-3, radius_j=1e-3, gap=np.tile([1e-5, 2e-5], 1000))
    assert_honest("torsion", cell, np.arange(8), interpolates=False)
