"""One material's part of the cell, condensed to its interface with the other materials.

Every matrix is for unit shear modulus and depends on Poisson's ratio alone, through
``c = kappa/mu = 2 (1 + nu) / (3 (1 - 2 nu))``. The element system is the mixed one::

    [ D    R^T  ] [u]     D: shear matrix, R: root of the bulk matrix, p = c R u
    [ R   -1/c  ] [p]

so ``c = inf`` (an incompressible solid) is as good as any other value. Two eliminations follow:
the unknowns inside each element, batched; then everything of the part that is not on the interface.
Only one pressure stays, because an incompressible part whose whole boundary is held is singular.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.linalg
from numpy.typing import NDArray

from bondcell.cell import FloatArray
from bondcell.fem.element_matrices import ElementMatrices


def bulk_to_shear(poisson: float) -> float:
    """``kappa/mu`` of an isotropic solid; infinite at ``nu = 1/2``."""
    compressibility = 3 * (1 - 2 * poisson)
    return np.inf if compressibility == 0 else 2 * (1 + poisson) / compressibility


@dataclass(frozen=True)
class Condensed:
    """Stiffness of one part seen from its interface, for unit shear modulus.

    The energy is ``1/2 x.matrix.x + x.coupling d + 1/2 own d^2`` at interface displacement ``x`` (the
    last entry of ``x`` is the kept pressure, a Lagrange multiplier) and prescribed motion ``d``.
    """

    matrix: FloatArray
    coupling: FloatArray
    own: float


@dataclass(frozen=True)
class Substructure:
    """The elements of one material.

    Parameters
    ----------
    matrices
        Element matrices of this part.
    inner, outer
        Local unknowns inside an element and on its boundary.
    dofs
        Global unknown of each ``outer`` local unknown, shape (elements, outer).
    interface
        Global unknowns shared with other parts, in the order of the condensed matrix.
    held
        Global unknowns that are prescribed, shape (all unknowns,), bool.
    motion
        Prescribed values for unit motion, and zero where free, shape (all unknowns,).
    """

    matrices: ElementMatrices
    inner: NDArray[np.int64]
    outer: NDArray[np.int64]
    dofs: NDArray[np.int64]
    interface: NDArray[np.int64]
    held: NDArray[np.bool_]
    motion: FloatArray

    def condense(self, poisson: float) -> Condensed:
        """Eliminate everything but the interface at one Poisson's ratio."""
        element = self._condense_elements(1 / bulk_to_shear(poisson))
        return self._condense_part(element)

    def _condense_elements(self, compliance: float) -> FloatArray:
        """Element matrices on (boundary unknowns, mean pressure), shape (elements, m, m)."""
        shear, root = self.matrices.shear, self.matrices.bulk_root
        inner, outer = self.inner, self.outer
        count, pressures = root.shape[:2]
        kept, gone = outer.size + 1, inner.size + pressures - 1
        a_kk = np.zeros((count, kept, kept))
        a_kk[:, :-1, :-1] = shear[:, outer[:, None], outer]
        a_kk[:, -1, :-1] = a_kk[:, :-1, -1] = root[:, 0, outer]
        a_kk[:, -1, -1] = -compliance
        a_gk = np.zeros((count, gone, kept))
        a_gk[:, : inner.size, :-1] = shear[:, inner[:, None], outer]
        a_gk[:, inner.size :, :-1] = root[:, 1:, outer]
        a_gk[:, : inner.size, -1] = root[:, 0, inner]
        a_gg = np.zeros((count, gone, gone))
        a_gg[:, : inner.size, : inner.size] = shear[:, inner[:, None], inner]
        a_gg[:, inner.size :, : inner.size] = root[:, 1:, inner]
        a_gg[:, : inner.size, inner.size :] = root[:, 1:, inner].transpose(0, 2, 1)
        diagonal = np.arange(inner.size, gone)
        a_gg[:, diagonal, diagonal] = -compliance
        return np.asarray(a_kk - a_gk.transpose(0, 2, 1) @ np.linalg.solve(a_gg, a_gk))

    def _condense_part(self, element: FloatArray) -> Condensed:
        """Assemble the skeleton and eliminate all but the interface and the first pressure."""
        number, interface_size, eliminated = self._numbering()
        size = interface_size + 2 + eliminated
        columns = np.concatenate((number, self._pressure_numbers()[:, None]), axis=1)
        free = columns >= 0
        moved = np.concatenate((self.motion[self.dofs], np.zeros((len(columns), 1))), axis=1)
        total = np.zeros((size, size))
        motion = interface_size + 1
        for matrix, column, is_free, value in zip(element, columns, free, moved, strict=True):
            at = column[is_free]
            total[at[:, None], at] += matrix[is_free][:, is_free]
            if value.any():
                pull = matrix @ value
                total[at, motion] += pull[is_free]
                total[motion, motion] += value @ pull
        kept, gone = slice(0, motion + 1), slice(motion + 1, size)
        total[motion, :motion] = total[:motion, motion]
        right = total[gone, kept]
        reduced = total[kept, kept] - right.T @ scipy.linalg.solve(
            total[gone, gone], right, assume_a="gen", check_finite=False
        )
        return Condensed(
            matrix=reduced[:-1, :-1], coupling=reduced[:-1, -1], own=float(reduced[-1, -1])
        )

    def _numbering(self) -> tuple[NDArray[np.int64], int, int]:
        """Position of each skeleton unknown: interface first, then kept pressure, motion, the rest."""
        count = self.interface.size
        position = np.full(self.held.size, -1)
        position[self.interface] = np.arange(count)
        mine = np.unique(self.dofs)
        rest = mine[(position[mine] < 0) & ~self.held[mine]]
        position[rest] = count + 2 + np.arange(rest.size)
        return position[self.dofs], count, rest.size + len(self.dofs) - 1

    def _pressure_numbers(self) -> NDArray[np.int64]:
        _, count, eliminated = self._numbering()
        first = count + 2 + eliminated - (len(self.dofs) - 1)
        return np.concatenate(([count], first + np.arange(len(self.dofs) - 1)))
