"""Is the reference's error estimate honest? Random cells against a finer mesh of higher order.

    python benchmarks/honesty.py [--count 40] [--tolerance 1e-6] [--seed 20130612]

Prints, by load and region of the parameter space, the worst true error, the smallest estimate over
true error (below one would be dishonest) and the 95 % quantile of that ratio.
"""

from __future__ import annotations

import argparse
import time
from dataclasses import replace

import numpy as np

from bondcell.cell import Cell
from bondcell.fem.reference import solve
from bondcell.fem.structured import find_load, solve_level
from bondcell.status import Status

LOADS = (
    ("normal", "roller"),
    ("normal", "clamped"),
    ("normal", "confined"),
    ("shear", "roller"),
    ("torsion", "roller"),
    ("bending", "roller"),
)
ROUND_OFF = 1e-11
"""True errors below it are not resolved."""


def random_cell(rng: np.random.Generator) -> Cell:
    """A cell of the range that the reference promises its accuracy in."""
    poisson_m = rng.choice([0.0, 0.5, rng.uniform(0, 0.5), 0.5 - 10 ** rng.uniform(-7, -1)])
    return Cell.from_values(
        radius_i=1.0,
        radius_j=rng.choice([1.0, rng.uniform(0.1, 1)]),
        gap=10 ** rng.uniform(-4, 0.477),
        young_i=10 ** rng.uniform(0, 8),
        young_m=1.0,
        poisson_i=rng.uniform(0, 0.45),
        poisson_m=poisson_m,
        cylinder_radius=rng.choice([1.0, rng.uniform(1, 2)]),
    )


def compare(cell: Cell, load: str, bc: str, tolerance: float) -> tuple[int, float, float, float]:
    """Flag, estimate, true error and seconds of one cell."""
    started = time.perf_counter()
    answer = solve(cell, load, bc, tolerance)
    seconds = time.perf_counter() - started
    usual = find_load(load, bc).grading
    finer = replace(
        usual, growth=3.0, largest=0.3, foot=usual.foot / 4, foot_growth=4, corner=usual.corner / 30
    )
    order = min(int(answer.order[0]) + 2, 12)
    true = solve_level(cell, order, bc, load, grading=finer).stiffness
    error = abs(answer.stiffness[0] / true - 1)
    return int(answer.status[0]), float(answer.error_estimate[0]), float(error), seconds


def main() -> None:
    """Run the comparison and print the table."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--count", type=int, default=40)
    parser.add_argument("--tolerance", type=float, default=1e-6)
    parser.add_argument("--seed", type=int, default=20130612)
    asked = parser.parse_args()
    print("load, region, cells, not ok, worst error, least estimate/error, 95 % of it, median s")
    for load, bc in LOADS:
        rng = np.random.default_rng(asked.seed)
        rows = []
        for _ in range(asked.count):
            cell = random_cell(rng)
            nearly = float(cell.poisson_m) > 0.49
            region = ("thin" if cell.gap < 0.01 else "wide", "nu>.49" if nearly else "nu<=.49")
            rows.append((region, *compare(cell, load, bc, asked.tolerance)))
        for region in sorted({row[0] for row in rows}):
            own = [row[1:] for row in rows if row[0] == region]
            flags, estimates, errors, seconds = map(np.array, zip(*own, strict=True))
            ratio = estimates / np.maximum(errors, ROUND_OFF)
            print(
                f"{load} {bc}, {' '.join(region)}, {len(own)}, {(flags != Status.ok).sum()}, "
                f"{errors.max():.1e}, {ratio.min():.2g}, {np.quantile(ratio, 0.95):.2g}, "
                f"{np.median(seconds):.2f}",
                flush=True,
            )


if __name__ == "__main__":
    main()
