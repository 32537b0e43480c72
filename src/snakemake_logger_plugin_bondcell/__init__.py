"""Snakemake's messages in one line: points done, the scene at work, the time that is left.

Snakemake finds it by its name; the profiles ask for it with ``logger: bondcell``. A terminal shows
one line that is painted again and again; a file gets a plain line now and then. Warnings, errors
and what a dry run says pass as Snakemake words them; its log file has everything as ever.
"""

from __future__ import annotations

import logging
import os
import shutil
import sys
import threading
from pathlib import Path
from time import monotonic
from typing import TextIO

from snakemake_interface_logger_plugins.base import LogHandlerBase
from snakemake_interface_logger_plugins.common import LogEvent

from bondcell.jobs.progress import CLEAR, JOB_FILE, RUN

PAINTED_EVERY, PLAIN_EVERY = 1.0, 15.0
"""Time between two lines on a terminal and in a file [s]."""

SILENT = {
    LogEvent.JOB_INFO,
    LogEvent.GROUP_INFO,
    LogEvent.JOB_STARTED,
    LogEvent.JOB_FINISHED,
    LogEvent.PROGRESS,
    LogEvent.RESOURCES_INFO,
    LogEvent.RUN_INFO,
    LogEvent.SHELLCMD,
    LogEvent.WORKFLOW_STARTED,
}
"""What the line replaces."""

CHATTER = (
    "Building DAG",
    "Select jobs",
    "Execute ",
    "host: ",
    "Assuming unrestricted",
    "Using shell",
    "Provided ",
    "Rules claiming",
    "Touching ",
    "Removing ",
    "Storing ",
    "Workflow runtime",
    "Elapsed time",
)
"""Begin of messages that nobody misses."""


class LogHandler(LogHandlerBase):
    """Shows `bondcell.jobs.progress.RUN`."""

    def __post_init__(self) -> None:
        """Choose the stream and how it is written to."""
        self.stream: TextIO = sys.stdout if self.common_settings.stdout else sys.stderr
        self.plain = not self.stream.isatty() or os.environ.get("TERM") == "dumb"
        self.shown = ""
        self.last = 0.0
        self.lines: Path | None = None
        self.read = 0
        self.over = threading.Event()
        self.painter: threading.Thread | None = None

    writes_to_stream = True
    writes_to_file = False
    has_filter = False
    has_formatter = False
    needs_rulegraph = False

    def emit(self, record: logging.LogRecord) -> None:
        """Count an event, or let a message pass."""
        event = getattr(record, "event", None)
        if self.common_settings.dryrun or record.levelno >= logging.WARNING:
            self._pass(record)
            return
        now = monotonic()
        if event == LogEvent.JOB_STARTED:
            RUN.start(getattr(record, "jobs", None) or [], now)
            self._begin()
        elif event == LogEvent.JOB_FINISHED:
            RUN.finish(record.job_id)  # type: ignore[attr-defined]
        if event in SILENT:
            self._show(now, ended=event == LogEvent.PROGRESS and self._is_over(record))
        elif event != LogEvent.SHELLCMD and not str(record.getMessage()).startswith(CHATTER):
            self._pass(record)

    def _is_over(self, record: logging.LogRecord) -> bool:
        return bool(getattr(record, "done", 0) == getattr(record, "total", -1))

    def _pass(self, record: logging.LogRecord) -> None:
        """A message as Snakemake words it, above the line."""
        text = self.format(record)
        if text.strip():
            self._clear()
            self.stream.write(f"{text.strip()}\n")
            self.stream.flush()

    def _begin(self) -> None:
        """On a terminal: have the jobs tell a file, and paint from time to time."""
        if self.plain or self.painter is not None:
            return
        self.lines = Path(".snakemake", "log", f"jobs.{os.getpid()}.log").absolute()
        os.environ[JOB_FILE] = str(self.lines)
        self.painter = threading.Thread(target=self._paint, daemon=True)
        self.painter.start()

    def _paint(self) -> None:
        while not self.over.wait(PAINTED_EVERY):
            self.acquire()
            try:
                self._show(monotonic())
            finally:
                self.release()

    def _show(self, now: float, ended: bool = False) -> None:
        if not RUN.jobs:
            return
        every = PLAIN_EVERY if self.plain else 0.0
        if not ended and now - self.last < every:
            return
        self.last = now
        self._listen()
        line = RUN.line(now)
        if self.plain or ended:
            self._clear()
            self.stream.write(f"{line}\n")
        else:
            width = shutil.get_terminal_size().columns - 1
            self.shown = line[:width]
            # The cursor goes back to the start: what a job prints does not begin in mid-line.
            self.stream.write(f"{CLEAR}{self.shown}\r")
        self.stream.flush()

    def _listen(self) -> None:
        """What the jobs told since the last time."""
        if self.lines is None or not self.lines.is_file():
            return
        with self.lines.open(encoding="utf-8") as file:
            file.seek(self.read)
            for line in file:
                RUN.heard(line)
            self.read = file.tell()

    def _clear(self) -> None:
        if self.shown:
            self.stream.write(CLEAR)
            self.shown = ""

    def close(self) -> None:
        """Stop painting, leave a clean line."""
        self.over.set()
        os.environ.pop(JOB_FILE, None)
        if self.stream is not None and not self.stream.closed:
            self._clear()
            self.stream.flush()
        super().close()
