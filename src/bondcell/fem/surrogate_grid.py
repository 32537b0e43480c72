"""Reference stiffness of equal pairs on the Chebyshev grid that the surrogate interpolates."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from bondcell.cell import FloatArray
from bondcell.fem.cell_mesh import Geometry
from bondcell.fem.materials import shear_modulus
from bondcell.fem.structured import CellSolver, find_load
from bondcell.fem.threads import one_thread
from bondcell.models.surrogate_axes import AXES

ORDER = 10
"""Polynomial order of the solves: the discretisation's error stays below 1e-6 on the grid."""


@one_thread()
def sample(load: str, progress: Callable[[int, int], None] | None = None) -> FloatArray:
    """Logarithm of the dimensionless stiffness at the nodes of `AXES`.

    Parameters
    ----------
    load
        ``normal`` (roller), ``shear``, ``torsion`` or ``bending``.
    progress
        Called as ``progress(gaps_done, gaps)``.

    Returns
    -------
    numpy.ndarray
        ``log(K / (E_m R))``, with ``R^3`` for rotations, by node of gap, softness, compressibility
        and particle's Poisson's ratio.
    """
    gaps = AXES.gap_nodes()
    values = np.empty((gaps.size, *AXES.shape[1:]))
    for k, gap in enumerate(gaps):
        values[k] = _at_gap(load, float(gap))
        if progress:
            progress(k + 1, gaps.size)
    return values


def _at_gap(load: str, gap: float) -> FloatArray:
    geometry = Geometry(1.0, 1.0, gap, 1.0)
    entry = find_load(load, "roller")
    solver = CellSolver(geometry, entry, half=True, order=ORDER)
    softness, compressibility, poisson = AXES.material_nodes(gap)
    values = np.empty(AXES.shape[1:])
    for b, e in enumerate(compressibility):
        poisson_m = float((3 - 2 * e) / (6 + 2 * e))
        shear_m = shear_modulus(np.array(1.0), np.array(poisson_m))
        for c, nu in enumerate(poisson):
            with np.errstate(divide="ignore"):
                ratios = 1 / (2 * softness * (1 + nu)) / shear_m
            values[:, b, c] = np.log(shear_m * solver.by_ratio(poisson_m, float(nu), ratios))
    return values
