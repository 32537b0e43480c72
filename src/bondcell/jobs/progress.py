"""How far a run of the workflow is: points done, the scene at work, the time that is left."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass, field

JOB_FILE = "BONDCELL_JOB_LINES"
"""Variable of the environment: file that takes the lines of the jobs in place of the terminal."""

CLEAR = "\r\x1b[K"
"""Takes the line away that a terminal shows."""

SECONDS: dict[str, tuple[float, float]] = {
    "analytic": (2.0, 2e-5),
    "reference": (2.0, 0.03),
    "relaxation_models": (2.0, 0.5),
    "relaxation_fe": (2.0, 0.5),
    "relaxation_methods": (6.0, 0.0),
    "convergence": (15.0, 0.0),
    "specimen_part": (6.0, 0.0),
    "specimen_elastic": (18.0, 0.0),
    "figures": (5.0, 0.0),
    "report": (6.0, 0.0),
}
"""Rule -> about what one of its jobs takes, start included, and what each point adds [s].

They weigh the jobs against each other; how quick the machine is, the run itself tells.
"""

OTHERS = (2.5, 0.0)
"""The same for every other rule."""

POINT_RULES = ("analytic", "reference", "relaxation_models", "relaxation_fe")
"""Rules whose jobs compute points of a scene's sweep."""

_LINE = re.compile(r"^(?P<name>[a-z]\w*: \w+): (?P<done>\d+)/\d+ points, \d+ s so far$")


@dataclass(frozen=True)
class Planned:
    """A job that is going to run.

    Parameters
    ----------
    name
        What the job's own lines begin with, ``<scene>: <batch>``.
    scene
        Its scene, empty for jobs of none.
    rule
        Its rule.
    points
        Points that it computes.
    """

    name: str
    scene: str
    rule: str
    points: int = 0

    @property
    def seconds(self) -> float:
        """About what it takes [s]."""
        once, each = SECONDS.get(self.rule, OTHERS)
        return once + each * self.points


@dataclass
class Progress:
    """What is planned, what runs and what is done.

    Examples
    --------
    >>> run = Progress()
    >>> reference = Planned("a: fe_roller_1of1", "a", "reference", 40)
    >>> run.plan({1: reference, 2: Planned("a: collect", "a", "collect")}, now=0.0)
    >>> run.start([1], now=0.0)
    >>> run.heard("a: fe_roller_1of1: 10/40 points, 12 s so far")
    >>> run.line(now=3.0)
    '10/40 points, 0/2 jobs  a: reference  about 3 s left'
    >>> run.finish(1)
    >>> run.line(now=4.0)
    '40/40 points, 1/2 jobs  about 3 s left'
    """

    jobs: dict[int, Planned] = field(default_factory=dict)
    running: dict[int, float] = field(default_factory=dict)
    done: set[int] = field(default_factory=set)
    partly: dict[str, int] = field(default_factory=dict)
    began: float = 0.0

    def plan(self, jobs: dict[int, Planned], now: float) -> None:
        """Begin a run of these jobs."""
        self.jobs = dict(jobs)
        self.running, self.done, self.partly = {}, set(), {}
        self.began = now

    def start(self, jobs: Iterable[int], now: float) -> None:
        """Jobs began."""
        self.running |= dict.fromkeys(jobs, now)

    def finish(self, job: int) -> None:
        """A job ended well."""
        self.running.pop(job, None)
        if job in self.jobs:
            self.done.add(job)

    def heard(self, line: str) -> None:
        """A job said how far it is."""
        found = _LINE.match(line.strip())
        if found:
            self.partly[found["name"]] = int(found["done"])

    @property
    def points(self) -> tuple[int, int]:
        """Points done, those of running jobs as far as they told, and all."""
        known = self.jobs
        finished = sum(known[job].points for job in self.done)
        partly = [self.partly.get(known[job].name, 0) for job in self.running if job in known]
        return finished + sum(partly), sum(job.points for job in known.values())

    def seconds_left(self, now: float) -> float | None:
        """Time to the end as far as it can be said [s]."""
        whole = sum(job.seconds for job in self.jobs.values())
        done = sum(self.jobs[job].seconds for job in self.done)
        for job, began in self.running.items():
            if job in self.jobs:
                expected = self.jobs[job].seconds
                done += min(now - began, 0.9 * expected)
        elapsed = max(now - self.began, 0.0)
        if (not self.running and not self.done) or done <= 0:
            return None
        # The first seconds say little about the machine: a pace of one is assumed before.
        pace = (done + 5.0) / (elapsed + 5.0)
        return max(whole - done, 0.0) / pace

    def line(self, now: float) -> str:
        """All of it in one line."""
        points, all_points = self.points
        words = [f"{points}/{all_points} points, "] if all_points else [""]
        words[0] += f"{len(self.done)}/{len(self.jobs)} jobs"
        here = [self.jobs[job] for job in self.running if job in self.jobs]
        words += list(
            dict.fromkeys(f"{job.scene}: {job.rule}" if job.scene else job.rule for job in here)
        )[:2]
        left = self.seconds_left(now)
        if len(self.done) == len(self.jobs):
            words.append(f"in {spoken(now - self.began)}")
        elif left is not None:
            words.append(f"about {spoken(left)} left")
        return "  ".join(words)


def spoken(seconds: float) -> str:
    """A time as it is said.

    Examples
    --------
    >>> spoken(4.2), spoken(83), spoken(4000)
    ('5 s', '1 min 30 s', '1 h 10 min')
    """
    if seconds < 60:
        return f"{max(int(seconds) + 1, 1)} s" if seconds < 10 else f"{5 * -(-int(seconds) // 5)} s"
    if seconds < 3600:
        minutes, rest = divmod(10 * -(-int(seconds) // 10), 60)
        return f"{minutes} min {rest} s" if rest else f"{minutes} min"
    hours, rest = divmod(10 * -(-int(seconds) // 600), 60)
    return f"{hours} h {rest} min" if rest else f"{hours} h"


RUN = Progress()
"""The run of this process: planned by the Snakefile, told by the logger plugin."""
