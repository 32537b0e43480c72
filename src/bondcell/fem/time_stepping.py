"""Relaxation of one cell by stepping through time: the independent check of the exact series.

Nothing is reduced and no eigenvalue solved: every Maxwell element has its own field on the whole
mesh.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike
from scipy.sparse import csc_array, csr_array
from scipy.sparse.linalg import splu

from bondcell.cell import FloatArray
from bondcell.errors import InputError, Violation
from bondcell.fem.full_system import FullSystem
from bondcell.fem.threads import one_thread
from bondcell.prony.conventions import Relaxing


def graded_times(times: ArrayLike, steps_per_decade: int, first: float) -> FloatArray:
    """Ascending times that grow by a constant factor and meet each of the wanted times.

    Parameters
    ----------
    times
        Wanted times [s], positive, ascending.
    steps_per_decade
        Steps in which time grows tenfold.
    first
        Time of the first steps [s]: `steps_per_decade` even ones lead there.

    Examples
    --------
    >>> graded_times([1.0], 2, first=0.1).round(3)
    array([0.05 , 0.1  , 0.316, 1.   ])
    """
    wanted = np.atleast_1d(np.asarray(times, dtype=float))
    start = min(first, float(wanted[0]))
    pieces = [np.linspace(0, start, steps_per_decade + 1)[1:]]
    for low, high in zip(np.concatenate(([start], wanted[:-1])), wanted, strict=True):
        if high > low:
            count = int(np.ceil(steps_per_decade * np.log10(high / low) - 1e-9))
            pieces.append(np.geomspace(low, high, max(1, count) + 1)[1:])
    return np.concatenate(pieces)


def operators(matrix: Relaxing, system: FullSystem) -> tuple[csr_array, csr_array]:
    """What lasts and what relaxes, the latter with its moduli at t = 0."""
    if matrix.convention == "separate":
        allowed = "constant_bulk or constant_poisson"
        raise InputError([Violation("convention", matrix.convention, allowed)])
    if matrix.bulk_compliance[0] == 0:
        raise InputError([Violation("poisson_m", 0.5, "below 0.5: there is no pressure unknown")])
    shear = float(matrix.shear[0]) * system.shear
    bulk = system.bulk / float(matrix.bulk_compliance[0])
    if matrix.convention == "constant_poisson":
        return system.particles, csr_array(shear + bulk)
    return csr_array(system.particles + bulk), shear


@one_thread()
def step_through(matrix: Relaxing, system: FullSystem, times: FloatArray) -> FloatArray:
    """Stiffness at the given times, each the end of one step.

    Parameters
    ----------
    matrix
        One cell and how its matrix relaxes, with ``constant_bulk`` or ``constant_poisson``.
    system
        The cell's operators.
    times
        Ascending, positive [s]; the step of displacement is at t = 0.

    Returns
    -------
    ndarray
        K = F/d [N/m; N m/rad], shape (1 + times,), first that at t = 0.

    Notes
    -----
    Each element's field is ``h = integral of exp(-(t - s)/tau) du(s)``. With u linear in time over
    a step of length dt and ``x = dt/tau``::

        h <- e^-x h + phi(x) (u_new - u),   phi(x) = (1 - e^-x)/x

    and ``(N + (g_inf + sum g_k phi_k) M) u_new = -M sum g_k (e^-x h_k - phi_k u)`` for the unknowns
    that are not prescribed, M the operators that relax at their instantaneous moduli and N those
    that do not. The error is of second order in the step.
    """
    if matrix.convention == "separate":
        allowed = "constant_bulk or constant_poisson"
        raise InputError([Violation("convention", matrix.convention, allowed)])
    chain, free = matrix.prony.shear, system.free
    lasting, relaxing = operators(matrix, system)
    # The lift moves particle j as a rigid body: the particles' forces do no work on it, and
    # summed they would only leave round-off.
    of_lift = lasting @ system.lift - system.particles @ system.lift
    lift_relaxing = relaxing @ system.lift
    inside = np.ix_(np.flatnonzero(free), np.flatnonzero(free))
    blocks = csc_array(lasting[inside]), csc_array(relaxing[inside])
    soft = csr_array(lasting - system.particles)

    def solve(share: float, force: FloatArray) -> FloatArray:
        """Displacement beyond the lift for a modulus and forces on it."""
        right = -(of_lift + share * lift_relaxing + force)[free]
        beyond = np.zeros_like(system.lift)
        beyond[free] = splu(blocks[0] + share * blocks[1]).solve(right)
        return beyond

    def reaction(beyond: FloatArray, stress: FloatArray) -> float:
        lasts = of_lift + soft @ beyond
        return float(system.lift @ (lasts + stress))

    end, weights, tau = float(chain.equilibrium), chain.strengths, chain.times
    u = solve(1.0, np.zeros_like(system.lift))
    fields = np.tile(system.lift + u, (chain.count, 1))
    result = [reaction(u, relaxing @ (system.lift + u))]
    before = 0.0
    for now in times:
        x = (now - before) / tau
        decay, phi = np.exp(-x), -np.expm1(-x) / x
        share = end + float(weights @ phi)
        past = (weights * decay) @ fields - float(weights @ phi) * (system.lift + u)
        new = solve(share, relaxing @ past)
        fields = decay[:, None] * fields + phi[:, None] * (new - u)
        u, before = new, now
        stress = relaxing @ (end * (system.lift + u) + weights @ fields)
        result.append(reaction(u, stress))
    return np.array(result) * system.factor
