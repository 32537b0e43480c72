"""The shipped accuracy map against the models, the surrogate and the reference it was made from."""

import numpy as np
import pytest

from bondcell.cell import Cell
from bondcell.fem.reference import solve
from bondcell.models import MODELS
from bondcell.models.asked import ask
from bondcell.results.accuracy_map import AXES, LOADS, SMALLEST, STEP, decode, shipped_map
from bondcell.results.accuracy_map_build import exceedance, random_cells

PARTICLES = (0.0, 0.25, 0.45)
"""Poisson's ratios of the particles in the atlas."""


@pytest.mark.parametrize("load", LOADS)
def test_expected_errors_hold_at_other_cells(load):
    """Held out: another seed than that of the margins."""
    found = shipped_map()
    cells = random_cells(found.axes, 60, seed=4).ravel()
    assert found.contains(cells).all()
    for model in found.codes[load]:
        if model != "surrogate":
            excess = exceedance(found, load, model, cells)
            assert np.quantile(excess, 0.97) <= 1, model
            assert excess.max() <= 1.25, model
            assert np.median(excess) >= 0.02, model


def rebuilt(load, gap, ratios, poisson):
    """Model -> largest error over the particles' Poisson's ratios, shape (ratios, poisson)."""
    cell = Cell.from_values(
        radius_i=1.0,
        gap=gap,
        young_i=ratios[:, None, None],
        young_m=1.0,
        poisson_m=poisson[:, None],
        poisson_i=np.array(PARTICLES),
    ).ravel()
    truth = solve(cell, load, tolerance=1e-6).stiffness
    shape = (ratios.size, poisson.size, len(PARTICLES))
    errors = {}
    for model in shipped_map().codes[load]:
        error = np.abs(ask(MODELS[model], load, cell)[0].stiffness / truth - 1).reshape(shape)
        errors[model] = error.max(axis=-1)
    return errors


def compare(load, gap, ratio_step, poisson_step):
    found = shipped_map()
    gaps, ratios, poisson = (found.axes[axis] for axis in AXES)
    picked = ratios[::ratio_step], poisson[::poisson_step]
    at = np.ix_(
        [gap], np.arange(ratios.size)[::ratio_step], np.arange(poisson.size)[::poisson_step]
    )
    for model, error in rebuilt(load, gaps[gap], *picked).items():
        stored = np.abs(decode(found.codes[load][model][at][0]))
        both = np.isfinite(error) & np.isfinite(stored)
        assert (np.isfinite(error) == ~np.isnan(stored) | np.isinf(stored)).all(), model
        assert (stored >= error * (1 - 1e-3) - 2 * SMALLEST)[both].all(), model
        assert (stored <= error * STEP * (1 + 1e-3) + 3 * SMALLEST)[both].all(), model


@pytest.mark.parametrize("load", LOADS)
def test_some_points_of_the_map_are_what_a_new_solve_gives(load):
    compare(load, gap=14, ratio_step=9, poisson_step=7)


@pytest.mark.slow
@pytest.mark.parametrize("load", LOADS)
@pytest.mark.parametrize("gap", [0, 9, 18, 27])
def test_map_is_what_a_new_build_gives(load, gap):
    compare(load, gap, ratio_step=1, poisson_step=1)
