"""Bounds of a job's memory and time: exceeded once it is tried again, at last points are flagged.

Every attempt of a job has larger bounds (the workflow's rules scale them). An attempt that exceeds
them ends with a message. The last attempt solves each geometry in a process of its own: what
exceeds the bounds then, or takes its process down, costs its own points only.
"""

from __future__ import annotations

import faulthandler
import multiprocessing
import os
import resource
import signal
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from multiprocessing.connection import Connection
from typing import Any

from bondcell.errors import BoundExceeded, PointLost

SHARE = 0.9
"""Part of a job's bounds that its work may use: the rest is for its start and its end."""

GRACE = 60.0
"""Time after which a job ends that could not react to its bound [s]."""

Call = Callable[..., Any]


@dataclass(frozen=True)
class Bounds:
    """What one attempt of a job may use.

    Parameters
    ----------
    seconds
        Wall time [s].
    megabytes
        Memory [MB].
    attempt, attempts
        Which attempt this is, and how many there are at most.
    """

    seconds: float
    megabytes: float
    attempt: int = 1
    attempts: int = 1
    _start: float = field(default_factory=time.monotonic, repr=False)

    @property
    def is_last(self) -> bool:
        """Whether no attempt follows."""
        return self.attempt >= self.attempts

    @property
    def left(self) -> float:
        """Time that the work still has [s]."""
        return SHARE * self.seconds - (time.monotonic() - self._start)

    @contextmanager
    def held(self) -> Iterator[None]:
        """Keep this process to the bounds while the block runs.

        An attempt before the last ends itself with status 1 when its time is over; of the last one
        only the processes that solve are bounded.
        """
        faulthandler.dump_traceback_later(self.seconds + GRACE, exit=True)
        before = resource.getrlimit(resource.RLIMIT_DATA)
        handler = signal.signal(signal.SIGALRM, self._over_time)
        if not self.is_last:
            _bound_memory(self.megabytes)
            signal.setitimer(signal.ITIMER_REAL, max(self.left, 1e-3))
        try:
            yield
        finally:
            signal.setitimer(signal.ITIMER_REAL, 0.0)
            signal.signal(signal.SIGALRM, handler)
            resource.setrlimit(resource.RLIMIT_DATA, before)
            faulthandler.cancel_dump_traceback_later()

    def bounded(self, solve: Call) -> Call:
        """A solver that keeps to the bounds.

        Parameters
        ----------
        solve
            Any function; its arguments and its answer can be pickled.

        Returns
        -------
        callable
            Does the same. It raises `BoundExceeded` when the memory is not enough, and in the last
            attempt `PointLost` for that, for time, and for a process that was killed.
        """

        def here(*arguments: Any, **options: Any) -> Any:
            try:
                return solve(*arguments, **options)
            except MemoryError as error:
                raise BoundExceeded(self._said(f"{self.megabytes:g} MB")) from error

        def apart(*arguments: Any, **options: Any) -> Any:
            return self._apart(lambda: solve(*arguments, **options))

        return apart if self.is_last else here

    def _apart(self, call: Call) -> Any:
        """Answer of a call in a process of its own, in at most half of the time that is left."""
        allowance = self.left / 2
        if allowance <= 0:
            raise PointLost(self._said(f"{self.seconds:g} s"))
        fork = multiprocessing.get_context("fork")
        receive, send = fork.Pipe(duplex=False)
        child = fork.Process(target=_answer, args=(send, call, self.megabytes))
        child.start()
        send.close()
        try:
            if not receive.poll(allowance):
                raise PointLost(f"{self._said(f'{self.seconds:g} s')}, {allowance:.3g} s for these")
            answer, error = receive.recv()
        except EOFError:
            child.join()
            raise PointLost(f"the process that solved ended with {child.exitcode}") from None
        finally:
            child.kill()
            child.join()
            receive.close()
        if isinstance(error, MemoryError):
            raise PointLost(self._said(f"{self.megabytes:g} MB"))
        if error is not None:
            raise error
        return answer

    def _over_time(self, *_: object) -> None:
        print(f"error: {self._said(f'{self.seconds:g} s')}", file=sys.stderr, flush=True)
        os._exit(1)

    def _said(self, bound: str) -> str:
        then = "the last one" if self.is_last else "the next has more"
        return f"over the bound of {bound} in attempt {self.attempt} of {self.attempts}, {then}"


def _answer(send: Connection, call: Call, megabytes: float) -> None:
    """Send what a call gives, or raises."""
    _bound_memory(megabytes)
    try:
        send.send((call(), None))
    except Exception as error:
        send.send((None, error))


def _bound_memory(megabytes: float) -> None:
    hard = resource.getrlimit(resource.RLIMIT_DATA)[1]
    wanted = int(SHARE * megabytes * 1e6)
    soft = wanted if hard == resource.RLIM_INFINITY else min(wanted, hard)
    resource.setrlimit(resource.RLIMIT_DATA, (soft, hard))
