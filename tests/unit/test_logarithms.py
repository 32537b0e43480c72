import numpy as np
import pytest
from mpmath import mp, mpf

from bondcell.cell import FloatArray
from bondcell.models.logarithms import second_remainder, third_remainder

NEAR_ONE = 10.0 ** np.arange(-300, -1, 23)
ARGUMENTS = np.concatenate(
    [
        -(10.0 ** np.arange(-20, 13, 0.7)),
        10.0 ** np.arange(-20, -0.05, 0.3),
        np.linspace(-2, 0.99, 301),
        [0.25, np.nextafter(0.25, 0), -0.25, np.nextafter(-0.25, 0), 0.5, np.nextafter(0.5, 0)],
    ]
)


def exact(y: mpf, order: int) -> mpf:
    """Sum of y^n / (n + order)."""
    with mp.workdps(120):
        return (-mp.log(1 - y) - sum(y**n / n for n in range(1, order))) / y**order


def worst(values: FloatArray, order: int) -> float:
    pairs = zip(values, ARGUMENTS, strict=True)
    return max(abs(float(mpf(float(v)) / exact(mpf(float(y)), order) - 1)) for v, y in pairs)


def test_second_remainder() -> None:
    assert worst(second_remainder(ARGUMENTS, 1 - ARGUMENTS), 2) < 2e-15


def test_third_remainder() -> None:
    assert worst(third_remainder(ARGUMENTS, 1 - ARGUMENTS), 3) < 8e-15


@pytest.mark.parametrize("function", [second_remainder, third_remainder])
def test_mixed_arguments_do_not_change_each_other(function) -> None:
    together = function(ARGUMENTS, 1 - ARGUMENTS)
    alone = [function(np.array(y), np.array(1 - y)) for y in ARGUMENTS]
    assert together == pytest.approx(np.array(alone), rel=1e-14)


def test_complement_carries_the_digits_near_one() -> None:
    """At 1 - 1e-300 the argument is 1 to every digit, the logarithm is not infinite."""
    value = second_remainder(np.ones(NEAR_ONE.size), NEAR_ONE)
    assert value == pytest.approx(-np.log(NEAR_ONE) - 1, rel=1e-15)


def test_zero() -> None:
    assert second_remainder(np.zeros(2), np.ones(2)).tolist() == [0.5, 0.5]
    assert third_remainder(np.zeros(2), np.ones(2)) == pytest.approx(1 / 3, rel=1e-16)


def test_empty() -> None:
    assert second_remainder(np.empty(0), np.empty(0)).size == 0
