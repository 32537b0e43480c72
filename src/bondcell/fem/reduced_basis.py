"""Thousands of materials on one geometry: a reduced basis on the interface, with an error bound.

For one geometry the response depends on the particles' shear moduli over the matrix's, ``rho``,
and on the matrix's Poisson's ratio, through its compressibility ``e = mu/kappa``::

    X(e, rho) w = b(e),   K = c(e) - b(e)^T w,   X = S(e) + rho_i P_i + rho_j P_j

``S, b, c`` are smooth in ``log(e + d)``, so they are interpolated between few of their values;
``w`` lies close to a space of few dimensions, which a greedy search spans. Pressures stay as they
are.

With the residual ``r`` of a reduced solution the stiffness errs by ``r^T X^-1 r``, always upward.
``S`` grows as ``e`` falls and ``X`` with ``rho``, so ``r^T X_0^-1 r`` at the largest ``e`` and any
smaller ``rho`` bounds that error.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.linalg
from numpy.typing import NDArray

from bondcell.cell import FloatArray
from bondcell.fem.cell_operators import CellOperators
from bondcell.fem.interpolated_matrix import InterpolatedMatrix
from bondcell.fem.materials import Materials
from bondcell.fem.symmetric_solve import solve_symmetric

LARGEST_BASIS = 60
"""Vectors at which the greedy search gives up."""

TRAINING = 300
"""Points of the sweep that the greedy search looks at."""


@dataclass(frozen=True)
class Points:
    """Materials of many points on one geometry, arrays of shape (points,).

    Parameters
    ----------
    ratios
        Shear moduli of the particles over the matrix's, shape (points, particles); infinite where
        a particle is rigid.
    compressibility
        ``mu/kappa`` of the matrix.
    """

    ratios: FloatArray
    compressibility: FloatArray

    @classmethod
    def of(cls, materials: Materials, particles: int) -> Points:
        """Collect the dimensionless numbers."""
        return cls(materials.ratios[:, :particles], materials.compressibility)

    def take(self, index: NDArray[np.int64]) -> Points:
        """The points at ``index``."""
        return Points(self.ratios[index], self.compressibility[index])


class ReducedBasis:
    """Responses of many points from few solutions.

    Parameters
    ----------
    operators
        One geometry, order and load.
    poisson_particles
        Poisson's ratio of each particle, the same at all points.
    points
        The points to serve; their particles are no softer than the matrix.
    tolerance
        Relative error aimed at.
    offset
        See `interpolated_matrix.InterpolatedMatrix`.
    """

    def __init__(
        self,
        operators: CellOperators,
        poisson_particles: list[float],
        points: Points,
        tolerance: float,
        offset: float,
    ) -> None:
        self._operators = operators
        self._matrix = InterpolatedMatrix(operators, points.compressibility, offset, tolerance / 10)
        self._particles = []
        for k, poisson in enumerate(poisson_particles):
            at = operators.of_particle[k]
            system = np.zeros((operators.size, operators.size))
            if np.isfinite(points.ratios[:, k]).any():
                system[np.ix_(at, at)] = operators.particle_system(k, poisson)
            self._particles.append(system)
        self._prepare_bound(points)
        self._pressures = np.eye(operators.size)[:, ~operators.is_displacement]
        self._basis, self._spanned = self._pressures, False
        self.refine(points, tolerance)

    @property
    def size(self) -> int:
        """Dimension of the reduced space."""
        return int(self._basis.shape[1])

    @property
    def interpolation_error(self) -> float:
        """Relative error of the interpolation in compressibility, measured between its nodes."""
        return self._matrix.error

    @property
    def nodes(self) -> int:
        """Condensations of the matrix that the interpolation uses."""
        return int(self._matrix.nodes.size)

    def _prepare_bound(self, points: Points) -> None:
        """Factor ``X_0`` at the largest compressibility and at a ladder of ratios."""
        moving = self._operators.is_displacement
        at = int(self._matrix.nodes.argmax())
        matrix = self._matrix.matrix[at][np.ix_(moving, moving)]
        lowest = np.where(np.isfinite(points.ratios), points.ratios, np.inf).min(axis=0)
        self._lowest = np.where(np.isfinite(lowest), lowest, 1.0)
        relative = points.ratios / self._lowest
        finite = relative[np.isfinite(relative)]
        highest = float(finite.max()) if finite.size else 1.0
        self._steps = 4.0 ** np.arange(int(np.log(highest) / np.log(4)) + 1)
        self._inverses = []
        for step in self._steps:
            system = matrix + sum(
                step * low * particle[np.ix_(moving, moving)]
                for low, particle in zip(self._lowest, self._particles, strict=True)
            )
            factor = scipy.linalg.cho_factor(system, check_finite=False)
            self._inverses.append(scipy.linalg.cho_solve(factor, np.eye(len(system))))

    def refine(self, points: Points, tolerance: float) -> bool:
        """Greedy: add the exact solution where the bound is largest, until all are small.

        Returns whether anything was added.
        """
        count = points.compressibility.size
        chosen = np.unique(np.linspace(0, count - 1, min(count, TRAINING)).astype(int))
        training = points.take(chosen)
        # Soft particles move their interface most; a rigid one would give nothing to start from.
        start, last, worst = self.size, -1, int(training.ratios.min(axis=1).argmin())
        if self._spanned:
            worst = self._worst(training)[0]
        while self.size < LARGEST_BASIS and worst != last:
            self._extend(self._solve_exactly(training, worst))
            self._spanned = True
            last = worst
            worst, relative = self._worst(training)
            if relative <= tolerance / 2:
                break
        return self.size > start

    def _worst(self, points: Points) -> tuple[int, float]:
        """The point with the largest relative bound, and that bound."""
        response, bound = self.respond(points)
        size = np.abs(np.diagonal(response, axis1=1, axis2=2))
        relative = (bound / size).max(axis=1)
        return int(relative.argmax()), float(relative.max())

    def _solve_exactly(self, points: Points, k: int) -> FloatArray:
        weights = self._matrix.weights(points.compressibility[k : k + 1])
        system = np.tensordot(weights, self._matrix.matrix, 1)[0]
        right = np.tensordot(weights, self._matrix.coupling, 1)[0]
        free = np.ones(self._operators.size, dtype=bool)
        for ratio, particle, at in zip(
            points.ratios[k], self._particles, self._operators.of_particle, strict=True
        ):
            if np.isinf(ratio):
                free[at] = False
            else:
                system = system + ratio * particle
        solution = np.zeros_like(right)
        solution[free] = solve_symmetric(system[np.ix_(free, free)], right[free])
        return solution

    def _extend(self, solution: FloatArray) -> None:
        """Orthonormalise and append; interfaces move separately, so that one may be rigid."""
        vectors = solution.copy()
        vectors[~self._operators.is_displacement] = 0
        split = []
        for at in self._operators.of_particle:
            own = np.zeros_like(vectors)
            own[at] = vectors[at]
            split.append(own)
        candidates = np.concatenate(split, axis=1)
        norms = np.linalg.norm(candidates, axis=0)
        for _ in range(2):
            candidates = candidates - self._basis @ (self._basis.T @ candidates)
        orthonormal, triangle = np.linalg.qr(candidates)
        fresh = np.abs(np.diagonal(triangle)) > 1e-12 * norms
        self._basis = np.concatenate((self._basis, orthonormal[:, fresh]), axis=1)
        self._project()

    def _project(self) -> None:
        v, matrix = self._basis, self._matrix
        self._applied = matrix.matrix @ v
        self._reduced = v.T @ self._applied
        self._reduced_coupling = v.T @ matrix.coupling
        self._applied_particles = [particle @ v for particle in self._particles]
        self._reduced_particles = [v.T @ applied for applied in self._applied_particles]

    def respond(self, points: Points) -> tuple[FloatArray, FloatArray]:
        """Responses and their error bounds, unit shear modulus of the matrix.

        Returns
        -------
        response
            Shape (points, motions, motions); not halved for half a cell.
        bound
            Of the error of each motion's own stiffness, shape (points, motions).
        """
        weights = self._matrix.weights(points.compressibility)
        finite = np.where(np.isfinite(points.ratios), points.ratios, 0.0)
        n, m = self.size, self._operators.motions
        nodes, count = len(self._reduced), len(weights)
        system = (weights @ self._reduced.reshape(nodes, n * n)).reshape(count, n, n)
        for k, reduced in enumerate(self._reduced_particles):
            system += finite[:, k, None, None] * reduced
        right = (weights @ self._reduced_coupling.reshape(nodes, n * m)).reshape(count, n, m)
        self._fix_rigid(system, right, points.ratios)
        solution = np.linalg.solve(system, right)
        own = np.tensordot(weights, self._matrix.own, 1)
        response = own - right.transpose(0, 2, 1) @ solution
        return response, self._bound(points, weights, finite, solution)

    def _fix_rigid(self, system: FloatArray, right: FloatArray, ratios: FloatArray) -> None:
        """Hold the interface of a rigid particle: identity rows and no load."""
        for k, at in enumerate(self._operators.of_particle):
            rigid = np.flatnonzero(np.isinf(ratios[:, k]))
            own = np.flatnonzero(np.abs(self._basis[at]).max(axis=0) > 0)
            if rigid.size:
                system[rigid[:, None], own] = 0
                system[rigid[:, None], :, own] = 0
                system[rigid[:, None], own, own] = 1
                right[rigid[:, None], own] = 0

    def _bound(
        self, points: Points, weights: FloatArray, finite: FloatArray, solution: FloatArray
    ) -> FloatArray:
        moving = self._operators.is_displacement
        (count, n, m), nodes = solution.shape, weights.shape[1]
        spread = (weights[:, :, None, None] * solution[:, None]).reshape(count, nodes * n, m)
        applied = self._applied[:, moving].transpose(1, 0, 2).reshape(moving.sum(), nodes * n)
        coupling = np.tensordot(weights, self._matrix.coupling[:, moving], 1)
        residual = coupling - np.matmul(applied, spread)
        for k, own in enumerate(self._applied_particles):
            residual -= finite[:, k, None, None] * np.matmul(own[moving], solution)
        relative = points.ratios / self._lowest
        for k, at in enumerate(self._operators.of_particle):
            held = np.isin(np.flatnonzero(moving), at)
            residual[np.ix_(np.isinf(points.ratios[:, k]), held)] = 0
        steps = np.searchsorted(self._steps, relative.min(axis=1) * (1 + 1e-12), "right") - 1
        bound = np.empty((count, m))
        for step in np.unique(steps):
            at = np.flatnonzero(steps == step)
            pulled = np.matmul(self._inverses[step], residual[at])
            bound[at] = np.einsum("pdm,pdm->pm", residual[at], pulled)
        return bound
