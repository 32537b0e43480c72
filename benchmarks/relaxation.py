"""Relaxation: speed of the series, and error against run time of the ways to K(t); run by hand.

CPU seconds of one core. The twelve-term set of an asphalt mixture over 14 decades.
"""

import os

os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import time
from collections.abc import Callable
from typing import TypeVar

import numpy as np

from bondcell.cell import Cell
from bondcell.fem import relaxing_reference
from bondcell.fem.full_system import full_systems
from bondcell.fem.laplace_inversion import invert_reference
from bondcell.fem.materials import Materials
from bondcell.fem.one_modulus import reduce_one
from bondcell.fem.structured import CellSolver, find_load, geometry_of
from bondcell.fem.threads import one_thread
from bondcell.fem.time_stepping import graded_times, step_through
from bondcell.models import MODELS
from bondcell.prony.bond_series import bond_series
from bondcell.prony.chain import Chain
from bondcell.prony.conventions import Relaxing
from bondcell.prony.prony import Prony

TIMES = [1.5e-7, 2.811e-6, 5.267e-5, 9.869e-4, 0.01849, 0.3465]
TIMES += [6.493, 121.7, 2280.0, 4.272e4, 8.005e5, 1.5e7]
MODULI = [2160.0, 3848.0, 5727.0, 6531.0, 5286.0, 2956.0, 1232.0, 458.8, 179.6, 74.2, 32.1, 14.3]
LONG_TERM = 412.8
WEIGHTS = np.array(MODULI) / (sum(MODULI) + LONG_TERM)
TWELVE = Prony(WEIGHTS, TIMES)
WITH_BULK = Prony(WEIGHTS, TIMES, bulk_weights=WEIGHTS / 3, bulk_times=TIMES)
BASE = {
    "radius_i": 7.5e-3,
    "gap": 5e-4,
    "young_i": 3e10,
    "young_m": 1.4e6,
    "poisson_i": 0.25,
    "poisson_m": 0.46,
}
STEPS = (2, 4, 8, 16)
ORDER = 6
Answer = TypeVar("Answer")


def measured(call: Callable[[], Answer]) -> tuple[Answer, float]:
    start = time.process_time()
    answer = call()
    return answer, time.process_time() - start


def models() -> None:
    """Series of many points by each analytic model."""
    rng = np.random.default_rng(7)
    print(f"{'model':14}{'points':>8}{'terms':>8}{'CPU s':>10}")
    for name, model in MODELS.items():
        if model.is_reference:
            continue
        points = {"fsi": 10_000, "parallel_bond": 10_000, "generatrix": 1000, "general": 1000}
        count = points.get(name, 50)
        sweep = BASE | {
            "gap": 7.5e-3 * 10 ** rng.uniform(-3, 0, count),
            "young_m": 1.4e6 * 10 ** rng.uniform(-1, 2, count),
        }
        matrix = Relaxing.of(Cell.from_values(**sweep).ravel(), TWELVE, "constant_bulk")
        (series, _), seconds = measured(lambda m=matrix, f=model: bond_series(f, "normal", m))
        print(f"{name:14}{count:8}{series.count:8}{seconds:10.3f}")


def cold(matrix: Relaxing) -> relaxing_reference.RelaxingReference:
    """The series with everything that could be remembered forgotten."""
    relaxing_reference.forget()
    return relaxing_reference.relax(matrix)


def of_order(matrix: Relaxing, order: int) -> Chain:
    """The exact series of one discretisation, for which stepping is compared with it."""
    solver = CellSolver(geometry_of(matrix.cell), find_load("normal", "roller"), True, order)
    model = reduce_one(
        lambda x: solver.stiffness(Materials.of(matrix.at(x)).constants(0)), 1e-3, False, 1e-10
    )
    return model.series(matrix.prony.shear)


def row(way: str, steps: int, error: float, seconds: float) -> None:
    print(f"{way:34}{steps:7}{error:12.1e}{seconds:10.3f}")


def reference() -> None:
    """Error against run time on the base cell; stepping and inversion on one discretisation."""
    matrix = Relaxing.of(Cell.from_values(**BASE).ravel(), TWELVE, "constant_bulk")
    times = np.geomspace(1e-9, 1e9, 200)
    cold(matrix)
    answer, seconds = measured(lambda: cold(matrix))
    exact, more = measured(lambda: answer.series.relaxation(times))
    print(f"\nbase cell, twelve terms, constant bulk modulus\n{'way':34}{'steps':>7}", end="")
    print(f"{'error':>12}{'CPU s':>10}")
    row("exact series at 200 times", 0, answer.error_estimate, seconds + more)
    both = Relaxing.of(matrix.cell, WITH_BULK, None)
    cold(both)
    other, seconds = measured(lambda: cold(both))
    _, more = measured(lambda: other.series.relaxation(times))
    row("the same with twelve bulk terms", 0, other.error_estimate, seconds + more)
    shortcut = float(answer.series.instantaneous) * TWELVE.relaxation_modulus(times)
    row("K(0) g(t), wrong", 0, float(np.abs(shortcut / exact - 1).max()), 0.0)
    with one_thread():
        series = of_order(matrix, ORDER)
    systems, assembly = measured(lambda: full_systems(matrix.cell, ORDER))
    few = np.geomspace(1e-8, 1e8, 17)
    for steps in STEPS:
        at = graded_times(few, steps, first=1e-8)
        wanted = np.searchsorted(at, few * (1 - 1e-12))
        values, seconds = measured(lambda at=at: step_through(matrix, systems, at))
        error = float(np.abs(values[1 + wanted] / series.relaxation(few) - 1).max())
        row(f"stepping, order {ORDER}, {steps} a decade", at.size, error, seconds + assembly)
    few = np.array([1e-4, 1.0, 1e4])
    values, seconds = measured(lambda: invert_reference(matrix, systems, few))
    error = float(np.abs(values / series.relaxation(few) - 1).max())
    row(f"Laplace inversion, order {ORDER}, 3 times", 0, error, seconds + assembly)


if __name__ == "__main__":
    models()
    reference()
