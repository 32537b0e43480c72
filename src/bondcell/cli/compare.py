"""``bondcell compare``: whether two files of results say the same within their error estimates."""

from __future__ import annotations

import argparse
import json
from dataclasses import asdict
from typing import TYPE_CHECKING, Any

from bondcell.errors import InputError, Violation

if TYPE_CHECKING:
    import xarray as xr

    from bondcell.results.comparison import Difference

SAME, DIFFERENT = 0, 1

EXPLANATION = """\
Values agree that differ by no more than both error estimates together; a value without an estimate
may differ by 1e-9 of the largest of its variable. Flags and inputs must be the same. Times, counts
of unknowns and the estimates themselves are not compared.

exit status: 0 the same, 1 different, 2 bad input

example:
  bondcell compare results/figure4/study.nc other/figure4/study.nc
"""


def add_to(commands: Any) -> None:
    """Add the subcommand and its options."""
    parser = commands.add_parser(
        "compare",
        help="compare two files of results",
        description="Differences between two files of results beyond their error estimates.",
        epilog=EXPLANATION,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        allow_abbrev=False,
    )
    parser.set_defaults(run=run)
    parser.add_argument("first", metavar="A", help="a study.nc")
    parser.add_argument("second", metavar="B", help="another one")
    parser.add_argument("--all", action="store_true", help="also list what agrees")
    parser.add_argument("--json", action="store_true", help="print JSON, for programs")


def run(arguments: argparse.Namespace) -> int:
    """Print the differences; 1 if there are any."""
    from bondcell.results.comparison import compare_groups

    first, second = (_read(path) for path in (arguments.first, arguments.second))
    found = list(compare_groups(first, second))
    if not any(one.points for one in found):
        path = arguments.second
        raise InputError([Violation("file", path, "results with something to compare")], path)
    different = [one for one in found if one.differs]
    if arguments.json:
        shown = [_document(one) for one in found]
        print(json.dumps({"same": not different, "variables": shown}, indent=2))
    else:
        _print(found, different, arguments)
    return DIFFERENT if different else SAME


def _read(path: str) -> dict[str, xr.Dataset]:
    from bondcell.storage import group_names, read_dataset

    groups = {"/": read_dataset(path)}
    return groups | {f"/{name}": read_dataset(path, group=name) for name in group_names(path)}


def _print(
    found: list[Difference], different: list[Difference], arguments: argparse.Namespace
) -> None:
    from bondcell.cli.text_table import text_table

    shown = found if arguments.all else different
    if shown:
        print(text_table([_row(one) for one in shown], _HEADER))
        print()
    points = sum(one.points for one in found)
    if different:
        print(f"different: {len(different)} of {len(found)} variables ({points} values compared)")
    else:
        print(f"the same: {len(found)} variables, {points} values, within their error estimates")


_HEADER = ["variable", "differ", "of", "largest", "allowed there", "A", "B", "worst at"]


def _row(one: Difference) -> list[str]:
    name = f"{one.group.rstrip('/')}/{one.variable}".strip("/")
    if one.reason:
        return [name, "-", "-", "-", "-", "", "", one.reason]
    values = [f"{v:.10g}" if isinstance(v, float) else v for v in one.values]
    where = ", ".join(f"{axis}={_short(value)}" for axis, value in one.where.items())
    largest = f"{one.largest:.2g}"
    return [name, str(one.beyond), str(one.points), largest, f"{one.allowed:.2g}", *values, where]


def _short(value: str | float) -> str:
    return f"{value:.6g}" if isinstance(value, float) else str(value)


def _document(one: Difference) -> dict[str, Any]:
    from bondcell.cli.contents import plain_number

    def plain(value: Any) -> Any:
        return plain_number(value) if isinstance(value, float) else value

    found = {name: plain(value) for name, value in asdict(one).items()}
    found["values"] = [plain(value) for value in one.values]
    found["where"] = {axis: plain(value) for axis, value in one.where.items()}
    return found | {"differs": one.differs}
