"""The reference's error estimates against finer solves of random cells, every load."""

import numpy as np
import pytest

from bondcell.fem.honesty import CASES, Comparison, compare, random_cell
from bondcell.status import Status

SEED = 2013

QUICK = ((0, 0), (0, 1), (1, 0), (1, 1), (2, 0), (3, 1), (4, 0), (4, 1), (5, 2))
"""Case and number of cells; pairs of equal spheres where a solve of whole cells takes seconds."""


def check(case, numbers, tolerance):
    """Compare cells of one load; all estimates must cover the error. Returns the ratios."""
    load, bc = CASES[case]
    found = [
        compare(random_cell(np.random.default_rng([SEED, case, n])), load, bc, tolerance)
        for n in numbers
    ]
    for own in found:
        assert own.is_honest
        assert own.status == Status.ok or own.estimate > tolerance
    return [own.ratio for own in found]


@pytest.mark.parametrize(("case", "number"), QUICK)
def test_estimates_cover_the_errors_of_random_cells(case, number):
    check(case, [number], 1e-6)


@pytest.mark.slow
@pytest.mark.parametrize("case", range(len(CASES)))
@pytest.mark.parametrize("tolerance", [1e-4, 1e-6])
def test_estimates_cover_the_errors_of_many_random_cells(case, tolerance):
    ratios = check(case, range(8), tolerance)
    assert np.median(ratios) < 100


def test_errors_below_the_uncertainty_of_the_truth_count_as_that():
    found = Comparison(Status.ok, 8, estimate=1e-8, error=1e-12, uncertainty=1e-9, seconds=0.1)
    assert found.ratio == pytest.approx(10)
    assert found.is_honest
    sure = Comparison(Status.ok, 8, estimate=1e-8, error=2e-8, uncertainty=1e-12, seconds=0.1)
    assert sure.ratio == pytest.approx(0.5)
    assert not sure.is_honest
