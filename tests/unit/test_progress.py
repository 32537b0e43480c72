"""How far a run is: what is counted, what a terminal and a file see, what passes."""

import io
import logging
import os
import time
from types import SimpleNamespace

import pytest
from snakemake_interface_logger_plugins.common import LogEvent

from bondcell.jobs.job import job
from bondcell.jobs.progress import CLEAR, JOB_FILE, RUN, Planned, Progress
from snakemake_logger_plugin_bondcell import LogHandler

JOBS = {
    1: Planned("a: fe_roller_1of2", "a", "reference", 40),
    2: Planned("a: fe_roller_2of2", "a", "reference", 60),
    3: Planned("a: collect", "a", "collect"),
}


def test_time_left_falls_to_nothing():
    run = Progress()
    run.plan(JOBS, now=100.0)
    assert run.seconds_left(100.0) is None
    left = []
    for number, known in JOBS.items():
        run.start([number], now=100.0 + 10 * number)
        left.append(run.seconds_left(101.0 + 10 * number))
        run.finish(number)
        assert known.seconds > 0
    left.append(run.seconds_left(140.0))
    assert left == sorted(left, reverse=True)
    assert left[-1] == 0
    assert run.line(140.0) == "100/100 points, 3/3 jobs  in 40 s"


def test_quicker_machine_less_left():
    def left(elapsed):
        run = Progress()
        run.plan(JOBS, now=0.0)
        run.start([1], now=0.0)
        run.finish(1)
        return run.seconds_left(elapsed)

    assert left(1.0) < left(10.0) < left(100.0)


def test_jobs_of_another_run_do_not_count():
    run = Progress()
    run.plan(JOBS, now=0.0)
    run.start([9], now=0.0)
    run.finish(9)
    run.heard("a: fe_roller_1of2: nonsense")
    run.heard("b: fe_roller_1of2: 5/40 points, 10 s so far")
    assert run.line(1.0).startswith("0/100 points, 0/3 jobs")


class Terminal(io.StringIO):
    def isatty(self):
        return True


@pytest.fixture
def make_handler(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("TERM", "xterm")
    monkeypatch.delenv(JOB_FILE, raising=False)
    (tmp_path / ".snakemake" / "log").mkdir(parents=True)
    made = []

    def make(stream, dryrun=False):
        monkeypatch.setattr("sys.stderr", stream)
        handler = LogHandler(SimpleNamespace(stdout=False, dryrun=dryrun), None)
        handler.setFormatter(logging.Formatter("%(message)s"))
        made.append(handler)
        return handler

    RUN.plan(JOBS, time.monotonic())
    yield make
    for handler in made:
        handler.close()
    RUN.plan({}, 0.0)


def tell(handler, event=None, text="", level=logging.INFO, **fields):
    record = logging.makeLogRecord({"msg": text, "levelno": level, "event": event, **fields})
    handler.handle(record)


def run_all(handler):
    for number in JOBS:
        tell(handler, LogEvent.JOB_INFO, f"rule {number}")
        tell(handler, LogEvent.JOB_STARTED, jobs=[number])
        tell(handler, LogEvent.JOB_FINISHED, f"Finished {number}", job_id=number)
        tell(handler, LogEvent.PROGRESS, done=number, total=len(JOBS))


def test_file_gets_few_plain_lines(make_handler):
    stream = io.StringIO()
    run_all(make_handler(stream))
    lines = stream.getvalue().splitlines()
    assert len(lines) == 2
    assert lines[-1].startswith("100/100 points, 3/3 jobs  in ")
    assert "\x1b" not in stream.getvalue()
    assert JOB_FILE not in os.environ


def test_terminal_is_painted_on_one_line(make_handler):
    stream = Terminal()
    handler = make_handler(stream)
    run_all(handler)
    assert stream.getvalue().count("\n") == 1
    painted = stream.getvalue().split(CLEAR)
    assert any(text.startswith("0/100 points, 0/3 jobs  a: reference") for text in painted)
    assert all(len(text) < 80 for text in painted)


def test_jobs_tell_a_file_while_a_terminal_is_painted(make_handler, capsys):
    handler = make_handler(Terminal())
    tell(handler, LogEvent.JOB_STARTED, jobs=[2])
    with job("a: fe_roller_2of2") as log:
        log._last = -1e9
        log.progress(33, 60)
    tell(handler, LogEvent.RESOURCES_INFO)
    assert handler.shown.startswith("33/100 points")
    handler.close()
    assert JOB_FILE not in os.environ


def test_errors_of_jobs_are_seen_anyway(make_handler):
    from bondcell.errors import InputError, Violation

    stream = Terminal()
    handler = make_handler(stream)
    tell(handler, LogEvent.JOB_STARTED, jobs=[1])
    with pytest.raises(SystemExit), job("a: fe_roller_1of2"):
        raise InputError([Violation("gap", -1, "(0, inf) m")])
    assert f"{CLEAR}a: fe_roller_1of2: error: gap = -1" in stream.getvalue()


def test_errors_and_messages_pass_chatter_does_not(make_handler):
    stream = io.StringIO()
    handler = make_handler(stream)
    tell(handler, LogEvent.JOB_ERROR, "Error in rule reference, jobid: 1", logging.ERROR)
    tell(handler, None, "Nothing to be done (all requested files are present).")
    tell(handler, None, "Building DAG of jobs...")
    tell(handler, LogEvent.SHELLCMD, "rm -rf x")
    lines = [line for line in stream.getvalue().splitlines() if "points, " not in line]
    assert [line.split()[0] for line in lines] == ["Error", "Nothing"]


def test_dry_run_says_all(make_handler):
    stream = io.StringIO()
    handler = make_handler(stream, dryrun=True)
    tell(handler, LogEvent.RUN_INFO, "Job stats: 3")
    tell(handler, LogEvent.JOB_INFO, "rule collect")
    assert stream.getvalue().splitlines() == ["Job stats: 3", "rule collect"]
