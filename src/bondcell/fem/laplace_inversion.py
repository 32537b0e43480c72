"""Relaxation of one cell from complex moduli by Laplace inversion: a check of the exact series.

The full system is solved at complex values of the Laplace variable; no pole, no eigenvalue and no
time step is involved.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.sparse import csc_array, csr_array

from bondcell.cell import FloatArray
from bondcell.fem.full_system import FullSystem
from bondcell.fem.symmetric_solve import factored
from bondcell.fem.threads import one_thread
from bondcell.fem.time_stepping import operators
from bondcell.prony.chain import Chain
from bondcell.prony.conventions import Relaxing

NODES = 18
"""Points of the contour: truncation and round-off are then near 1e-11."""


@one_thread()
def invert_reference(
    matrix: Relaxing, systems: Sequence[FullSystem], times: ArrayLike, nodes: int = NODES
) -> FloatArray:
    """Stiffness at a few times, ``nodes`` complex solutions each.

    Parameters
    ----------
    matrix
        One cell and how its matrix relaxes.
    systems
        What `full_system.full_systems` gave for the cell.
    times
        Positive times [s].
    nodes
        Points of the contour.
    """
    parts = [(system, *operators(matrix, system)) for system in systems]

    def transform(s: complex) -> complex:
        """The stiffness at a complex Laplace variable over s."""
        total = 0j
        for system, lasting, relaxing in parts:
            soft = [(_share(chain, s), operator) for chain, operator in relaxing]
            total += stiffness_at(system, lasting, soft)
        return total / s

    return np.array([talbot(transform, float(t), nodes) for t in np.atleast_1d(times)])


def _share(chain: Chain, s: complex) -> complex:
    return complex(chain.equilibrium + (chain.strengths / (1 + 1 / (s * chain.times))).sum())


def stiffness_at(
    system: FullSystem, lasting: csr_array, relaxing: Sequence[tuple[complex, csr_array]]
) -> complex:
    """Stiffness where relaxing moduli have complex shares of their values at t = 0."""
    free, lift = np.flatnonzero(system.free), system.lift
    soft = lasting.astype(complex)
    for share, operator in relaxing:
        soft = soft + share * operator
    # Particle j moves rigidly in the lift: what its own forces add up to would be round-off.
    of_lift = soft @ lift
    inside = csc_array((soft + system.particles)[np.ix_(free, free)])
    beyond: NDArray[np.complex128] = np.zeros(lift.size, dtype=complex)
    beyond[free] = factored(inside, pivoting=0.01).solve(-of_lift[free])
    return complex(lift @ of_lift + of_lift @ beyond) * system.factor


def talbot(transform: Callable[[complex], complex], time: float, nodes: int = NODES) -> float:
    """Inverse Laplace transform at one time by the fixed Talbot contour.

    Notes
    -----
    ``s(theta) = r theta (cot theta + i)``, ``r = 2 M/(5 t)``, trapezoidal in theta (Abate and
    Valko 2004).

    Examples
    --------
    >>> round(talbot(lambda s: 1 / (s + 1), 2.0), 9)
    0.135335283
    """
    r = 2 * nodes / (5 * time)
    total = 0.5 * np.exp(r * time) * transform(complex(r)).real
    for k in range(1, nodes):
        theta = k * np.pi / nodes
        cotangent = 1 / np.tan(theta)
        s = r * theta * (cotangent + 1j)
        slope = theta + (theta * cotangent - 1) * cotangent
        total += (np.exp(time * s) * transform(complex(s)) * (1 + 1j * slope)).real
    return float(r / nodes * total)
