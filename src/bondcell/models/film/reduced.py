"""Many materials on one geometry: trial fields replaced by a few of their own solutions.

A reduced basis of Ritz type: least energies over fewer fields remain upper bounds. How much they
lose is bounded at every point by the force that the reduced solution leaves unbalanced.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from bondcell.cell import FloatArray
from bondcell.models.film.solve import RIDGE, Solved, combined, least_energies, solved

TOLERANCE = 1e-5
"""Largest loss that is accepted, relative; it is part of the model's error estimate."""

MANY = 400
"""Points on a geometry from which a basis pays."""

LARGEST = 48
"""Fields of a basis; beyond it a basis is no quicker."""

START, STEP = 8, 4
"""Solutions that the basis starts with, and that are added at once."""

PROBES = 64
"""Points that decide on whether and where to add."""

APART = 0.2
"""Solutions added at once differ by more than this in the ratio of some modulus."""

POINTS = 512
"""Points evaluated at once, to bound the memory."""

REPEATED = 1e-11
"""Relative size of what is new in a solution below which it is left out."""


class Basis:
    """Solutions of one geometry and the energies between them.

    Parameters
    ----------
    forms
        Quadratic forms of the fields, the lift first, shape (q, n, n).
    """

    def __init__(self, forms: FloatArray) -> None:
        # The ridge of the single solutions as a part of the forms: the scale is that of A.
        self.forms = forms.copy()
        diagonal = np.einsum("qkk->qk", self.forms)
        diagonal[:, 1:] *= 1 + RIDGE
        self.solutions: list[tuple[FloatArray, Solved]] = []

    def add(self, points: FloatArray) -> None:
        """Solve at points, shape (points, q), and span the basis anew.

        Solutions with the stiffest particles come first: they hardly strain them, and must not be
        mixed with others that do, since those strains are multiplied by the largest moduli.
        """
        for factors, matrix in zip(points, combined(self.forms, points), strict=True):
            self.solutions.append((factors, solved(matrix, ridge=0.0)))
        self.solutions.sort(key=lambda one: -float(one[0][1:].sum()))
        size = np.sqrt(self.forms.sum(axis=0).diagonal()[1:])
        rows = np.stack([one.fields[1:] * size for _, one in self.solutions])
        rows /= np.linalg.norm(rows, axis=1, keepdims=True)
        triangle = np.asarray(np.linalg.qr(rows.T, mode="r"))
        new = np.abs(triangle.diagonal()) > REPEATED
        own, _ = np.linalg.qr(rows[new].T)
        basis = np.zeros((size.size + 1, own.shape[1] + 1))
        basis[0, 0] = 1.0
        basis[1:, 1:] = own / size[:, None]
        self.forces = self.forms @ basis
        self.reduced = basis.T @ self.forces

    @property
    def size(self) -> int:
        """Number of solutions."""
        return len(self.solutions)

    def energies(self, factors: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Least energies over the basis and a bound of how far they are above those of all fields.

        Parameters
        ----------
        factors
            Shape (points, q).

        Notes
        -----
        With the residual r of the reduced solution the loss is ``r . A^-1 r``. All forms are
        positive semidefinite, so ``A >= alpha A'`` for the matrix A' of a solution, alpha the
        least ratio of factors, and ``r . A'^-1 r/alpha`` is a bound; the solution with the largest
        alpha is taken.
        """
        from scipy.linalg import lapack  # as in `bondcell.models.film.solve.solved`

        value, found = _least(combined(self.reduced, factors))
        spread = (factors[:, :, None] * found[:, None, :]).reshape(factors.shape[0], -1)
        rows = self.forces.transpose(0, 2, 1).reshape(spread.shape[1], -1)
        force = (spread @ rows)[:, 1:]
        each = factors.T.copy()
        alphas = np.stack([(each / own[:, None]).min(axis=0) for own, _ in self.solutions])
        nearest = alphas.argmax(axis=0)
        loss = np.empty_like(value)
        for k in np.unique(nearest):
            here = np.flatnonzero(nearest == k)
            one = self.solutions[k][1]
            part, _ = lapack.dtrtrs(one.factor, (force[here] * one.scale[1:]).T, lower=1)
            loss[here] = (part**2).sum(axis=0) / alphas[k, here]
        return value, loss


def _least(matrix: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Least ``x . A x`` with ``x_0 = 1`` and x, for small matrices, shape (points, n, n)."""
    scale = 1 / np.sqrt(np.diagonal(matrix, axis1=-2, axis2=-1))
    matrix *= scale[:, :, None]
    matrix *= scale[:, None, :]
    inner, column = matrix[:, 1:, 1:], matrix[:, 1:, 0]
    found = np.linalg.solve(inner, -column[..., None])[..., 0]
    value = (matrix[:, 0, 0] + (column * found).sum(axis=1)) / scale[:, 0] ** 2
    fields = np.concatenate((scale[:, :1], found * scale[:, 1:]), axis=1) / scale[:, :1]
    return value, fields


def least_energies_of_many(forms: FloatArray, factors: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Least energies of points and bounds of what the reduction adds to them, relative.

    Parameters
    ----------
    forms
        Quadratic forms of the fields, the lift first, shape (q, n, n).
    factors
        The points' moduli, what each form is multiplied by, shape (points, q).

    Notes
    -----
    Solutions are added where the bound is largest among some points, until all of those are
    within `TOLERANCE` or the basis is large; then every point is tried. Those that fail are the
    next round's, and in the end are solved one by one.
    """
    value, error = np.empty(factors.shape[0]), np.zeros(factors.shape[0])
    pending = np.arange(value.size)
    if pending.size >= MANY:
        order = np.random.default_rng(0)
        basis = Basis(forms)
        basis.add(factors[_spread(factors, order.choice(pending, MANY, replace=False))])
        while pending.size >= MANY // 4:
            worst = _worst(basis, factors, order.choice(pending, PROBES, replace=False))
            if worst.size and basis.size + STEP <= LARGEST:
                basis.add(factors[worst])
                continue
            left = []
            for first in range(0, pending.size, POINTS):
                some = pending[first : first + POINTS]
                energy, loss = basis.energies(factors[some])
                good = loss <= TOLERANCE * energy
                value[some[good]] = energy[good]
                error[some[good]] = loss[good] / energy[good]
                left.append(some[~good])
            before, pending = pending.size, np.concatenate(left)
            if worst.size or pending.size == before:
                break
    value[pending], error[pending] = least_energies(forms, factors[pending])
    return value, error


def _spread(factors: FloatArray, points: NDArray[np.int64]) -> NDArray[np.int64]:
    """Some of the points, far from each other in the logarithms of their moduli."""
    place = np.log(factors[points])
    chosen = [int(place.sum(axis=1).argmax())]
    away = np.full(points.size, np.inf)
    while len(chosen) < START:
        away = np.minimum(away, np.abs(place - place[chosen[-1]]).max(axis=1))
        chosen.append(int(away.argmax()))
    return points[chosen]


def _worst(basis: Basis, factors: FloatArray, probes: NDArray[np.int64]) -> NDArray[np.int64]:
    """The probes whose bounds are the largest, above the tolerance, and unlike each other."""
    energy, loss = basis.energies(factors[probes])
    ratio = loss / energy
    chosen: list[int] = []
    for k in np.argsort(-ratio):
        if len(chosen) == STEP or ratio[k] <= TOLERANCE:
            break
        own = factors[probes[k]]
        if all((own / factors[probes[other]]).min() < APART for other in chosen):
            chosen.append(int(k))
    return probes[chosen]
