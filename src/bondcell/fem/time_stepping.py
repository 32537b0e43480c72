"""Relaxation of one cell by stepping through time: the independent check of the exact series.

Nothing is reduced and no eigenvalue solved: every Maxwell element has its own field on the whole
mesh.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike
from scipy.sparse import csc_array, csr_array

from bondcell.cell import FloatArray
from bondcell.errors import InputError, Violation
from bondcell.fem.full_system import FullSystem
from bondcell.fem.symmetric_solve import factored
from bondcell.fem.threads import one_thread
from bondcell.prony.chain import Chain
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


def operators(
    matrix: Relaxing, system: FullSystem
) -> tuple[csr_array, list[tuple[Chain, csr_array]]]:
    """What lasts of the matrix, and what relaxes: shares over time, operators at t = 0."""
    if matrix.bulk_compliance[0] == 0:
        raise InputError([Violation("poisson_m", 0.5, "below 0.5: there is no pressure unknown")])
    shear = float(matrix.shear[0]) * system.shear
    bulk = system.bulk / float(matrix.bulk_compliance[0])
    own = matrix.prony.shear
    if matrix.convention == "constant_poisson":
        return 0 * bulk, [(own, csr_array(shear + bulk))]
    if matrix.prony.bulk is None:
        return csr_array(bulk), [(own, shear)]
    return 0 * bulk, [(own, shear), (matrix.prony.bulk, csr_array(bulk))]


@one_thread()
def step_through(matrix: Relaxing, systems: Sequence[FullSystem], times: FloatArray) -> FloatArray:
    """Stiffness at the given times, each the end of one step.

    Parameters
    ----------
    matrix
        One cell and how its matrix relaxes.
    systems
        What `full_system.full_systems` gave for the cell.
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
    that do not; shear and bulk modulus may each have such a series and M. The error is of second
    order in the step.
    """
    return np.sum([_step_through(matrix, system, times) for system in systems], axis=0)


def _step_through(matrix: Relaxing, system: FullSystem, times: FloatArray) -> FloatArray:
    free = np.flatnonzero(system.free)
    lasting, relaxing = operators(matrix, system)
    parts = [_Part(chain, operator, system.lift) for chain, operator in relaxing]
    # The lift moves particle j as a rigid body: the particles' forces do no work on it, and
    # summed they would only leave round-off.
    of_lift = lasting @ system.lift
    inside = np.ix_(free, free)
    elastic = csc_array((system.particles + lasting)[inside])
    blocks = [csc_array(part.operator[inside]) for part in parts]

    def solve(shares: list[float], force: FloatArray) -> FloatArray:
        """Displacement beyond the lift for moduli and forces on it."""
        whole, right = elastic, of_lift + force
        for share, block, part in zip(shares, blocks, parts, strict=True):
            whole, right = whole + share * block, right + share * part.of_lift
        beyond = np.zeros_like(system.lift)
        beyond[free] = factored(whole).solve(-right[free])
        return beyond

    def reaction(beyond: FloatArray) -> float:
        stress = sum(part.stress(system.lift + beyond) for part in parts)
        return float(system.lift @ (of_lift + lasting @ beyond + stress))

    u = solve([1.0] * len(parts), np.zeros_like(system.lift))
    for part in parts:
        part.start(system.lift + u)
    result, before = [reaction(u)], 0.0
    for now in times:
        ahead = [part.ahead(now - before, system.lift + u) for part in parts]
        new = solve([share for share, _ in ahead], np.sum([force for _, force in ahead], axis=0))
        for part in parts:
            part.advance(now - before, new - u)
        u, before = new, now
        result.append(reaction(u))
    return np.array(result) * system.factor


class _Part:
    """One relaxing modulus: its series, its operator, and a field for every Maxwell element."""

    def __init__(self, chain: Chain, operator: csr_array, lift: FloatArray) -> None:
        self.chain, self.operator, self.of_lift = chain, operator, operator @ lift

    def start(self, displacement: FloatArray) -> None:
        """The step at t = 0."""
        self.fields = np.tile(displacement, (self.chain.count, 1))

    def ahead(self, step: float, displacement: FloatArray) -> tuple[float, FloatArray]:
        """Share of the modulus that a step feels, and the force of what came before."""
        decay, phi = self._decay(step)
        share = float(self.chain.strengths @ phi)
        past = (self.chain.strengths * decay) @ self.fields - share * displacement
        return float(self.chain.equilibrium) + share, self.operator @ past

    def advance(self, step: float, change: FloatArray) -> None:
        """Take a step."""
        decay, phi = self._decay(step)
        self.fields = decay[:, None] * self.fields + phi[:, None] * change

    def stress(self, displacement: FloatArray) -> FloatArray:
        """Forces of the modulus."""
        chain = self.chain
        return self.operator @ (chain.equilibrium * displacement + chain.strengths @ self.fields)

    def _decay(self, step: float) -> tuple[FloatArray, FloatArray]:
        x = step / self.chain.times
        return np.exp(-x), -np.expm1(-x) / x
