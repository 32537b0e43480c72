"""``bondcell stiffness``: the stiffness of one bond cell by the asked models."""

from __future__ import annotations

import argparse
import json
import math
import sys
import warnings
from difflib import get_close_matches
from typing import TYPE_CHECKING, Any

from bondcell.errors import InputError, Violation
from bondcell.reference_options import (
    BOUNDARY_CONDITIONS,
    DEFAULT_TOLERANCE,
    TOLERANCE_RANGE,
    TOLERANCES,
)

if TYPE_CHECKING:
    from bondcell.cell import Cell
    from bondcell.cli.answers import Answer

LOADS = ("normal", "shear", "torsion", "bending")
"""Loads; not every model covers all of them."""

DIGITS = 10
"""Significant digits of a printed stiffness."""

EXPLANATION = (
    "The error estimate is the relative numerical error of the value as a solution of its own "
    "model.\nHow far an analytic model is from the real cell is seen by comparing it with fe."
)

EXAMPLES = """

examples:
  bondcell stiffness --radius "7.5 mm" --gap "0.5 mm" --young-particle "30 GPa" \\
      --poisson-particle 0.25 --young-matrix "1.4 MPa" --poisson-matrix "46 %" \\
      --model fsi --model fe
  bondcell stiffness --radius "7.5 mm" --radius-j "5 mm" --gap "10 um" --young-particle rigid \\
      --poisson-particle 0.25 --young-matrix "1.4 MPa" --poisson-matrix 0.46 --load shear \\
      --model film --json
"""

Commands = Any
"""The object that argparse gives for subcommands; its type is private."""


def add_to(commands: Commands) -> None:
    """Add the subcommand and its options."""
    from bondcell.cli.cell_options import add_cell_options

    parser = commands.add_parser(
        "stiffness",
        help="stiffness of one bond cell by one or more models",
        description="Stiffness of one bond cell: a line for each model.",
        epilog=EXPLANATION + EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        allow_abbrev=False,
    )
    parser.set_defaults(run=run)
    add_cell_options(parser)
    group = parser.add_argument_group("what to compute")
    group.add_argument(
        "--model",
        action="append",
        metavar="NAME",
        help="a model, see `bondcell models`; may be repeated (default: fsi)",
    )
    group.add_argument(
        "--load", default="normal", metavar="NAME", help=f"{', '.join(LOADS)} (default: normal)"
    )
    group.add_argument(
        "--bc",
        metavar="NAME",
        help="end planes and sides for the model fe under the normal load: "
        f"{', '.join(BOUNDARY_CONDITIONS)} (default: {BOUNDARY_CONDITIONS[0]})",
    )
    group.add_argument(
        "--tolerance",
        metavar="VALUE",
        help=f"relative error for the model fe (default: {DEFAULT_TOLERANCE:g})",
    )
    parser.add_argument("--json", action="store_true", help="print JSON, for programs")


def run(arguments: argparse.Namespace) -> int:
    """Compute and print; 1 when a model gave no value."""
    from bondcell.cli.cell_options import read_cell, unit_warnings

    cell, violations = read_cell(arguments)
    models = list(dict.fromkeys(arguments.model or ["fsi"]))
    violations += _model_violations(models, arguments.load)
    options, wrong = _reference_options(arguments)
    violations += wrong
    if violations or cell is None:
        raise InputError(violations)
    odd = unit_warnings(cell)
    if "fe" not in models and (arguments.bc or arguments.tolerance):
        odd.append("--bc and --tolerance concern the model fe only, which is not asked for")
    _warn(odd)
    answers = _answers(cell, models, arguments.load, options)
    if arguments.json:
        print(json.dumps(_document(cell, answers, arguments.load, options), indent=2))
    else:
        _print_table(cell, answers, arguments.load, options)
    return 0 if all(answer.status.has_value for answer in answers) else 1


def _model_violations(models: list[str], load: str) -> list[Violation]:
    from bondcell.models import MODELS

    known = load in LOADS
    violations = [] if known else [Violation("--load", load, f"one of {', '.join(LOADS)}")]
    for name in models:
        if name not in MODELS:
            close = get_close_matches(name, MODELS, 1)
            hint = f"; did you mean {close[0]}?" if close else ""
            violations.append(Violation("--model", name, f"one of {', '.join(MODELS)}{hint}"))
        elif known and load not in MODELS[name].loads:
            able = ", ".join(MODELS[name].loads)
            violations.append(Violation("--load", load, f"one of {able} for the model {name}"))
    return violations


