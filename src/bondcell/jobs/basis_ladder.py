"""A reduced basis grown vector by vector: its bound and its true error against its size."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray

from bondcell.cell import Cell, FloatArray
from bondcell.errors import InputError, Violation
from bondcell.fem.cell_mesh import build_cell_mesh
from bondcell.fem.cell_operators import CellOperators
from bondcell.fem.level import Level
from bondcell.fem.materials import Materials
from bondcell.fem.reduced_basis import Points, ReducedBasis
from bondcell.fem.structured import OFFSET, Load, find_load, geometry_of
from bondcell.fem.supports import Supports
from bondcell.fem.threads import one_thread
from bondcell.timing import Timing, timed

MATERIALS, SAMPLE = 400, 40
"""Materials that the basis serves, and how many of them are also solved without it."""

POISSON = np.linspace(0.0, 0.4999, 16)
"""Poisson's ratios of the matrix in the random materials."""

RATIOS = (0.0, 8.0)
"""Decades of the modulus ratio in the random materials."""

TOLERANCES = tuple(10.0**-k for k in range(1, 11))
"""Bounds at which the growing basis is looked at."""

SEED = 2013


@dataclass(frozen=True)
class BasisRung:
    """A basis of one size.

    Parameters
    ----------
    size
        Vectors of the basis.
    level
        The case's own stiffness by it; its time is that of one point among many.
    bound, error
        Largest relative bound over all random materials, and largest true error (against the
        solution without the basis) over the sample of them.
    timing
        What one point among many takes.
    """

    size: int
    level: Level
    bound: float
    error: float
    timing: Timing


@one_thread()
def climb_basis(cell: Cell, order: int, bc: str, load: str, repeats: int) -> Iterator[BasisRung]:
    """Grow a basis on random materials in the geometry of one cell.

    Parameters
    ----------
    cell
        A single cell: its geometry and particles; its matrix is one of the materials.
    order
        Polynomial order of the discretisation.
    bc, load
        Boundary condition (of the normal load) and load.
    repeats
        Timed runs, of which the median is told.

    Raises
    ------
    InputError
        The particles are rigid or softer than the matrix: the materials sampled are not like that.
    """
    study = _Materials(cell.ravel(), load, bc, order)
    ratios = study.points.ratios
    if not (np.isfinite(ratios).all() and ratios.min() >= 1):
        allowed = "finite and at least that of the matrix, for the random materials"
        raise InputError([Violation("young_i", float(cell.young_i.ravel()[0]), allowed)])
    basis = study.basis(TOLERANCES[0])
    exact = study.exact()
    last = 0
    for tolerance in TOLERANCES:
        basis.refine(study.points, tolerance)
        if basis.size == last:
            continue
        last = basis.size
        (response, bound), timing = timed(partial(basis.respond, study.points), repeats)
        timing = timing.per(MATERIALS)
        own, doubt = (values[:, study.index] for values in (study.diagonal(response), bound))
        stiffness = study.scale * own
        largest = float((doubt / np.abs(own)).max())
        yield BasisRung(
            size=basis.size,
            level=Level(float(stiffness[0]), basis.size, study.elements, 0.0, 0.0, timing.seconds),
            bound=largest,
            error=float(np.abs(stiffness[:SAMPLE] / exact - 1).max()),
            timing=timing,
        )
        if largest <= TOLERANCES[-1]:
            break  # more vectors would only show round-off


class _Materials:
    """Random materials on one geometry, the case's own first."""

    def __init__(self, cell: Cell, load: str, bc: str, order: int) -> None:
        entry = find_load(load, bc)
        geometry, own = geometry_of(cell), Materials.of(cell)
        mirrored = geometry.is_mirrored and bool(own.is_mirrored[0])
        half = mirrored and len(entry.halves) == 1
        mesh = build_cell_mesh(geometry, entry.grading, half)
        self._poisson = [float(own.poisson_i[0]), float(own.poisson_j[0])][: 1 if half else 2]
        self.operators = CellOperators(mesh, order, _supports(entry, half), True)
        self.materials = Materials.of(_random_matrices(cell))
        self.points = Points.of(self.materials, len(self._poisson))
        self.scale = self.materials.shear_m / (2 if self.operators.is_half else 1)
        self.index = min(entry.index, self.operators.motions - 1)
        self.elements = self.operators.elements
        self._offset = OFFSET * geometry.gap / max(geometry.radius_i, geometry.radius_j)

    def basis(self, tolerance: float) -> ReducedBasis:
        return ReducedBasis(self.operators, self._poisson, self.points, tolerance, self._offset)

    def exact(self) -> FloatArray:
        """Stiffness of the sample without a basis."""
        solved = [self.operators.response(self.materials.constants(k)) for k in range(SAMPLE)]
        return np.array([response[self.index, self.index] for response in solved])

    @staticmethod
    def diagonal(response: FloatArray) -> NDArray[np.float64]:
        return np.diagonal(response, axis1=1, axis2=2)


def _supports(entry: Load, half: bool) -> Supports:
    return entry.halves[0] if half else entry.whole


def _random_matrices(cell: Cell) -> Cell:
    """The cell, then the same particles in random matrices."""
    random = np.random.default_rng(SEED)
    inputs = {name: np.full(MATERIALS, value[0]) for name, value in cell.as_dict().items()}
    softer = np.minimum(inputs["young_i"], inputs["young_j"])[1:]
    inputs["poisson_m"][1:] = random.choice(POISSON, MATERIALS - 1)
    # A ratio of shear moduli of at least one, whatever the Poisson's ratios.
    inputs["young_m"][1:] = softer / 2 / 10 ** random.uniform(*RATIOS, MATERIALS - 1)
    return Cell.from_values(**inputs).ravel()
