"""How honest the reference's error estimates are: random cells against finer meshes and orders.

The truth is a solve three orders higher on a mesh whose elements are smaller everywhere, whose
cusps are cut four times later and whose corners are refined thirty times farther. It is itself
uncertain: by about the last of its own steps, for each order comes at least twice closer to the
limit. So the ratio of estimate to error counts errors below that uncertainty as if they were as
large.
"""

from __future__ import annotations

import time
from dataclasses import dataclass, replace

import numpy as np

from bondcell.cell import Cell
from bondcell.fem.reference import solve
from bondcell.fem.structured import find_load, solve_level
from bondcell.status import Status

CASES = (
    ("normal", "roller"),
    ("normal", "clamped"),
    ("normal", "confined"),
    ("shear", "roller"),
    ("torsion", "roller"),
    ("bending", "roller"),
)
"""Load and boundary condition of every kind of sample."""

HIGHER, HIGHEST = 3, 13
"""Orders of the truth above the answer's, and at most."""

ROUND_OFF = 1e-12
"""Least relative error that is told apart from none."""


@dataclass(frozen=True)
class Comparison:
    """An answer of the reference and what is known of its error.

    Parameters
    ----------
    status
        `bondcell.status.Status` of the answer.
    order
        Polynomial order of the answer.
    estimate, error
        Estimated and true error of the stiffness, relative.
    uncertainty
        Of the truth, relative.
    seconds
        Wall time of the answer [s].
    """

    status: Status
    order: int
    estimate: float
    error: float
    uncertainty: float
    seconds: float

    @property
    def ratio(self) -> float:
        """Estimate over error, the latter counted as the truth's uncertainty at least."""
        return self.estimate / max(self.error, self.uncertainty, ROUND_OFF)

    @property
    def is_honest(self) -> bool:
        """Whether the estimate is no less than the true error."""
        return self.error <= self.estimate


def random_cell(rng: np.random.Generator) -> Cell:
    """A cell of the range that the reference promises its accuracy in, lengths over a radius."""
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


def compare(cell: Cell, load: str, bc: str, tolerance: float) -> Comparison:
    """Solve one cell and its truth."""
    started = time.perf_counter()
    answer = solve(cell, load, bc, tolerance)
    seconds = time.perf_counter() - started
    usual = find_load(load, bc).grading
    finer = replace(
        usual,
        growth=3.0,
        largest=0.3,
        foot=usual.foot / 4,
        foot_growth=4.0,
        corner=usual.corner / 30,
        corner_growth=4.0,
        tallest=1.0,
    )
    order = min(int(answer.order[0]) + HIGHER, HIGHEST)
    before, true = (
        solve_level(cell, p, bc, load, grading=finer).stiffness for p in (order - 1, order)
    )
    return Comparison(
        status=Status(int(answer.status[0])),
        order=int(answer.order[0]),
        estimate=float(answer.error_estimate[0]),
        error=abs(float(answer.stiffness[0]) / true - 1),
        uncertainty=abs(before / true - 1),
        seconds=seconds,
    )
