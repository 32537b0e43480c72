"""Measured run times: quick runs are repeated, and told with their spread and processor time."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import nan
from statistics import median
from typing import TypeVar

Answer = TypeVar("Answer")

QUICK = 0.8
"""A first run shorter than this only warms caches and is not counted [s]."""


@dataclass(frozen=True)
class Timing:
    """What repeated runs of the same work took.

    Parameters
    ----------
    seconds
        Wall time, median [s].
    seconds_spread
        Wall time of the slowest run less that of the quickest [s]; NaN of a single run.
    seconds_cpu
        Processor time of all threads, median [s].
    """

    seconds: float
    seconds_spread: float
    seconds_cpu: float

    @classmethod
    def of(cls, wall: Sequence[float], cpu: Sequence[float]) -> Timing:
        """The timing of runs of these wall and processor times [s].

        Examples
        --------
        >>> Timing.of([3.0, 1.0, 2.0], [1.0, 1.0, 1.5])
        Timing(seconds=2.0, seconds_spread=2.0, seconds_cpu=1.0)
        """
        spread = max(wall) - min(wall) if len(wall) > 1 else nan
        return cls(median(wall), spread, median(cpu))

    def plus(self, other: Timing) -> Timing:
        """The timing of this work after another one, whose spread is not known."""
        seconds, cpu = self.seconds + other.seconds, self.seconds_cpu + other.seconds_cpu
        return Timing(seconds, self.seconds_spread, cpu)

    def per(self, count: int) -> Timing:
        """The timing of one of `count` alike pieces of the work."""
        return Timing(self.seconds / count, self.seconds_spread / count, self.seconds_cpu / count)


ATTRIBUTES = {
    "seconds": {"units": "s", "long_name": "wall time, median of the runs"},
    "seconds_spread": {
        "units": "s",
        "long_name": "wall time of the slowest run less that of the quickest",
    },
    "seconds_cpu": {"units": "s", "long_name": "processor time, median of the runs"},
}
"""How a file of results describes the fields of a `Timing`."""


def timed_once(work: Callable[[], Answer]) -> tuple[Answer, Timing]:
    """Answer of some work that is too long to be repeated, and what it takes."""
    return timed(work, 1, quick=0.0)


def timed(work: Callable[[], Answer], repeats: int, quick: float = QUICK) -> tuple[Answer, Timing]:
    """Answer of some work, and what it takes.

    Parameters
    ----------
    work
        Does the same whenever it is called.
    repeats
        Timed runs.
    quick
        A first run shorter than this is not counted, it warms caches [s].

    Returns
    -------
    tuple
        The last answer, and the timing of `repeats` runs.
    """
    wall: list[float] = []
    cpu: list[float] = []
    warm = False
    while len(wall) < repeats:
        started, worked = time.perf_counter(), time.process_time()
        answer = work()
        seconds = time.perf_counter() - started
        if warm or seconds > quick:
            wall.append(seconds)
            cpu.append(time.process_time() - worked)
        warm = True
    return answer, Timing.of(wall, cpu)
