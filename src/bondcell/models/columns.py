"""All lines parallel to the axis side by side, each a series of particle, matrix and particle.

The integral behind FSI's interface spring, the generatrix model and the general model's parallel
bond, written so that no digits cancel between narrow and wide gaps, equal and unequal spheres, soft
and rigid particles.
"""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import NDArray

from bondcell.cell import Cell, FloatArray
from bondcell.models.double_exponential import unit_interval_rule
from bondcell.models.logarithms import second_remainder, third_remainder


@dataclass(frozen=True)
class Columns:
    """Lines that cross the larger sphere, and near the axis the smaller one as well.

    Parameters
    ----------
    large, small
        Heights of the larger and the smaller sphere on the innermost line, ``s_b``, ``s_s`` [m]:
        their radii when that line is the axis.
    ledge
        Height of the larger sphere over the rim of the smaller one, ``A = sqrt(|R_i^2 - R_j^2|)``
        [m].
    gap
        Length of matrix on the innermost line [m].
    softness_large, softness_small
        ``E_m / E`` of the two particles, 0 for rigid ones.
    """

    large: FloatArray
    small: FloatArray
    ledge: FloatArray
    gap: FloatArray
    softness_large: FloatArray
    softness_small: FloatArray

    @classmethod
    def of_cell(cls, cell: Cell, rigid: bool = False) -> Columns:
        """The lines from the axis outward; `rigid` counts their matrix only."""
        large = np.maximum(cell.radius_i, cell.radius_j)
        small = np.minimum(cell.radius_i, cell.radius_j)
        soft_large, soft_small = _ordered_softness(cell, rigid)
        ledge = np.sqrt((large - small) * (large + small))
        return cls(large, small, ledge, cell.gap, soft_large, soft_small)

    @classmethod
    def outside(cls, cell: Cell, square: FloatArray, complement: FloatArray) -> Columns:
        """The lines outside a core; `square` is its radius over min(R_i, R_j), squared.

        ``complement = 1 - square`` is given separately: only the caller knows it to full precision.
        """
        axis = cls.of_cell(cell)
        small = axis.small * np.sqrt(complement)
        large = np.where(axis.ledge == 0.0, small, np.hypot(small, axis.ledge))
        core_square = square * axis.small**2
        dips = core_square / (axis.large + large) + core_square / (axis.small + small)
        return cls(
            large, small, axis.ledge, axis.gap + dips, axis.softness_large, axis.softness_small
        )

    def heights(self, cell: Cell) -> tuple[FloatArray, FloatArray]:
        """Heights of particle i and particle j on the innermost line [m]."""
        i_is_large = cell.radius_i >= cell.radius_j
        return (
            np.where(i_is_large, self.large, self.small),
            np.where(i_is_large, self.small, self.large),
        )

    def integral(self) -> FloatArray:
        """Integral of ``r dr / (h_m + (E_m/E_i) h_i + (E_m/E_j) h_j)`` over the lines [m].

        Returns
        -------
        ndarray
            On the broadcast shape of all fields; times ``2 pi E_m`` it is a stiffness.
        """
        equal = self.ledge == 0.0
        stiffer = self.softness_large + self.softness_small <= 2.0
        alike = stiffer & (self.softness_large == self.softness_small)
        if equal.all():
            return equal_spheres(self)
        if alike.all() and not equal.any():
            return alike_particles(self)
        shape = np.broadcast_shapes(*(getattr(self, f.name).shape for f in fields(self)))
        spread = Columns(*(np.broadcast_to(getattr(self, f.name), shape) for f in fields(self)))
        result = np.empty(shape)
        for mask, formula in (
            (equal, equal_spheres),
            (~equal & alike, alike_particles),
            (~equal & stiffer & ~alike, stiffer_particles),
            (~equal & ~stiffer, softer_particles),
        ):
            chosen = np.broadcast_to(mask, shape)
            if chosen.any():
                result[chosen] = formula(spread._take(chosen))
        return result

    def _take(self, mask: NDArray[np.bool_]) -> Columns:
        return Columns(*(getattr(self, f.name)[mask] for f in fields(self)))


def equal_spheres(columns: Columns) -> FloatArray:
    """Integral for ``R_i = R_j``, where both particles make one.

    Notes
    -----
    With u = sqrt(R^2 - r^2) the integral is that of ``u du / (L - y L u/U)`` from 0 to U, the
    height on the innermost line, so ``(U^2 / L) phi(y)`` with ``y = (2 - E_m/E_i - E_m/E_j) U /
    L``.
    """
    softness = columns.softness_large + columns.softness_small
    length = 2.0 * columns.large + columns.gap
    y = (2.0 - softness) * columns.large / length
    complement = (columns.gap + softness * columns.large) / length
    return columns.large**2 / length * second_remainder(y, complement)


def alike_particles(columns: Columns) -> FloatArray:
    """Integral for unequal spheres of one material, no softer than the matrix, rigid ones included.

    Notes
    -----
    As `stiffer_particles` with a = b, where t_2 = 0 and all logarithms are of two arguments:
    ``y = a/lam`` and ``rho y``. The remainders take the cancelling powers of y out of them.
    """
    total = columns.large + columns.small
    gap, rho = columns.gap / total, columns.ledge / total
    lam = 1.0 + gap
    below_rho = columns.small * (1.0 + columns.small / (columns.large + columns.ledge)) / total
    y = (1.0 - columns.softness_large) / lam
    one_less_y = (gap + columns.softness_large) / lam
    one_less_y_rho = (gap + below_rho + columns.softness_large * rho) / lam

    delta = rho * rho
    tail = (
        columns.small / total
        + rho * y * below_rho
        + delta * y * y * np.log(one_less_y_rho / (rho * one_less_y))
    )
    crossing = second_remainder(y, one_less_y) + 3.0 * delta * second_remainder(
        y * rho, one_less_y_rho
    )
    return total / (4.0 * lam) * (crossing - delta * tail)


