"""Elastic constants of one cell."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Materials:
    """Elastic constants of one cell: Young's moduli [Pa] and Poisson's ratios."""

    young_i: float
    young_j: float
    young_m: float
    poisson_i: float
    poisson_j: float
    poisson_m: float

    @property
    def is_mirrored(self) -> bool:
        """Whether both particles are of one material."""
        return (self.young_i, self.poisson_i) == (self.young_j, self.poisson_j)

    @property
    def shear_m(self) -> float:
        """Shear modulus of the matrix [Pa]."""
        return shear_modulus(self.young_m, self.poisson_m)

    @property
    def particles(self) -> tuple[tuple[float, float], tuple[float, float]]:
        """Shear modulus [Pa] and Poisson's ratio of both particles."""
        return (
            (shear_modulus(self.young_i, self.poisson_i), self.poisson_i),
            (shear_modulus(self.young_j, self.poisson_j), self.poisson_j),
        )


def shear_modulus(young: float, poisson: float) -> float:
    """``E / (2 (1 + nu))``, same unit as ``E``."""
    return young / (2 * (1 + poisson))
