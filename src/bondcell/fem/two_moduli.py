"""The reference where shear and bulk modulus of the matrix relax by a series each.

At a real Laplace variable s the matrix is elastic, with the shares x(s) and y(s) of its moduli. The
solutions at few such states span a space in which the whole cell, projected, is a `Network`: its
series follows exactly, and its stiffness is never below that of the cell, from which it differs by
the square of what the space misses. States are added halfway between known ones until those met
fresh are already there.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.sparse import csc_array

from bondcell.cell import FloatArray
from bondcell.fem.full_system import FullSystem
from bondcell.fem.symmetric_solve import factored
from bondcell.prony.chain import Chain
from bondcell.prony.conventions import Relaxing
from bondcell.prony.network import Network
from bondcell.prony.springs import side_by_side

REACH = 10.0
"""States reach this far beyond the fastest and the slowest rate."""

FIRST_SPACING = 4.0
"""Decades of s between the first states."""

MOST_STATES = 80
"""States at which the search gives up."""

STIFF_BULK = 1e6
"""Bulk over shear modulus above which pressures are found by iteration."""

PRESSURE_STEPS, SETTLED = 30, 1e-10
"""Steps of that iteration at most, and the relative change that ends it."""

NEW = 1e-11
"""Part of a solution outside the space below which it brings nothing new."""


@dataclass(frozen=True)
class TwoModuli:
    """Reduced models whose stiffness adds up to the cell's.

    Parameters
    ----------
    networks
        Each with what it counts in the whole.
    bears_at_rest
        Whether the cell bears load once its shear modulus is gone.
    missed
        Largest relative error at states that the space had not seen.
    """

    networks: tuple[tuple[Network, float], ...]
    bears_at_rest: bool
    missed: float

    def stiffness(self, shear: FloatArray, bulk: FloatArray) -> FloatArray:
        """K at shares of both moduli, shape of the shares (states,)."""
        parts = [factor * network.stiffness(shear, bulk) for network, factor in self.networks]
        return np.asarray(np.sum(parts, axis=0))

    def series(self, matrix: Relaxing) -> Chain:
        """The exact series of the reduced models."""
        shear, bulk = _chains(matrix)
        lasts = float(shear.equilibrium) > 0
        bears = lasts or (self.bears_at_rest and float(bulk.equilibrium) > 0)
        parts = [
            network.relaxation(shear, bulk, bears).times_factor(factor)
            for network, factor in self.networks
        ]
        return parts[0] if len(parts) == 1 else side_by_side(*parts)


def laplace_path(matrix: Relaxing, lowest: float) -> tuple[float, float]:
    """Ends of the real Laplace variables [1/s] between which the bond relaxes.

    Parameters
    ----------
    matrix
        One cell and how its matrix relaxes.
    lowest
        Share of a modulus below which the cell is linear in it.

    Notes
    -----
    A modulus with the equilibrium share e has its slowest zero no later than its longest time over
    e; the matrix cannot relax later beside it.
    """
    chains = [chain for chain in _chains(matrix) if chain.count]
    if not chains:
        return 1.0, 1.0
    slow = min(max(float(c.equilibrium), lowest) / c.times.max() for c in chains)
    fast = max(1 / c.times.min() for c in chains)
    return float(slow / REACH), float(fast * REACH)


def shares(matrix: Relaxing, s: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Shares of shear and bulk modulus at real Laplace variables."""
    shear, bulk = _chains(matrix)
    return shear.transform(s), bulk.transform(s)


def _chains(matrix: Relaxing) -> tuple[Chain, Chain]:
    assert matrix.prony.bulk is not None
    return matrix.prony.shear, matrix.prony.bulk


def reduce_two(
    matrix: Relaxing,
    systems: tuple[FullSystem, ...],
    lowest: float,
    bears_at_rest: bool,
    tolerance: float,
) -> TwoModuli:
    """Reduce a cell for the states that its matrix passes.

    Parameters
    ----------
    matrix
        One cell and how its matrix relaxes, with ``separate``.
    systems
        What `full_system.full_systems` gave for the cell.
    lowest
        See `laplace_path`.
    bears_at_rest
        See `TwoModuli`.
    tolerance
        Relative error that the reduction may leave.
    """
    spaces = [_Space(matrix, system) for system in systems]
    slow, fast = laplace_path(matrix, lowest)
    lasts = min(float(chain.equilibrium) for chain in _chains(matrix)) > 0
    first = int(np.ceil(np.log10(fast / slow) / FIRST_SPACING)) + 1
    logs = np.linspace(np.log(slow), np.log(fast), first)
    for s in [np.inf, *np.exp(logs[::-1]), *([0.0] if lasts else [])]:
        _visit(spaces, matrix, s)
    # Each stretch between known states: its ends, and the error last met in it.
    stretches = [(logs[k], logs[k + 1], np.inf) for k in range(logs.size - 1)]
    visited = logs.size + 2
    while stretches and visited < MOST_STATES:
        stretches.sort(key=lambda stretch: stretch[2])
        low, high, error = stretches.pop()
        if error <= tolerance:
            stretches.append((low, high, error))
            break
        middle = (low + high) / 2
        error = _visit(spaces, matrix, float(np.exp(middle)))
        visited += 1
        stretches += [(low, middle, error), (middle, high, error)]
    missed = max((error for _, _, error in stretches), default=0.0)
    networks = tuple((space.network, space.system.factor) for space in spaces)
    return TwoModuli(networks, bears_at_rest, float(missed))


