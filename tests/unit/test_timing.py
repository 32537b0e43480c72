"""Measured times: medians, spread and processor time of repeated runs."""

import math
import time

from bondcell.timing import ATTRIBUTES, Timing, timed


def test_quick_work_is_warmed_up_and_repeated():
    calls = []
    answer, timing = timed(lambda: calls.append(len(calls)) or len(calls), 3)
    assert (answer, len(calls)) == (4, 4)
    assert timing.seconds_spread >= 0
    assert 0 < timing.seconds < 1


def test_slow_work_counts_from_its_first_run():
    calls = []
    timed(lambda: calls.append(time.sleep(0.02)), 2, quick=0.01)
    assert len(calls) == 2


def test_sleep_is_no_processor_time():
    _, timing = timed(lambda: time.sleep(0.2), 1)
    assert timing.seconds >= 0.2
    assert timing.seconds_cpu < 0.1
    assert math.isnan(timing.seconds_spread)


def test_timing_of_one_among_many():
    per = Timing.of([2.0, 4.0, 3.0], [1.0, 1.0, 2.0]).per(10)
    assert (per.seconds, per.seconds_spread, per.seconds_cpu) == (0.3, 0.2, 0.1)
    assert set(ATTRIBUTES) == set(vars(per))
