"""Displacements with one wave around the axis: their strains and energies.

``u_r = (a + b) cos t, u_t = (a - b) sin t, u_z = w cos t`` with ``a = r^2 alpha``, ``b = beta`` and
``w = r omega``, whose strains stay finite on the axis.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bondcell.cell import FloatArray
from bondcell.models.film.energies import gram, sum_of_grams
from bondcell.models.jets import Jet


@dataclass(frozen=True)
class Field:
    """``alpha, beta, omega``; jets, None for zero."""

    alpha: Jet | None
    beta: Jet | None
    omega: Jet | None

    def times(self, factor: Jet, alpha: Jet | float = 1.0, omega: Jet | float = 1.0) -> Field:
        """All parts times a factor, alpha and omega times one of their own besides."""
        parts = ((self.alpha, alpha), (self.beta, 1.0), (self.omega, omega))
        return Field(*(None if part is None else part * factor * own for part, own in parts))


def strains(field: Field, r: FloatArray) -> FloatArray:
    """Amplitudes of ``e_rr, e_tt, e_zz, 2 e_rz, 2 e_rt, 2 e_tz``."""
    some = next(part for part in (field.alpha, field.beta, field.omega) if part is not None)
    out: FloatArray = np.zeros((6, *some.value.shape))
    if field.alpha is not None:
        value, d_r, d_z = field.alpha.parts[:3]
        out[0] += 2 * r * value + r**2 * d_r
        out[1] += 2 * r * value
        out[3] += r**2 * d_z
        out[4] += r**2 * d_r
        out[5] += r**2 * d_z
    if field.beta is not None:
        _, d_r, d_z = field.beta.parts[:3]
        out[0] += d_r
        out[3] += d_z
        out[4] -= d_r
        out[5] -= d_z
    if field.omega is not None:
        value, d_r, d_z = field.omega.parts[:3]
        out[2] += r * d_z
        out[3] += value + r * d_r
        out[5] -= value
    return out


def stream_strains(q: Jet | None, p: Jet | None, r: FloatArray) -> FloatArray:
    """Strains of ``alpha = -p_z, beta = -q_z, omega = 4 p + r p_r + q_r/r``: no divergence."""
    shape = next(part for part in (q, p) if part is not None).value.shape
    out: FloatArray = np.zeros((6, *shape))
    if p is not None:
        value, p_r, p_z, p_rr, p_rz, p_zz = p.parts
        out[0] -= 2 * r * p_z + r**2 * p_rz
        out[1] -= 2 * r * p_z
        out[2] += 4 * r * p_z + r**2 * p_rz
        out[3] += 4 * value + 6 * r * p_r + r**2 * (p_rr - p_zz)
        out[4] -= r**2 * p_rz
        out[5] -= 4 * value + r * p_r + r**2 * p_zz
    if q is not None:
        _, q_r, _, q_rr, q_rz, q_zz = q.parts
        out[0] -= q_rz
        out[2] += q_rz
        out[3] += q_rr - q_zz
        out[4] += q_rz
        out[5] += q_zz - q_r / r
    return out


def quadratic_forms(
    trial: FloatArray, weights: FloatArray, isochoric: int
) -> tuple[FloatArray, FloatArray]:
    """``2 dev(e) : dev(e)`` of all fields and ``(div u)^2`` of those with divergence.

    Overwrites the strains.
    """
    trial *= np.sqrt(weights)
    divergence = trial[0] + trial[1] + trial[2]
    divergence[:isochoric] = 0
    trial[:3] -= divergence / 3
    trial[:3] *= np.sqrt(2.0)
    return sum_of_grams(trial), gram(divergence[isochoric:].swapaxes(0, 1))