def stiffer_particles(columns: Columns) -> FloatArray:
    """Integral for unequal spheres that are on average no softer than the matrix.

    Notes
    -----
    Lengths in units of S = s_b + s_s: ``lam = L/S``, ``rho = A/S``; ``a = 1 - E_m/E_b``,
    ``b = 1 - E_m/E_s``. Where a line crosses both spheres, ``t = (h_b + h_s)/S`` gives
    ``h_b - h_s = rho^2/t`` and the integral from rho to 1

    ``(1/4) integral of (t^2 - rho^4/t^2) / Q(t) dt``, ``Q = lam t - p t^2 - (a - b) rho^2/2``,

    ``p = (a + b)/2``. The roots 1/x and t_2 of Q, with ``Delta^2 = lam^2 - (a^2 - b^2) rho^2``,
    split it by ``1/Q = (x/(1 - x t) + 1/(t - t_2))/Delta``. For p >= 0 both parts are positive, and
    each has a closed form in the remainders phi and chi.
    """
    total = columns.large + columns.small
    gap, rho = columns.gap / total, columns.ledge / total
    soft_large, soft_small = columns.softness_large, columns.softness_small
    lam = 1.0 + gap
    below_rho = columns.small * (1.0 + columns.small / (columns.large + columns.ledge)) / total
    on_axis = gap + (soft_large * columns.large + soft_small * columns.small) / total
    at_rim = gap + below_rho + soft_large * rho

    far = lam + rho - soft_large * rho
    root = lam + np.sqrt(at_rim * far + ((1.0 - soft_small) * rho) ** 2)
    x = (2.0 - soft_large - soft_small) / root
    t_2 = (soft_small - soft_large) * rho * rho / root

    # Q(1) and Q(rho) are sums of positive terms and give the roots' distances from both ends.
    one_less_x_rho = 1.0 - x * rho
    rho_less_t_2 = 2.0 * rho * at_rim / (root * one_less_x_rho)
    one_less_t_2 = below_rho + rho_less_t_2
    one_less_x = 2.0 * on_axis / (root * one_less_t_2)

    delta = rho * rho
    outer = x * (
        third_remainder(x, one_less_x)
        - delta * rho * (third_remainder(x * rho, one_less_x_rho) + below_rho)
        - delta * delta * x * np.log(one_less_x_rho / (rho * one_less_x))
    )
    inner = (
        columns.small / total
        + t_2 * below_rho
        + t_2 * t_2 * np.log(one_less_t_2 / rho_less_t_2)
        - delta * second_remainder(t_2 / rho, rho_less_t_2 / rho)
        + delta * delta * second_remainder(t_2, one_less_t_2)
    )
    both = (outer + inner) / (4.0 * (root - lam))
    return total * (both + ledge_columns(lam, rho, soft_large, at_rim))


def ledge_columns(
    lam: FloatArray, rho: FloatArray, softness: FloatArray, at_rim: FloatArray
) -> FloatArray:
    """Lines that cross the larger sphere only, in units of S: ``(rho^2/lam) phi(a rho/lam)``."""
    return rho * rho / lam * second_remainder((1.0 - softness) * rho / lam, at_rim / lam)


def softer_particles(columns: Columns) -> FloatArray:
    """Integral for unequal spheres that are on average softer than the matrix.

    Notes
    -----
    The roots of Q may meet or turn complex and the closed form cancels; the integrand ``v dv /
    (h_m + soft_b sqrt(A^2 + v^2) + soft_s v)`` in the height v of the smaller sphere, on the
    other hand, is positive and tame: a double exponential rule takes it to round-off.
    """
    total = columns.large + columns.small
    gap, rho, small = (part / total for part in (columns.gap, columns.ledge, columns.small))
    large = columns.large / total
    both = np.zeros_like(gap)
    for point, complement, weight in unit_interval_rule():
        height, below = small * point, small * complement
        height_large = np.sqrt(rho * rho + height * height)
        matrix = gap + below * (1.0 + (small + height) / (large + height_large))
        soft = columns.softness_large * height_large + columns.softness_small * height
        both += weight * height / (matrix + soft)
    both *= small
    lam = 1.0 + gap
    below_rho = small * (1.0 + small / (large + rho))
    at_rim = gap + below_rho + columns.softness_large * rho
    return total * (both + ledge_columns(lam, rho, columns.softness_large, at_rim))


def annulus(cell: Cell) -> FloatArray:
    """Integral of ``r dr / L`` over the lines that cross no particle [m]."""
    large = np.maximum(cell.radius_i, cell.radius_j)
    outer = cell.cylinder_radius
    return (outer - large) * (outer + large) / (2.0 * cell.length)


def _ordered_softness(cell: Cell, rigid: bool) -> tuple[FloatArray, FloatArray]:
    """Softness of the larger and the smaller particle."""
    if rigid:
        return np.zeros(()), np.zeros(())
    soft_i, soft_j = cell.young_m / cell.young_i, cell.young_m / cell.young_j
    if np.array_equal(cell.radius_i, cell.radius_j):
        return soft_i, soft_j
    swap = cell.radius_j > cell.radius_i
    return np.where(swap, soft_j, soft_i), np.where(swap, soft_i, soft_j)
