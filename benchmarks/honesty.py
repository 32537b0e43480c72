"""Is the reference's error estimate honest? Random cells against a finer mesh of higher order.

    python benchmarks/honesty.py [--count 20] [--first 0] [--tolerance 1e-6] [--load shear]
                                 [--json comparisons.jsonl]
    python benchmarks/honesty.py --read comparisons.jsonl [more.jsonl ...]

Prints, by load and region of the parameter space, the worst true error, the smallest estimate over
true error (below one would be dishonest) and the 95 % quantile of that ratio, see
`bondcell.fem.honesty`. Samples of many cells are made in pieces: each cell has a seed of its own,
so that ``--first`` goes on where another run ended, and ``--read`` puts the pieces together.
"""

from __future__ import annotations

import argparse
import json
from dataclasses import asdict
from pathlib import Path

import numpy as np

from bondcell.fem.honesty import CASES, Comparison, compare, random_cell
from bondcell.status import Status

SEED = 20130612
Row = tuple[str, str, Comparison]
"""Load, region and what was found."""


def sample(case: int, first: int, count: int, tolerance: float) -> list[Row]:
    """Compare some cells of one load."""
    load, bc = CASES[case]
    rows = []
    for number in range(first, first + count):
        cell = random_cell(np.random.default_rng([SEED, case, number]))
        region = " ".join(
            (
                "thin" if cell.gap < 0.01 else "wide",
                "nu>.49" if cell.poisson_m > 0.49 else "nu<=.49",
            )
        )
        name = f"{load} {bc}" if load == "normal" else load
        rows.append((name, region, compare(cell, load, bc, tolerance)))
    return rows


def print_table(rows: list[Row]) -> None:
    """A line a load and region, a line a load, and one of all."""
    groups: dict[str, list[Comparison]] = {}
    for name, region, found in rows:
        for group in (f"{name}, {region}", name, "all"):
            groups.setdefault(group, []).append(found)
    print(f"{'load, region':32}{'cells':>6}{'flags':>6}{'error':>9}{'least':>8}{'95 %':>8}{'s':>7}")
    for group in sorted(groups, key=lambda name: (name == "all", name)):
        own = groups[group]
        ratios = np.array([found.ratio for found in own])
        flags = sum(found.status != Status.ok for found in own)
        worst = max(found.error for found in own)
        seconds = np.median([found.seconds for found in own])
        print(
            f"{group:32}{len(own):6}{flags:6}{worst:9.1e}{ratios.min():8.2g}"
            f"{np.quantile(ratios, 0.95):8.2g}{seconds:7.2f}"
        )


def main() -> None:
    """Compare, or read comparisons, and print the table."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--count", type=int, default=20, help="cells of each load")
    parser.add_argument("--first", type=int, default=0, help="number of the first cell")
    parser.add_argument("--tolerance", type=float, default=1e-6)
    parser.add_argument("--load", choices=sorted({load for load, _ in CASES}))
    parser.add_argument("--json", type=Path, help="append the comparisons to this file")
    parser.add_argument("--read", type=Path, nargs="+", help="only put these files together")
    asked = parser.parse_args()
    rows: list[Row] = []
    for path in asked.read or ():
        for line in path.read_text().splitlines():
            name, region, found = json.loads(line)
            rows.append((name, region, Comparison(**found)))
    wanted = [k for k, (load, _) in enumerate(CASES) if asked.load in (None, load)]
    for case in () if asked.read else wanted:
        own = sample(case, asked.first, asked.count, asked.tolerance)
        rows += own
        if asked.json:
            with asked.json.open("a") as file:
                file.writelines(json.dumps([a, b, asdict(found)]) + "\n" for a, b, found in own)
    print_table(rows)


if __name__ == "__main__":
    main()
