"""``bondcell validate``: every violation in parameter files."""

from __future__ import annotations

import argparse
import sys
from typing import Any


def add_to(commands: Any) -> None:
    """Add the subcommand and its options."""
    parser = commands.add_parser(
        "validate",
        help="check scene files",
        description="Check scene files, or lists of scenes: every violation, one a line.",
        allow_abbrev=False,
    )
    parser.set_defaults(run=run)
    parser.add_argument("files", nargs="+", metavar="FILE", help="a YAML file")


def run(arguments: argparse.Namespace) -> int:
    """Print every violation on stderr and the good files on stdout; 2 if any file is bad."""
    from bondcell.scenes.validate import validate_file

    status = 0
    for path in arguments.files:
        violations, odd = validate_file(path)
        for line in odd:
            print(f"bondcell: warning: {line}", file=sys.stderr)
        for violation in violations:
            print(f"{path}: {violation}", file=sys.stderr)
        if violations:
            status = 2
        else:
            print(f"{path}: valid")
    return status
