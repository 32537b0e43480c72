"""``bondcell validate``: every violation in parameter files."""

from __future__ import annotations

import argparse
import json
import sys
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from bondcell.scenes.validate import Findings

GOOD, BAD = 0, 2


def add_to(commands: Any) -> None:
    """Add the subcommand and its options."""
    parser = commands.add_parser(
        "validate",
        help="check scene files",
        description="Check scene files, or lists of scenes: every violation, one a line.",
        epilog="example: bondcell validate params/*.yaml",
        allow_abbrev=False,
    )
    parser.set_defaults(run=run)
    parser.add_argument("files", nargs="+", metavar="FILE", help="a YAML file")
    parser.add_argument("--json", action="store_true", help="print JSON, for programs")


def run(arguments: argparse.Namespace) -> int:
    """Print every violation on stderr and the good files on stdout; 2 if any file is bad."""
    from bondcell.scenes.validate import validate_file

    found = {path: validate_file(path) for path in arguments.files}
    status = BAD if any(one.violations for one in found.values()) else GOOD
    if arguments.json:
        print(json.dumps({path: _document(one) for path, one in found.items()}, indent=2))
        return status
    for path, (violations, odd) in found.items():
        for line in odd:
            print(f"bondcell: warning: {line}", file=sys.stderr)
        for violation in violations:
            print(f"{path}: {violation}", file=sys.stderr)
        if not violations:
            print(f"{path}: valid")
    return status


def _document(found: Findings) -> dict[str, Any]:
    """Every value as text: what was given may be anything."""
    return {
        "valid": not found.violations,
        "violations": [
            {"field": one.field, "value": repr(one.value), "allowed": one.allowed}
            for one in found.violations
        ],
        "warnings": list(found.warnings),
    }
