"""Coordinates in which the stiffness of an equal pair is smooth, and their Chebyshev nodes.

Four dimensionless numbers fix the stiffness: gap over radius ``g``, softness ``s = E_m/E_i``,
compressibility ``e = mu_m/kappa_m`` and the particles' Poisson's ratio. The stiffness turns from
one behaviour to another where the film becomes as stiff as the particles, at ``s`` about ``g^1.5``,
and where squeezing it out becomes easier than compressing it, at ``e`` about ``g``; so the
coordinates are logarithms counted from there, and a rigid particle or an incompressible matrix is
an end point.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bondcell.cell import FloatArray


@dataclass(frozen=True)
class Axes:
    """Ranges and node numbers of the surrogate.

    Parameters
    ----------
    shape
        Nodes in gap, softness, compressibility, particle's Poisson's ratio.
    gap
        Least and largest gap over radius.
    poisson
        Least and largest Poisson's ratio of the particles.
    soft_scale, squeeze_scale
        Factors of ``g^1.5`` and ``g`` in the coordinates.
    """

    shape: tuple[int, int, int, int] = (28, 30, 16, 5)
    gap: tuple[float, float] = (1e-4, 3.0)
    poisson: tuple[float, float] = (0.0, 0.45)
    soft_scale: float = 2e-2
    squeeze_scale: float = 0.1

    def unit_coordinates(
        self, gap: FloatArray, softness: FloatArray, compressibility: FloatArray, nu: FloatArray
    ) -> list[FloatArray]:
        """Coordinates in [-1, 1] of the four numbers, arrays of one shape."""
        soft, squeeze = self.soft_scale * gap**1.5, self.squeeze_scale * gap
        low, high = np.log(self.gap[0]), np.log(self.gap[1])
        return [
            2 * (np.log(gap) - low) / (high - low) - 1,
            2 * np.log1p(softness / soft) / np.log1p(1 / soft) - 1,
            2 * np.log1p(compressibility / squeeze) / np.log1p(1.5 / squeeze) - 1,
            2 * (nu - self.poisson[0]) / (self.poisson[1] - self.poisson[0]) - 1,
        ]

    def gap_nodes(self) -> FloatArray:
        """Gap over radius at the nodes."""
        x = chebyshev_points(self.shape[0])
        low, high = np.log(self.gap[0]), np.log(self.gap[1])
        return np.asarray(np.exp(low + (high - low) * (x + 1) / 2))

    def material_nodes(self, gap: float) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Softness, compressibility and particle's Poisson's ratio at the nodes of one gap."""
        soft, squeeze = self.soft_scale * gap**1.5, self.squeeze_scale * gap
        x, y, z = (chebyshev_points(n) for n in self.shape[1:])
        low, high = self.poisson
        return (
            soft * np.expm1((x + 1) / 2 * np.log1p(1 / soft)),
            squeeze * np.expm1((y + 1) / 2 * np.log1p(1.5 / squeeze)),
            low + (high - low) * (z + 1) / 2,
        )


AXES = Axes()
"""The axes of the shipped surrogate."""


def chebyshev_points(count: int) -> FloatArray:
    """Extrema of the Chebyshev polynomial of degree ``count - 1``, ends included, ascending."""
    return np.asarray(-np.cos(np.pi * np.arange(count) / (count - 1)))
