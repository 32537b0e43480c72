"""``bondcell merge``: two studies in one file."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from bondcell.cli.targets import overwritten
from bondcell.errors import InputError, Violation

EXPLANATION = """\
Both studies must have the same hash scheme, models, loads, boundary conditions and tolerances. A
point of both must have the same values within their error estimates and is taken from the first.
Grids that differ along one axis make a longer grid, anything else stands on the dimension sample.

example:
  bondcell merge results/narrow/study.nc results/wide/study.nc -o results/both.nc
"""


def add_to(commands: Any) -> None:
    """Add the subcommand and its options."""
    parser = commands.add_parser(
        "merge",
        help="put two studies together",
        description="The points of two studies of the same models in one file.",
        epilog=EXPLANATION,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        allow_abbrev=False,
    )
    parser.set_defaults(run=run)
    parser.add_argument("first", metavar="A", help="a study.nc")
    parser.add_argument("second", metavar="B", help="another one")
    parser.add_argument("-o", "--output", metavar="OUT", required=True, help="the new file, .nc")


def run(arguments: argparse.Namespace) -> int:
    """Merge and write; one line tells what was written."""
    from bondcell.jobs.merge_studies import merge_studies
    from bondcell.results.load_groups import read_loads
    from bondcell.storage import group_names, write_dataset

    target = Path(arguments.output)
    if target.suffix != ".nc" or not target.absolute().parent.is_dir():
        raise InputError([Violation("-o", arguments.output, "a name ending in .nc, in a folder")])
    if violations := overwritten(arguments.output, arguments.first, arguments.second):
        raise InputError(violations)
    loads = []
    for path in (arguments.first, arguments.second):
        loads.append(read_loads(path))
        others = [name for name in group_names(path) if name not in loads[-1]]
        if others:
            words = "a study of points alone: such groups cannot be merged"
            raise InputError([Violation("groups", ", ".join(others), words)], path)
    root, *rest = merge_studies(*loads).items()
    inputs = [name for name in root[1].data_vars if "model" not in root[1][name].dims]
    groups = {load: study.drop_vars(inputs, errors="ignore") for load, study in rest}
    write_dataset(root[1], target, groups)
    sizes = ", ".join(f"{size} {name}" for name, size in root[1].sizes.items())
    print(f"written: {target}, {sizes}")
    return 0
