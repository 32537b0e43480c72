import mpmath
import numpy as np
import pytest

from bondcell.models.jets import Curve, Jet


def test_a_curve_differentiates() -> None:
    x = Curve.variable(np.array([0.7]))
    got = (2.0 - x * x) / (1.0 + x).sqrt() - 0.5

    def function(t: mpmath.mpf) -> mpmath.mpf:
        return (2 - t * t) / mpmath.sqrt(1 + t) - mpmath.mpf("0.5")

    expected = [float(mpmath.diff(function, mpmath.mpf(0.7), n)) for n in range(3)]
    parts = [got.value[0], got.first[0], got.second[0]]
    assert parts == pytest.approx(expected, rel=1e-13)


def test_a_jet_differentiates() -> None:
    r, z = Jet.variables(np.array([0.7]), np.array([1.2]))
    got = (3.0 - (r * r + z).log()) * r / (z - 0.5 * r).sqrt()

    def function(a: mpmath.mpf, b: mpmath.mpf) -> mpmath.mpf:
        return (3 - mpmath.log(a * a + b)) * a / mpmath.sqrt(b - a / 2)

    point = (mpmath.mpf(0.7), mpmath.mpf(1.2))
    orders = [(0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2)]
    expected = [float(mpmath.diff(function, point, n)) for n in orders]
    assert got.parts[:, 0] == pytest.approx(expected, rel=1e-12)


def test_a_product_with_a_function_of_a_jet() -> None:
    r, z = Jet.variables(np.array([0.7]), np.array([1.2]))
    inner, base = r * z + 0.3, z * z - r
    parts = base.times_function_of(inner)
    x = inner.value
    derivatives = (np.exp(2 * x), 2 * np.exp(2 * x), 4 * np.exp(2 * x))
    got = sum(part * derivative for part, derivative in zip(parts, derivatives, strict=True))
    assert got == pytest.approx((base * inner.compose(*derivatives)).parts, rel=1e-14)
