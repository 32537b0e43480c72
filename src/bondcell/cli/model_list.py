"""``bondcell models``: what each model is."""

from __future__ import annotations

import argparse
import json
import textwrap
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from bondcell.models.model import Model

WIDTH = 96


def add_to(commands: Any) -> None:
    """Add the subcommand and its options."""
    parser = commands.add_parser(
        "models",
        help="list the models",
        description="The models: source, valid range, loads, options.",
        allow_abbrev=False,
    )
    parser.set_defaults(run=run)
    parser.add_argument("--json", action="store_true", help="print JSON, for programs")


def run(arguments: argparse.Namespace) -> int:
    """Print an entry for each model."""
    from bondcell.models import MODELS

    if arguments.json:
        entries = {name: _document(model) for name, model in MODELS.items()}
        print(json.dumps(entries, indent=2, ensure_ascii=False))
        return 0
    for name, model in MODELS.items():
        print(f"{name}: {model.title}")
        lines = {
            "": model.summary,
            "source": model.source,
            "valid": model.valid_range,
            "loads": ", ".join(model.loads),
            **{f"option {option}": meaning for option, meaning in model.options.items()},
        }
        for label, text in lines.items():
            if text:
                said = f"{label}: {text}" if label else text
                print(textwrap.fill(said, WIDTH, initial_indent="  ", subsequent_indent="    "))
        print()
    return 0


def _document(model: Model) -> dict[str, Any]:
    return {
        "title": model.title,
        "summary": model.summary,
        "source": model.source,
        "valid_range": model.valid_range,
        "loads": list(model.loads),
        "options": dict(model.options),
    }
