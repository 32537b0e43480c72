"""The bond's exact series against 50 digits: rates, coefficients and K(t) in stiff cases."""

import importlib.util
from pathlib import Path

import mpmath as mp
import numpy as np
import pytest

from bondcell.prony.chain import Chain, merged
from bondcell.prony.springs import behind_spring, in_series, side_by_side

spec = importlib.util.spec_from_file_location(
    "prony_mpmath", Path(__file__).with_name("prony_mpmath.py")
)
reference = importlib.util.module_from_spec(spec)
spec.loader.exec_module(reference)


@pytest.fixture(autouse=True)
def fifty_digits():
    with mp.workdps(90):  # 50 digits of distances down to 1e-40 of a pole
        yield


def chain_of(end, strengths, times):
    return Chain(np.asarray(float(end)), *merged(np.asarray(strengths), np.asarray(times)))


def stiff_chain(kind, terms=24, seed=3):
    """Chains that a careless solver gets wrong."""
    rng = np.random.default_rng(seed)
    decades = 10.0 ** np.sort(rng.uniform(-15, 15, terms))
    even = rng.uniform(0.1, 1, terms)
    if kind == "one a decade":
        return chain_of(0.05, even, 10.0 ** np.linspace(-6, 5, terms))
    if kind == "thirty decades":
        return chain_of(1e-6, even, decades)
    if kind == "fluid":
        return chain_of(0.0, even, decades)
    if kind == "small weights":
        return chain_of(0.0, 10.0 ** rng.uniform(-30, 0, terms), decades)
    if kind == "one dominant":
        return chain_of(1e-9, np.where(np.arange(terms) == terms // 2, 1.0, 1e-12), decades)
    pairs = np.concatenate((decades, decades[:6] * (1 + 3e-16), decades[6:12] * (1 + 1e-9)))
    return chain_of(0.0, rng.uniform(0.1, 1, pairs.size), pairs)


KINDS = (
    "one a decade",
    "thirty decades",
    "fluid",
    "small weights",
    "one dominant",
    "clusters",
)


def assert_exact(chain, compliance):
    got = behind_spring(chain, compliance)
    series = reference.Equation(chain, compliance).series()
    assert reference.worst(got.times, series[1]) < 1e-15
    assert reference.worst(got.strengths, series[2]) < 1e-14
    assert reference.worst([got.equilibrium], [series[0]]) < 1e-15
    times = np.concatenate(([0.0], np.geomspace(got.times[0] / 10, got.times[-1] * 300, 25)))
    truth = [reference.relaxation(series, t) for t in times]
    assert reference.worst(got.relaxation(times), truth) < 1e-12


def test_check_value():
    chain = chain_of(1.0, [2.0, 3.0], [1.0, 10.0])
    got = behind_spring(chain, 0.25)
    np.testing.assert_allclose(got.times, [1.23742671727775, 16.1625732827223], rtol=1e-14)
    np.testing.assert_allclose(got.strengths, [0.360473327934477, 1.23952667206552], rtol=1e-14)
    assert got.equilibrium == 0.8


@pytest.mark.parametrize("compliance", [1e-12, 1e-3, 1.0, 1e12])
@pytest.mark.parametrize("kind", KINDS)
def test_series_in_fifty_digits(kind, compliance):
    assert_exact(stiff_chain(kind), compliance)


@pytest.mark.parametrize("spread", [pytest.param("even", marks=pytest.mark.slow), "log"])
def test_a_hundred_terms(spread):
    rng = np.random.default_rng(8)
    times = np.linspace(1, 2, 100) if spread == "even" else 10.0 ** rng.uniform(-15, 15, 100)
    with mp.workdps(50):
        assert_exact(chain_of(0.0, 10.0 ** rng.uniform(-6, 0, 100), times), 1.0)


def test_tiny_offsets_are_relative():
    """A Maxwell element of next to nothing is delayed by next to nothing, to full precision."""
    chain = chain_of(1.0, [1e-30, 1.0], [1.0, 10.0])
    got = behind_spring(chain, 1.0)
    np.testing.assert_allclose(got.strengths[0] / 1e-30, (9 / 28) ** 2, rtol=1e-14)
    assert_exact(chain, 1.0)


def test_many_springs_at_once_are_each_alone():
    chain = stiff_chain("clusters")
    compliances = np.array([[0.0, 1e-30, 1e-8], [1.0, 3e5, 1e12]])
    together = behind_spring(chain, compliances)
    assert together.strengths.shape == (2, 3, chain.count)
    for index in np.ndindex(2, 3):
        alone = behind_spring(chain, compliances[index])
        np.testing.assert_array_equal(together.times[index], alone.times)
        np.testing.assert_array_equal(together.strengths[index], alone.strengths)
    np.testing.assert_array_equal(together.strengths[0, 0], chain.strengths)


@pytest.mark.parametrize("fluid", [False, True])
def test_two_chains_in_series(fluid):
    """Against the harmonic sum in the Laplace variable, in 50 digits."""
    one = chain_of(0.0 if fluid else 0.3, [1.0, 2.0, 0.5], [1e-6, 1.0, 30.0])
    other = chain_of(2.0, [1.0, 1e-3, 4.0], [1e-3, 1.0, 31.0])
    both = in_series(one, other)
    assert both.count == 6
    assert (both.equilibrium == 0) == fluid

    def at(chain, s):
        terms = zip(chain.strengths, chain.times, strict=True)
        end = reference.exact(chain.equilibrium)
        return end + mp.fsum(
            reference.exact(x) * s * reference.exact(t) / (1 + s * reference.exact(t))
            for x, t in terms
        )

    for s in (mp.mpf(10) ** k for k in range(-8, 9)):
        x, y = at(one, s), at(other, s)
        truth = x * y / (x + y)
        assert abs(at(both, s) - truth) < 1e-14 * truth


def test_side_by_side_adds():
    one = chain_of(1.0, [1.0, 2.0], [1.0, 2.0])
    other = chain_of(0.5, [3.0], [2.0])
    both = side_by_side(one, other)
    np.testing.assert_array_equal(both.strengths, [1.0, 5.0])
    assert both.equilibrium == 1.5
