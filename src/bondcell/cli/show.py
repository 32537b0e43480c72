"""``bondcell show``: browse a file of results."""

from __future__ import annotations

import argparse
import json
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

from bondcell.cli.targets import overwritten
from bondcell.errors import InputError, Violation

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

    from bondcell.figures.style import Drawing

SUFFIXES = (".png", ".svg", ".pdf")
"""Formats of a plot."""

EXAMPLES = """\
examples:
  bondcell show results/figure4/study.nc
  bondcell show results/figure4/study.nc --plot modulus_ratio stiffness -o curves.svg
  bondcell show results/prony/study.nc --plot time relaxation -o curves.png \\
      --at series=sbs_ac13 --at convention=constant_bulk --at poisson_m=0.46 --at "gap=0.5 mm"
  bondcell show results/figure4/study.nc --table --at model=fe --variable stiffness
  bondcell show results/extreme_loads/study.nc --group torsion --csv -o torsion.csv
  bondcell show results/figure4/study.nc --json
"""


def add_to(commands: Any) -> None:
    """Add the subcommand and its options."""
    parser = commands.add_parser(
        "show",
        help="browse a file of results",
        description="Dimensions, ranges, flags and worst errors of a file of results; a plot or a "
        "table of it on request.",
        epilog=EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        allow_abbrev=False,
    )
    parser.set_defaults(run=run)
    parser.add_argument("file", metavar="FILE", help="a study.nc")
    what = parser.add_mutually_exclusive_group()
    what.add_argument(
        "--plot",
        nargs=2,
        metavar=("X", "Y"),
        help="draw the variable Y over the axis X; stiffness comes with the models' errors",
    )
    what.add_argument("--table", action="store_true", help="print a line for each point")
    what.add_argument("--csv", action="store_true", help="the same as CSV, to -o or to be piped")
    what.add_argument("--json", action="store_true", help="print what is in the file as JSON")
    parser.add_argument(
        "-o", "--output", metavar="OUT", help=f"file of the plot ({', '.join(SUFFIXES)}) or CSV"
    )
    parser.add_argument("--group", metavar="NAME", help="a group of the file (default: the root)")
    parser.add_argument(
        "--variable",
        action="append",
        default=[],
        metavar="NAME",
        help="a variable of the table; may be repeated (default: all on the same axes)",
    )
    parser.add_argument(
        "--at",
        action="append",
        default=[],
        metavar="AXIS=VALUE",
        help="only this position of an axis, with a unit as in 'gap=0.5 mm'; may be repeated",
    )


def run(arguments: argparse.Namespace) -> int:
    """Print, draw or write what was asked for."""
    _check(arguments)
    if arguments.json:
        from bondcell.cli.contents import contents

        print(json.dumps(contents(arguments.file), indent=2))
    elif arguments.plot or arguments.table or arguments.csv:
        from bondcell.results.selection import narrowed

        data = narrowed(_read(arguments), arguments.at)
        if arguments.plot:
            _write_plot(_drawing(data, *arguments.plot), arguments)
        else:
            _write_table(data, arguments)
    else:
        from bondcell.cli.overview import print_overview

        print_overview(arguments.file)
    return 0


def _check(arguments: argparse.Namespace) -> None:
    """What can be said before anything is read."""
    violations = []
    out = arguments.output
    takes_file = arguments.plot or arguments.csv
    if out is not None and not takes_file:
        violations.append(Violation("-o", out, "an option of --plot and --csv"))
    elif out is not None and Path(out).is_dir():
        violations.append(Violation("-o", out, "a file, not a folder"))
    elif out is not None and not Path(out).absolute().parent.is_dir():
        violations.append(Violation("-o", out, "a file in an existing folder"))
    elif out is not None:
        violations += overwritten(out, arguments.file)
    if arguments.plot and Path(out or "").suffix.lower() not in SUFFIXES:
        allowed = f"a file name that ends in {', '.join(SUFFIXES)}"
        violations.append(Violation("-o", out, allowed))
    if arguments.variable and not (arguments.table or arguments.csv):
        violations.append(Violation("--variable", arguments.variable, "for --table and --csv"))
    if (arguments.at or arguments.group) and not (takes_file or arguments.table):
        option = "--at" if arguments.at else "--group"
        value = arguments.at or arguments.group
        violations.append(Violation(option, value, "for --plot, --table and --csv"))
    if violations:
        raise InputError(violations)


def _read(arguments: argparse.Namespace) -> xr.Dataset:
    """The asked group, a load's with the scene's inputs."""
    from bondcell.results.load_groups import read_loads
    from bondcell.storage import group_names, read_dataset

    if arguments.group is None:
        return read_dataset(arguments.file)
    name = arguments.group.strip("/")
    known = group_names(arguments.file)
    if name not in known:
        allowed = f"a group of the file: {', '.join(known) or 'it has none'}"
        raise InputError([Violation("--group", arguments.group, allowed)])
    loads = read_loads(arguments.file)
    return loads[name] if name in loads else read_dataset(arguments.file, group=name)


def _drawing(data: xr.Dataset, x: str, y: str) -> Drawing:
    """Stiffness over a swept axis with the errors of the models; anything else plainly."""
    from bondcell.figures.bars import draw_bars
    from bondcell.figures.curves import draw_curves
    from bondcell.figures.scatter import draw_scatter
    from bondcell.figures.style import drawing_style
    from bondcell.figures.variable import draw_variable
    from bondcell.results.view import is_scattered, parameters, swept_axes

    with drawing_style():
        if y == "stiffness" and y in data and "model" in data[y].dims:
            axes = swept_axes(data)
            if is_scattered(data) and x in parameters(data):
                return draw_scatter(data, x=x)
            if x in axes and not is_scattered(data):
                return draw_curves(data, x=x)
            if x == "model" and not axes:
                return draw_bars(data)
        return draw_variable(data, x, y)


def _write_plot(drawing: Drawing, arguments: argparse.Namespace) -> None:
    from bondcell.figures.style import drawing_style
    from bondcell.storage import replacing

    suffix = Path(arguments.output).suffix.lower().removeprefix(".")
    with drawing_style(), replacing(arguments.output) as temporary:
        drawing.figure.savefig(temporary, format=suffix)
    print(f"drawn: {arguments.output}\n{drawing.caption}")


def _write_table(data: xr.Dataset, arguments: argparse.Namespace) -> None:
    from bondcell.results.selection import as_table, chosen_variables
    from bondcell.storage import replacing

    table = as_table(data, chosen_variables(data, arguments.variable))
    if arguments.table:
        print(_text(table, data))
    elif arguments.output is None:
        table.to_csv(sys.stdout, index=False)
    else:
        with replacing(arguments.output) as temporary:
            table.to_csv(temporary, index=False)
        print(f"written: {arguments.output}, {len(table)} lines")


def _text(table: pd.DataFrame, data: xr.Dataset) -> str:
    """The table in columns, units in the head."""
    from bondcell.cli.text_table import text_table
    from bondcell.wording import unit_text

    head = []
    for name in table:
        unit = unit_text(str(data[name].attrs.get("units", "1"))) if name in data else ""
        head.append(f"{name} [{unit}]" if unit else str(name))
    rows = [
        [f"{value:.6g}" if isinstance(value, float) else str(value) for value in row]
        for row in table.itertuples(index=False)
    ]
    return text_table(rows, head)
