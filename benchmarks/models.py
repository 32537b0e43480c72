"""Points per second of every analytic model on one core; run by hand."""

import os

os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import statistics
import time
from collections.abc import Callable

import numpy as np

from bondcell.cell import Cell
from bondcell.models import MODELS
from bondcell.models.model import Model

REPEATS = 7
POINTS = {"cementation": 2_000, "film": 64, "bounds": 64}
CASES = ("equal", "wide gaps", "unequal radii", "all unequal", "soft particles")


def sweep(case: str, points: int) -> Cell:
    """Random cells: every point has its own gap and moduli."""
    rng = np.random.default_rng(7)
    gap_exponents = (0.5, 3.0) if case == "wide gaps" else (-6.0, 0.0)
    values = {
        "radius_i": 7.5e-3,
        "gap": 7.5e-3 * 10 ** rng.uniform(*gap_exponents, points),
        "young_i": 3e10,
        "young_m": 3e10 / 10 ** rng.uniform(0.1, 6, points),
        "poisson_i": 0.25,
        "poisson_m": 0.4,
    }
    if case in ("unequal radii", "all unequal", "soft particles"):
        values["radius_j"] = 7.5e-3 * 10 ** rng.uniform(-2, 0, points)
    if case == "all unequal":
        values["young_j"] = 3e10 * 10 ** rng.uniform(0, 2, points)
        values["cylinder_radius"] = 1e-2
    if case == "soft particles":
        values["young_i"] = values["young_m"] / 10 ** rng.uniform(0.1, 3, points)
    return Cell.from_values(**values)


def seconds(call: Callable[[Cell], object], cell: Cell) -> float:
    """Median wall time of a call."""
    call(cell)
    times = []
    for _ in range(REPEATS):
        start = time.perf_counter()
        call(cell)
        times.append(time.perf_counter() - start)
    return statistics.median(times)


def rate(model: Model, case: str) -> float:
    """Million points per second."""
    points = POINTS.get(model.name, 200_000 if case != "soft particles" else 20_000)
    return points / seconds(model.loads["normal"], sweep(case, points)) / 1e6


def main() -> None:
    """Print a table, models down and cases across."""
    print(f"million points per second, one core, median of {REPEATS}")
    print(f"{'':14}" + "".join(f"{case:>16}" for case in CASES))
    for model in MODELS.values():
        if not model.is_reference:
            rates = "".join(f"{rate(model, case):16.3g}" for case in CASES)
            print(f"{model.name:14}{rates}")


if __name__ == "__main__":
    main()
