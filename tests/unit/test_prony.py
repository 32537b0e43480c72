"""A Prony series as given: references, merging, errors, moduli; and the shift with temperature."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import bondcell
from bondcell.prony.chain import Chain
from bondcell.prony.prony import Prony, PronyError
from bondcell.prony.shift import arrhenius, wlf
from bondcell.prony.springs import behind_spring

TWELVE = {
    1.5e7: 14.3,
    8.005e5: 32.1,
    4.272e4: 74.2,
    2280.0: 179.6,
    121.7: 458.8,
    6.493: 1232.0,
    0.3465: 2956.0,
    0.01849: 5286.0,
    9.869e-4: 6531.0,
    5.267e-5: 5727.0,
    2.811e-6: 3848.0,
    1.5e-7: 2160.0,
}


def test_the_three_references_agree():
    long_term, moduli, times = 412.8e6, np.array([*TWELVE.values()]) * 1e6, [*TWELVE]
    whole = long_term + moduli.sum()
    one = Prony(moduli, times, "absolute", long_term=long_term)
    two = Prony(moduli / whole, times)
    three = Prony(moduli / long_term, times, "long_term")
    for other in (two, three):
        np.testing.assert_allclose(one.shear.strengths, other.shear.strengths, rtol=1e-14)
        np.testing.assert_allclose(one.shear.equilibrium, other.shear.equilibrium, rtol=1e-12)
    assert one.instantaneous_modulus == pytest.approx(whole, rel=1e-15)
    assert two.instantaneous_modulus is None
    assert three.growth[0] == pytest.approx(whole / long_term, rel=1e-14)


def test_weights_that_sum_to_one_are_a_fluid():
    rng = np.random.default_rng(1)
    for terms in (1, 3, 10, 100):
        weights = rng.random(terms)
        prony = Prony(weights / weights.sum(), np.geomspace(1e-15, 1e15, terms))
        assert prony.is_fluid
        assert prony.relaxation_modulus([np.inf])[0] == 0.0
    solid = Prony([1e20], [1.0], "long_term")
    assert solid.shear.equilibrium == pytest.approx(1e-20, rel=1e-15)


def test_equal_times_merge_and_zero_weights_go():
    prony = Prony([0.1, 0.0, 0.2, 0.3], [5.0, 1.0, 5.0, 2.0])
    np.testing.assert_allclose(prony.shear.strengths, [0.3, 0.3], rtol=1e-15)
    np.testing.assert_array_equal(prony.shear.times, [2.0, 5.0])
    assert Prony([], []).shear.count == 0


def test_all_violations_at_once():
    with pytest.raises(bondcell.InputError) as caught:
        Prony([0.5, -0.1, np.nan], [1.0, 0.0], "sometimes", bulk_weights=[0.9, 0.2])
    fields = [violation.field for violation in caught.value.violations]
    assert fields == [
        "relative_to",
        "weights[1]",
        "weights[2]",
        "times[1]",
        "times",
        "bulk_times",
    ]
    assert isinstance(caught.value, PronyError)


@pytest.mark.parametrize(
    ("arguments", "field"),
    [
        ({"weights": [0.7, 0.4]}, "sum of weights"),
        ({"weights": [1e9, 1e9], "relative_to": "absolute"}, "long_term"),
        ({"weights": [0.1, 0.1], "long_term": 1.0}, "long_term"),
        ({"weights": [0.0, 0.0], "relative_to": "absolute", "long_term": 0.0}, "sum of weights"),
        ({"weights": "ab"}, "weights"),
        ({"weights": [0.1, 0.1], "modulus": "young"}, "modulus"),
        ({"weights": [0.1, 0.1], "bulk_long_term": 1.0}, "bulk_long_term"),
        ({"weights": [0.1, 0.1], "bulk_weights": [1.5], "bulk_times": [1.0]}, "sum of bulk"),
    ],
)
def test_each_violation(arguments, field):
    with pytest.raises(PronyError) as caught:
        Prony(**({"times": [1.0, 2.0]} | arguments))
    assert any(violation.field.startswith(field) for violation in caught.value.violations)


def test_dynamic_moduli_of_one_element():
    prony, w = Prony([0.75], [2.0]), np.array([0.0, 0.5, 1e300])
    np.testing.assert_allclose(prony.storage_modulus(w), [0.25, 0.625, 1.0], rtol=1e-15)
    np.testing.assert_allclose(prony.loss_modulus(w), [0.0, 0.375, 0.0], atol=1e-290)
    np.testing.assert_allclose(prony.loss_factor(w), [0.0, 0.6, 0.0], atol=1e-290)
    assert Prony([1.0], [1.0]).loss_factor([0.0])[0] == np.inf


def test_shift_moves_every_time():
    prony = Prony([0.5, 0.2], [1.0, 10.0], bulk_weights=[0.1], bulk_times=[3.0])
    moved = prony.shifted(0.01)
    np.testing.assert_allclose(moved.shear.times, [0.01, 0.1])
    np.testing.assert_allclose(moved.bulk.times, [0.03])
    np.testing.assert_array_equal(prony.shear.times, [1.0, 10.0])
    with pytest.raises(PronyError, match="factor"):
        prony.shifted(-1.0)


def test_shift_factors():
    assert wlf(20.0, 20.0, 17.44, 51.6) == 1.0
    assert np.log10(wlf(1e9, 0.0, 17.44, 51.6)) == pytest.approx(-17.44, rel=1e-6)
    assert arrhenius(300.0, 300.0, 2e5) == 1.0
    slope = np.log(arrhenius(300.01, 300.0, 2e5)) / 0.01
    assert slope == pytest.approx(-2e5 / 8.31446261815324 / 300.0**2, rel=1e-4)
    with pytest.raises(bondcell.InputError, match=r"c_1.*\n.*c_2"):
        wlf(20.0, 20.0, -1.0, np.nan)
    with pytest.raises(bondcell.InputError, match="temperature"):
        wlf([20.0, -40.0], 20.0, 17.44, 51.6)
    with pytest.raises(bondcell.InputError, match=r"temperature.*\n.*reference.*\n.*energy"):
        arrhenius(-1.0, 0.0, -5.0)


terms = st.lists(st.tuples(st.floats(1e-9, 1.0), st.floats(-15.0, 15.0)), min_size=1, max_size=12)


@given(terms, st.floats(-12, 12), st.just(0.0) | st.floats(1e-12, 2.0))
def test_springs_in_series_are_completely_monotone(pairs, log_compliance, end):
    """Positive terms, both ends right, between the spring and the chain at every time."""
    weights, logs = np.array(pairs).T
    total = weights.sum() + end
    prony = Prony(weights / total, 10.0**logs) if end == 0 else None
    chain = prony.shear if prony else Prony(weights / end, 10.0**logs, "long_term").shear
    b = 10.0**log_compliance
    result = behind_spring(chain, b)
    assert (result.strengths > 0).all()
    assert (result.times > chain.times * (1 - 1e-15)).all()
    np.testing.assert_allclose(result.instantaneous, 1 / (1 + b), rtol=1e-12)
    g = float(chain.equilibrium)
    np.testing.assert_allclose(result.equilibrium, g / (1 + b * g), rtol=1e-14)
    values = result.relaxation(np.concatenate(([0.0], np.geomspace(1e-18, 1e18, 60), [np.inf])))
    assert (np.diff(values) <= 1e-15 * values[0]).all()


def test_a_chain_in_the_laplace_variable():
    chain = Chain(np.array(1.0), np.array([2.0]), np.array([4.0]))
    np.testing.assert_allclose(chain.transform([0.0, 0.25, np.inf]), [1.0, 2.0, 3.0])


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda p: p.relaxation_modulus([-1.0]), r"time = -1\.0: .*\[0, inf\]"),
        (lambda p: p.relaxation_modulus("now"), "time = 'now'"),
        (lambda p: p.storage_modulus([np.nan]), "frequency = nan"),
        (lambda p: p.loss_modulus([[1.0]]), r"frequency = \[\[1\.0\]\]"),
        (lambda p: p.loss_factor([]), r"frequency = \[\]"),
        (lambda p: p.shifted("warm"), "factor = 'warm'"),
        (lambda p: p.shifted(1e300), r"times\[0\] = 1\.0: .*after the shift"),
    ],
)
def test_wrong_times_and_frequencies(call, message):
    with pytest.raises(bondcell.InputError, match=message):
        call(Prony([0.5], [1.0]))
