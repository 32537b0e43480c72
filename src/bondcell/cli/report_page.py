"""``bondcell report``: the page on a folder of results, without a workflow."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from bondcell.errors import InputError, Violation

EXAMPLES = """\
examples:
  bondcell report results                   # writes results/report.html
  bondcell report results -o page.html      # links in it lead to the results from where it lies
"""


def add_to(commands: Any) -> None:
    """Add the subcommand and its options."""
    parser = commands.add_parser(
        "report",
        help="write the report on a folder of results",
        description="One self-contained page on all scenes that a folder of results holds.",
        epilog=EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        allow_abbrev=False,
    )
    parser.set_defaults(run=run)
    parser.add_argument(
        "folder", metavar="FOLDER", help="a folder with a folder and a study.nc for each scene"
    )
    parser.add_argument("-o", "--output", metavar="OUT", help="the page (default: in the folder)")


def run(arguments: argparse.Namespace) -> int:
    """Write the page and say what it says first."""
    folder = Path(arguments.folder)
    page = Path(arguments.output) if arguments.output is not None else folder / "report.html"
    violations = []
    if not folder.is_dir():
        violations.append(Violation("FOLDER", arguments.folder, "an existing folder"))
    elif not any(folder.glob("*/study.nc")):
        allowed = "a folder with a folder for each scene, and in it the scene's study.nc"
        violations.append(Violation("FOLDER", arguments.folder, allowed))
    if page.suffix.lower() not in (".html", ".htm"):
        violations.append(Violation("-o", str(page), "a file name that ends in .html"))
    elif page.is_dir() or (arguments.output and not page.absolute().parent.is_dir()):
        violations.append(Violation("-o", str(page), "a file in an existing folder"))
    if violations:
        raise InputError(violations)

    from bondcell.report import write_report

    written = write_report(folder, page)
    print(f"written: {written.path}, {len(written.scenes)} scenes: {', '.join(written.scenes)}")
    for sentence in written.sentences:
        print(f"  {sentence}")
    return 0
