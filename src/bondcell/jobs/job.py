"""What every job of a workflow does around its work: one line at its end, or one clear error."""

from __future__ import annotations

import atexit
import gc
import os
import sys
import time
import warnings
from collections.abc import Iterator
from contextlib import contextmanager

from bondcell.errors import BondcellError, InputError
from bondcell.jobs.progress import CLEAR, JOB_FILE

# Imported code lives as long as its process: the last collection would walk it all for 0.2 s.
atexit.register(gc.freeze)

EXIT_FAILED, EXIT_BAD_INPUT = 1, 2
PROGRESS_SECONDS = 10.0
"""Time between two lines on the progress of a long job [s]."""


class Log:
    """The line that a job prints when it ends, and its progress before."""

    def __init__(self, name: str) -> None:
        self.name = name
        self.result = "done"
        self.unit = "points"
        self._start = self._last = time.perf_counter()

    def progress(self, done: int, total: int) -> None:
        """Print how far the job is, at most every `PROGRESS_SECONDS`."""
        now = time.perf_counter()
        if now - self._last >= PROGRESS_SECONDS and done < total:
            self._last = now
            self.say(f"{done}/{total} {self.unit}, {now - self._start:.0f} s so far")

    def close(self) -> None:
        """Print the result and the time it took, imports not included."""
        self.say(f"{self.result}, {time.perf_counter() - self._start:.2f} s")

    def say(self, text: str) -> None:
        """Print a line under the job's name, or tell it to who shows the run in one line."""
        lines = os.environ.get(JOB_FILE)
        if lines is None:
            print(f"{self.name}: {text}", file=sys.stderr, flush=True)
        else:
            with open(lines, "a", encoding="utf-8") as file:
                file.write(f"{self.name}: {text}\n")

    def warn(self, text: str) -> None:
        """Print a line that must be seen, on a line of its own."""
        clear = CLEAR if JOB_FILE in os.environ else ""
        print(f"{clear}{self.name}: {text}", file=sys.stderr, flush=True)


@contextmanager
def job(name: str) -> Iterator[Log]:
    """Run the block as a job: what goes wrong in a known way ends it with one message.

    The exit status is 2 after bad input and 1 after anything else, a full disk for instance.

    Parameters
    ----------
    name
        What the job's lines begin with.

    Examples
    --------
    >>> with job("figure4 analytic") as log:
    ...     log.result = "25/25 points"
    """
    log = Log(name)
    with warnings.catch_warnings():
        warnings.showwarning = lambda message, *_: log.warn(f"warning: {message}")
        try:
            yield log
        except BondcellError as error:
            log.warn(f"error: {error}")
            status = EXIT_BAD_INPUT if isinstance(error, InputError) else EXIT_FAILED
            raise SystemExit(status) from error
    log.close()
