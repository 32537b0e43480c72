"""Elastic constants of many cells of one geometry, and of one of them."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from bondcell.cell import Cell, FloatArray


class Constants(NamedTuple):
    """Elastic constants of one cell: shear moduli [Pa] and Poisson's ratios."""

    shear_m: float
    poisson_m: float
    shear: tuple[float, float]
    """Shear moduli of particles i and j; infinite if rigid [Pa]."""
    poisson: tuple[float, float]
    """Poisson's ratios of particles i and j."""


@dataclass(frozen=True)
class Materials:
    """Elastic constants of many cells, arrays of shape (points,): Young's moduli in Pa."""

    young_i: FloatArray
    young_j: FloatArray
    young_m: FloatArray
    poisson_i: FloatArray
    poisson_j: FloatArray
    poisson_m: FloatArray

    @classmethod
    def of(cls, cell: Cell) -> Materials:
        """The materials of a raveled cell."""
        return cls(**{field.name: getattr(cell, field.name) for field in fields(cls)})

    @property
    def count(self) -> int:
        """Number of points."""
        return int(self.young_m.size)

    @property
    def is_mirrored(self) -> NDArray[np.bool_]:
        """Where both particles are of one material."""
        return np.asarray((self.young_i == self.young_j) & (self.poisson_i == self.poisson_j))

    @property
    def shear_m(self) -> FloatArray:
        """Shear modulus of the matrix [Pa]."""
        return shear_modulus(self.young_m, self.poisson_m)

    @property
    def ratios(self) -> FloatArray:
        """Shear moduli of both particles over the matrix's, shape (points, 2)."""
        shear_i = shear_modulus(self.young_i, self.poisson_i)
        shear_j = shear_modulus(self.young_j, self.poisson_j)
        return np.asarray(np.stack([shear_i, shear_j], axis=-1) / self.shear_m[:, None])

    @property
    def compressibility(self) -> FloatArray:
        """``mu/kappa`` of the matrix; zero where it is incompressible."""
        return np.asarray(1.5 * (1 - 2 * self.poisson_m) / (1 + self.poisson_m))

    def take(self, index: Any) -> Materials:
        """The points ``index``."""
        return Materials(*(getattr(self, field.name)[index] for field in fields(self)))

    def constants(self, k: int) -> Constants:
        """Elastic constants of point ``k``."""
        shear_i = shear_modulus(self.young_i[k], self.poisson_i[k])
        shear_j = shear_modulus(self.young_j[k], self.poisson_j[k])
        return Constants(
            shear_m=float(self.shear_m[k]),
            poisson_m=float(self.poisson_m[k]),
            shear=(float(shear_i), float(shear_j)),
            poisson=(float(self.poisson_i[k]), float(self.poisson_j[k])),
        )


def shear_modulus(young: FloatArray, poisson: FloatArray) -> FloatArray:
    """``E / (2 (1 + nu))``, same unit as ``E``."""
    return np.asarray(young / (2 * (1 + poisson)))