def _visit(spaces: list[_Space], matrix: Relaxing, s: float) -> float:
    """Add the solutions of one state; returns the relative error before."""
    x, y = shares(matrix, np.array([s]))
    known = all(space.size for space in spaces)
    found = [space.system.factor * space.network.stiffness(x, y)[0] for space in spaces if known]
    true = [space.system.factor * space.extend(float(x[0]), float(y[0])) for space in spaces]
    return abs(sum(found) / sum(true) - 1) if known else np.inf


class _Gram:
    """Products ``v_i^T (A v_j)`` of vectors that come one by one."""

    def __init__(self, length: int) -> None:
        self.vectors, self.matrix = np.empty((length, 0)), np.empty((0, 0))

    def append(self, vector: FloatArray, image: FloatArray) -> None:
        """Add a vector and what the operator makes of it."""
        row = np.append(self.vectors.T @ image, vector @ image)
        self.vectors = np.column_stack([self.vectors, vector])
        self.matrix = np.block([[self.matrix, row[:-1, None]], [row]])


class _Space:
    """Span of solutions of one system, and the system projected on it."""

    def __init__(self, matrix: Relaxing, system: FullSystem) -> None:
        self.system = system
        self._free = np.flatnonzero(system.free)
        self._shear = float(matrix.shear[0])
        self._bulk = 1 / float(matrix.bulk_compliance[0])
        pressures, unknowns = system.bulk_root.shape
        self._lasting, self._of_shear = _Gram(unknowns), _Gram(unknowns)
        self._of_bulk = _Gram(pressures)

    @property
    def size(self) -> int:
        """Solutions so far."""
        return len(self._lasting.matrix)

    @property
    def network(self) -> Network:
        """The system on the space: the first solution, then unknowns beyond it."""
        shear, bulk = self._shear * self._of_shear.matrix, self._bulk * self._of_bulk.matrix
        return Network(self._lasting.matrix, shear, bulk)

    def extend(self, shear_share: float, bulk_share: float) -> float:
        """Add the solution of one state; returns its stiffness."""
        system = self.system
        shear, bulk = shear_share * self._shear, bulk_share * self._bulk
        beyond = self._solve(shear, bulk)
        moved = system.lift + beyond
        dilatation = system.bulk_root @ moved
        energy = beyond @ (system.particles @ beyond) + shear * (moved @ (system.shear @ moved))
        if not self.size:
            self._append(beyond, moved)
        else:
            known = self._lasting.vectors
            vector = beyond - known[:, 0]
            whole = np.linalg.norm(vector)
            for _ in range(2):
                vector = vector - known[:, 1:] @ (known[:, 1:].T @ vector)
            left = np.linalg.norm(vector)
            if left > NEW * whole:
                self._append(vector / left, vector / left)
        return float(energy + bulk * (dilatation @ dilatation))

    def _append(self, beyond: FloatArray, moved: FloatArray) -> None:
        """One more direction; in the lift the particles move rigidly, without energy."""
        system = self.system
        self._lasting.append(beyond, system.particles @ beyond)
        self._of_shear.append(moved, system.shear @ moved)
        dilatation = system.bulk_root @ moved
        self._of_bulk.append(dilatation, dilatation)

    def _solve(self, shear: float, bulk: float) -> FloatArray:
        """Displacement beyond the lift.

        Notes
        -----
        Of a nearly incompressible matrix the factors are those of a softer bulk modulus b: with
        the pressure p the steps ``A_b u = -(...) - (1 - b/kappa) R^T p, p <- (1 - b/kappa) p + b R
        u`` lead to the solution, each leaving about mu/b of the error.
        """
        system, free = self.system, self._free
        soft = min(bulk, STIFF_BULK * shear) if shear > 0 else bulk
        factors = factored(self._elastic + shear * self._own_shear + soft * self._own_bulk)
        root, lift = system.bulk_root, system.lift
        force = shear * (system.shear @ lift) + soft * (root.T @ (root @ lift))
        part = 1 - soft / bulk if bulk > 0 else 0.0
        pressure, beyond = np.zeros(root.shape[0]), np.zeros(lift.size)
        for _ in range(PRESSURE_STEPS):
            before = beyond
            right = force + part * (root.T @ pressure)
            beyond = np.zeros(lift.size)
            beyond[free] = factors.solve(-right[free])
            if part == 0 or np.linalg.norm(beyond - before) <= SETTLED * np.linalg.norm(beyond):
                break
            pressure = part * pressure + soft * (root @ (lift + beyond))
        return beyond

    @cached_property
    def _elastic(self) -> csc_array:
        return self._inside(self.system.particles)

    @cached_property
    def _own_shear(self) -> csc_array:
        return self._inside(self.system.shear)

    @cached_property
    def _own_bulk(self) -> csc_array:
        return self._inside(self.system.bulk)

    def _inside(self, operator: csc_array) -> csc_array:
        return csc_array(operator[np.ix_(self._free, self._free)])