def _reference_options(arguments: argparse.Namespace) -> tuple[dict[str, Any], list[Violation]]:
    from bondcell.scenes.quantities import NotAllowed, parse_quantity

    bc, tolerance = arguments.bc or BOUNDARY_CONDITIONS[0], DEFAULT_TOLERANCE
    violations = []
    if bc not in BOUNDARY_CONDITIONS:
        violations.append(Violation("--bc", bc, f"one of {', '.join(BOUNDARY_CONDITIONS)}"))
    elif arguments.bc and arguments.load != "normal":
        violations.append(Violation("--bc", bc, "left out: it concerns the load normal only"))
    if arguments.tolerance is not None:
        try:
            tolerance = parse_quantity(arguments.tolerance)
        except NotAllowed:
            tolerance = math.nan
        if not TOLERANCES[0] <= tolerance <= TOLERANCES[1]:
            violations.append(Violation("--tolerance", arguments.tolerance, TOLERANCE_RANGE))
    return {"bc": bc, "tolerance": tolerance}, violations


def _answers(cell: Cell, models: list[str], load: str, options: dict[str, Any]) -> list[Answer]:
    from bondcell.cli.answers import answer

    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        answers = [answer(cell, name, load, options) for name in models]
    _warn([str(entry.message) for entry in caught])
    return answers


def _warn(lines: list[str]) -> None:
    for line in lines:
        print(f"bondcell: warning: {line}", file=sys.stderr)


def _print_table(cell: Cell, answers: list[Answer], load: str, options: dict[str, Any]) -> None:
    from bondcell.cell import UNITS
    from bondcell.cli.text_table import text_table
    from bondcell.outputs import STIFFNESS_UNITS
    from bondcell.wording import at, quantity, unit_text

    unit = unit_text(STIFFNESS_UNITS[load])
    given = {name: float(values) for name, values in cell.as_dict().items()}
    print(", ".join(at(name, value, UNITS[name]) for name, value in given.items()))
    with_bc = load == "normal" and any(a.model == "fe" for a in answers)
    condition = f", fe with bc {options['bc']}" if with_bc else ""
    print(f"load {load}{condition}\n")
    rows = []
    for found in answers:
        kind = f" ({found.error_kind})" if found.status.has_value else ""
        value = f"{found.stiffness:.{DIGITS}g} {unit}" if found.status.has_value else "no value"
        error = f"{found.error_estimate:.1e}" if math.isfinite(found.error_estimate) else "-"
        time = quantity(found.seconds, "s", 3)
        rows.append([found.model, value, error + kind, found.status.name, time])
        for part, spring in found.parts.items():
            rows.append([f"  {part}", f"{spring:.{DIGITS}g} {unit}", "", "", ""])
        if math.isfinite(found.coupling):
            rows.append(["  coupling", f"{found.coupling:.{DIGITS}g} N/rad", "", "", ""])
    print(text_table(rows, ["model", "stiffness", "relative error estimate", "status", "time"]))
    for line in _out_of_range(answers):
        print(f"\n{line}")
    print(f"\n{EXPLANATION}")


def _out_of_range(answers: list[Answer]) -> list[str]:
    """Where the models hold that are flagged because the cell lies elsewhere."""
    from bondcell.models import MODELS
    from bondcell.status import Status

    flagged = (Status.outside_valid_range, Status.not_computed)
    return [
        f"{found.model} is {found.status.name}. It holds for: {MODELS[found.model].valid_range}"
        for found in answers
        if found.status in flagged
    ]


def _document(
    cell: Cell, answers: list[Answer], load: str, options: dict[str, Any]
) -> dict[str, Any]:
    from bondcell.outputs import STIFFNESS_UNITS

    inputs = {name: _json_number(float(values)) for name, values in cell.as_dict().items()}
    return {
        "load": load,
        "unit": STIFFNESS_UNITS[load],
        "inputs": inputs,
        "fe_options": _fe_options(load, options) if any(a.model == "fe" for a in answers) else None,
        "results": [
            {
                "model": found.model,
                "stiffness": _json_number(found.stiffness),
                "error_estimate": _json_number(found.error_estimate),
                "error_estimate_kind": found.error_kind,
                "status": found.status.name,
                "seconds": _json_number(found.seconds),
                "dof": found.dof,
                "order": found.order,
                "way": found.way or None,
                "coupling": _json_number(found.coupling),
                "parts": {name: _json_number(part) for name, part in found.parts.items()},
            }
            for found in answers
        ],
    }


def _fe_options(load: str, options: dict[str, Any]) -> dict[str, Any]:
    return options if load == "normal" else {"tolerance": options["tolerance"]}


def _json_number(value: float) -> float | str | None:
    """JSON knows no NaN (here null) and no infinity (a rigid particle, here text)."""
    if math.isnan(value):
        return None
    return value if math.isfinite(value) else "inf"
