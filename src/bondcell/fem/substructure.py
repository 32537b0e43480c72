"""One material's part of the cell, condensed to its interface with the other materials.

Every matrix is for unit shear modulus and depends on Poisson's ratio alone, through
``c = kappa/mu = 2 (1 + nu) / (3 (1 - 2 nu))``. The element system is the mixed one::

    [ D    R^T  ] [u]     D: shear matrix, R: root of the bulk matrix, p = c R u
    [ R   -1/c  ] [p]

so ``c = inf`` (an incompressible solid) is as good as any other value. Eliminations follow: the
displacements inside each element, which is positive definite and the same for every ``c``; the
element's own pressures; then everything of the part that is not on the interface.
Only one pressure stays, because an incompressible part whose whole boundary is held is singular.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from bondcell.cell import FloatArray
from bondcell.fem.element_matrices import ElementMatrices
from bondcell.fem.symmetric_solve import eliminated, half_solve


def bulk_to_shear(poisson: float) -> float:
    """``kappa/mu`` of an isotropic solid; infinite at ``nu = 1/2``."""
    compressibility = 3 * (1 - 2 * poisson)
    return np.inf if compressibility == 0 else 2 * (1 + poisson) / compressibility


@dataclass(frozen=True)
class Condensed:
    """Stiffness of one part seen from its interface, for unit shear modulus.

    The energy is ``1/2 x.matrix.x + x.coupling.d + 1/2 d.own.d`` at interface displacement ``x``
    and prescribed motions ``d``. The last entry of ``x`` is the kept pressure, a Lagrange
    multiplier, where the part has any.
    """

    matrix: FloatArray
    coupling: FloatArray
    own: FloatArray


@dataclass(frozen=True)
class _Scatter:
    """How element matrices are summed to a skeleton matrix.

    Parameters
    ----------
    numbers
        Position of each element's unknowns, ``size`` where prescribed, shape (elements, m).
    entries
        Position of each element's matrix entries in the flat skeleton matrix.
    moved
        Prescribed motions of each element's unknowns, shape (elements, m, motions).
    kept, size, negative
        Numbers of unknowns that stay, of all, and of pressures among those that go, which are last.
    """

    numbers: NDArray[np.int64]
    entries: NDArray[np.int64]
    moved: FloatArray
    kept: int
    size: int
    negative: int


@dataclass(frozen=True)
class Substructure:
    """The elements of one material.

    Parameters
    ----------
    matrices
        Element matrices of this part.
    dofs
        Global unknowns on the boundary of each element, shape (elements, outer).
    interface
        Global unknowns shared with other parts, in the order of the condensed matrix.
    held
        Global unknowns that are prescribed, shape (all unknowns,), bool.
    motions
        Coefficients of the prescribed motions, zero where nothing moves, shape (all, motions).
    rigid
        The same motions of the whole cell as one rigid body, shape (all, motions).
    """

    matrices: ElementMatrices
    dofs: NDArray[np.int64]
    interface: NDArray[np.int64]
    held: NDArray[np.bool_]
    motions: FloatArray
    rigid: FloatArray

    def condense(self, poisson: float) -> Condensed:
        """Eliminate everything but the interface at one Poisson's ratio."""
        return self._condense_part(self._condense_elements(1 / bulk_to_shear(poisson)))

    @property
    def _kept_pressures(self) -> int:
        return min(1, self.matrices.pressures)

    def _condense_elements(self, compliance: float) -> FloatArray:
        """Element matrices on (boundary unknowns, mean pressure), shape (elements, m, m)."""
        retained, link, gone = self._without_inner
        system = retained.copy()
        means = np.arange(self.dofs.shape[1], retained.shape[1])
        system[:, means, means] -= compliance
        others = np.arange(gone.shape[1])
        for block, coupling, own in zip(system, link, gone, strict=True):
            own = own.copy()
            own[others, others] += compliance
            root = half_solve(own, coupling.copy())
            block += root @ root.T
        return system

    @cached_property
    def _without_inner(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        """What is left of the element systems without the displacements inside, at ``1/c = 0``.

        They meet no Poisson's ratio, so they go once. Blocks: (boundary, mean pressure) with
        itself, (boundary, mean pressure) with the other pressures, and the negative of the other
        pressures with themselves.
        """
        own = self.matrices
        size, kept = self.dofs.shape[1], self._kept_pressures
        link = np.concatenate((own.link, own.root_inner), axis=1)
        rest = np.empty((len(link), link.shape[1], link.shape[1]))
        for inner, coupling, left in zip(own.inner, link, rest, strict=True):
            root = half_solve(inner.copy(), coupling)
            np.matmul(-root, root.T, out=left)
        rest[:, :size, :size] += own.outer
        rest[:, size:, :size] += own.root_outer
        rest[:, :size, size:] += own.root_outer.transpose(0, 2, 1)
        at = size + kept
        return rest[:, :at, :at], rest[:, :at, at:], -rest[:, at:, at:]

    def _condense_part(self, element: FloatArray) -> Condensed:
        """Assemble the skeleton and eliminate all but the interface and the first pressure."""
        where = self._scatter
        kept, size, negative = where.kept, where.size, where.negative
        force: FloatArray = element @ where.moved
        motions = force.shape[2]
        own = where.moved.reshape(-1, motions).T @ force.reshape(-1, motions)
        # Prescribed motions are columns after all unknowns, and so is what nobody reads.
        flat = np.bincount(where.entries, element.ravel(), minlength=(size + 1) ** 2)
        total = np.asarray(flat).reshape(size + 1, size + 1)
        pull = np.zeros((size + 1, motions))
        np.add.at(pull, where.numbers, force)
        stay, first, last = (
            slice(0, kept),
            slice(kept, size - negative),
            slice(size - negative, size),
        )
        reduction = eliminated(
            np.ascontiguousarray(total[first, first]),
            np.concatenate((total[stay, first], pull[first].T, total[last, first])),
            np.concatenate((total[stay, last], pull[last].T, total[last, last])),
        )
        return Condensed(
            matrix=total[stay, stay] - reduction[:kept, :kept],
            coupling=pull[stay] - reduction[:kept, kept:],
            own=own - reduction[kept:, kept:],
        )

    @cached_property
    def _scatter(self) -> _Scatter:
        """Where element matrices go: interface first, the kept pressure, what is eliminated."""
        pressures, others = self._kept_pressures, 0
        kept = self.interface.size + pressures
        position = np.full(self.held.size, -1)
        position[self.interface] = np.arange(self.interface.size)
        mine = np.zeros_like(self.held)
        mine[self.dofs] = True
        rest = np.flatnonzero(mine & (position < 0) & ~self.held)
        position[rest] = kept + np.arange(rest.size)
        size = kept + rest.size
        numbers = position[self.dofs]
        if pressures:
            others = len(self.dofs) - 1
            means = np.concatenate(([self.interface.size], size + np.arange(others)))
            numbers = np.concatenate((numbers, means[:, None]), axis=1)
        size += others
        numbers = np.where(numbers < 0, size, numbers)
        moved = np.zeros((*numbers.shape, self.motions.shape[1]))
        moved[:, : self.dofs.shape[1]] = self._strained()
        entries = (numbers[:, :, None] * (size + 1) + numbers[:, None, :]).ravel()
        return _Scatter(numbers, entries, moved, kept, size, others)

    def _strained(self) -> FloatArray:
        """Motions of each element's skeleton, zero where an element moves as a rigid body.

        What a rigid motion contributes is round-off, and would be all there is where the particles
        are much softer than the matrix.
        """
        motions = self.motions[self.dofs]
        rigid = (motions == self.rigid[self.dofs]).all(axis=1)
        return np.where(rigid[:, None], 0.0, motions)
