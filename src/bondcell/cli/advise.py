"""``bondcell advise``: which model to take for a cell and a wanted error."""

from __future__ import annotations

import argparse
import json
import math
import sys
from dataclasses import asdict
from typing import TYPE_CHECKING, Any

from bondcell.errors import InputError, Violation

if TYPE_CHECKING:
    from bondcell.advice import Advice
    from bondcell.cell import Cell

LOADS = ("normal", "shear", "torsion", "bending")
"""Loads that the advice knows."""

DEFAULT_ERROR = "1 %"
"""Wanted error where nothing is said."""

EXPLANATION = (
    "The expected error is the largest one at the neighbouring points of the accuracy map that\n"
    "comes with the package, against finite elements (frictionless plates); times are those of\n"
    "the machine that built it."
)


EXAMPLES = """

example:
  bondcell advise --radius "7.5 mm" --gap "0.5 mm" --young-particle "30 GPa" \\
      --poisson-particle 0.25 --young-matrix "1.4 MPa" --poisson-matrix 0.46 --error "1 %"
"""


def add_to(commands: Any) -> None:
    """Add the subcommand and its options."""
    from bondcell.cli.cell_options import add_cell_options

    parser = commands.add_parser(
        "advise",
        help="which model to take for a cell and a wanted error",
        description="The cheapest model that is good enough for a bond cell, and why not the "
        "paper's.",
        epilog=EXPLANATION + EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        allow_abbrev=False,
    )
    parser.set_defaults(run=run)
    add_cell_options(parser)
    group = parser.add_argument_group("what is wanted")
    group.add_argument(
        "--error",
        default=DEFAULT_ERROR,
        metavar="VALUE",
        help="relative error, as in '0.01' or '1 %%' (default: 1 %%)",
    )
    group.add_argument(
        "--load", default="normal", metavar="NAME", help=f"{', '.join(LOADS)} (default: normal)"
    )
    group.add_argument(
        "--measure",
        action="store_true",
        help="solve the cell by finite elements and compare all models there",
    )
    parser.add_argument("--json", action="store_true", help="print JSON, for programs")


def run(arguments: argparse.Namespace) -> int:
    """Print the advice."""
    from bondcell.advice import advise_cell
    from bondcell.cli.cell_options import read_cell, unit_warnings

    cell, violations = read_cell(arguments)
    error, wrong = _error(arguments.error)
    violations += wrong
    if arguments.load not in LOADS:
        violations.append(Violation("--load", arguments.load, f"one of {', '.join(LOADS)}"))
    if violations or cell is None:
        raise InputError(violations)
    for line in unit_warnings(cell):
        print(f"bondcell: warning: {line}", file=sys.stderr)
    advice = advise_cell(cell, error, arguments.load, arguments.measure)
    if arguments.json:
        print(json.dumps(_document(cell, advice), indent=2))
    else:
        _print(advice)
    return 0


def _error(text: str) -> tuple[float, list[Violation]]:
    from bondcell.advice import ERROR_RANGE, ERRORS
    from bondcell.scenes.quantities import NotAllowed, parse_quantity

    try:
        error = parse_quantity(text, "1")
    except NotAllowed:
        error = math.nan
    if ERRORS[0] <= error <= ERRORS[1]:
        return error, []
    return error, [Violation("--error", text, ERROR_RANGE)]


def _print(advice: Advice) -> None:
    from bondcell.cli.text_table import text_table
    from bondcell.wording import percent, quantity

    print(f"{advice}\n")
    rows = []
    for found in advice.candidates:
        known = not math.isnan(found.expected_error)
        low, high = percent(found.error_low, sign=True), percent(found.error_high, sign=True)
        span = low if low == high else f"{low} to {high}"
        rows.append(
            [
                found.model,
                percent(found.expected_error) if known else "not known",
                span if known else "",
                quantity(found.seconds, "s", 2),
                "inside" if found.inside_range else "outside",
                "yes" if found.serves(advice.wanted) else "no",
            ]
        )
    header = ["model", "expected error", "nearby", "time a cell", "valid range", "serves"]
    if advice.source == "measured":
        header[1:3] = ["error", "signed"]
    print(text_table(rows, header))
    print(f"\n{EXPLANATION}")


def _document(cell: Cell, advice: Advice) -> dict[str, Any]:
    found = asdict(advice)
    inputs = {name: _plain(float(value)) for name, value in cell.as_dict().items()}
    candidates = [
        {name: _plain(value) for name, value in candidate.items()}
        for candidate in found.pop("candidates")
    ]
    plain = {name: _plain(value) for name, value in found.items()}
    return {"inputs": inputs, **plain, "candidates": candidates}


def _plain(value: Any) -> Any:
    """JSON knows no NaN (here null) and no infinity (here text)."""
    if not isinstance(value, float) or math.isfinite(value):
        return value
    return None if math.isnan(value) else "inf" if value > 0 else "-inf"
