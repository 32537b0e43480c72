"""Plans in one process: what Snakemake would do after each of many edits, or for each target.

Reads as JSON, in the workspace's folder, ``{name: [file, old, new]}``, of which each file is as
before afterwards, or a list of targets; writes ``{name or target: output}``.
"""

import contextlib
import io
import json
import os
import sys
from pathlib import Path

from snakemake.cli import main


def plan(*targets: str) -> str:
    """Output of a dry run, of the default target without another."""
    output = io.StringIO()
    with contextlib.redirect_stdout(output), contextlib.redirect_stderr(output):
        try:
            main(["--dry-run", "--cores", "2", *targets])
        except SystemExit as done:
            print(f"exit status {done.code}")
    return output.getvalue()


def plan_after(file: str, old: str, new: str) -> str:
    """Output of a dry run while `old` is replaced by `new`, or a comment added, in a file."""
    path = Path(file)
    before, times = path.read_text(), path.stat()
    assert old in before
    path.write_text(before.replace(old, new) if old else before + "\n# edited\n")
    try:
        return plan()
    finally:
        path.write_text(before)
        os.utime(path, ns=(times.st_atime_ns, times.st_mtime_ns))


if __name__ == "__main__":
    asked = json.load(sys.stdin)
    if isinstance(asked, dict):
        answers = {name: plan_after(*edit) for name, edit in asked.items()}
    else:
        answers = {target: plan(target) for target in asked}
    json.dump(answers, sys.stdout)
