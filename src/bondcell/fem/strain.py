"""Strain of a displacement field with one Fourier mode around the axis, as a table of coefficients.

With ``u_r = U cos(n t)``, ``u_t = V sin(n t)``, ``u_z = W cos(n t)`` the strain's amplitudes are::

    e_rr = U,r            e_tt = (U + n V)/r          e_zz = W,z
    2 e_rz = U,z + W,r    2 e_rt = V,r - (V + n U)/r  2 e_tz = V,z - n W/r

A component of the strain is therefore a sum over the field's components of coefficients times
``(value/r, d/dr, d/dz)``. The amplitudes are stored in Mandel's order and scaling
``(rr, tt, zz, sqrt2 rz, sqrt2 rt, sqrt2 tz)``, whose Euclidean norm is the tensor's.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bondcell.cell import FloatArray

RR, TT, ZZ, RZ, RT, TZ = range(6)
OVER_R, D_R, D_Z = range(3)
HALF = np.sqrt(0.5)

TRACE = np.array([1.0, 1, 1, 0, 0, 0])
DEVIATOR = np.eye(6) - np.outer(TRACE, TRACE) / 3


@dataclass(frozen=True)
class FourierMode:
    """A family of displacement fields.

    Parameters
    ----------
    components
        Names of the field's components.
    strain
        Coefficients, shape (components, 3, 6): of ``value/r``, ``d/dr``, ``d/dz`` in each strain.
    angle_integral
        Integral of the squared trigonometric factor around the axis.
    """

    components: tuple[str, ...]
    strain: FloatArray
    angle_integral: float


def _table(entries: dict[tuple[int, int, int], float], components: int) -> FloatArray:
    table = np.zeros((components, 3, 6))
    for position, value in entries.items():
        table[position] = value
    return table


AXIAL = FourierMode(
    components=("u_r", "u_z"),
    strain=_table(
        {
            (0, D_R, RR): 1,
            (0, OVER_R, TT): 1,
            (1, D_Z, ZZ): 1,
            (0, D_Z, RZ): HALF,
            (1, D_R, RZ): HALF,
        },
        components=2,
    ),
    angle_integral=2 * np.pi,
)
"""Mode 0 without swirl: the normal load."""

SWIRL = FourierMode(
    components=("u_t",),
    strain=_table({(0, D_R, RT): HALF, (0, OVER_R, RT): -HALF, (0, D_Z, TZ): HALF}, components=1),
    angle_integral=2 * np.pi,
)
"""Mode 0 with swirl alone: the torsion load."""

LATERAL = FourierMode(
    components=("a", "b", "u_z"),
    strain=_table(
        {
            (0, D_R, RR): 1,
            (1, D_R, RR): 1,
            (0, OVER_R, TT): 2,
            (2, D_Z, ZZ): 1,
            (0, D_Z, RZ): HALF,
            (1, D_Z, RZ): HALF,
            (2, D_R, RZ): HALF,
            (0, D_R, RT): HALF,
            (1, D_R, RT): -HALF,
            (0, OVER_R, RT): -2 * HALF,
            (0, D_Z, TZ): HALF,
            (1, D_Z, TZ): -HALF,
            (2, OVER_R, TZ): -HALF,
        },
        components=3,
    ),
    angle_integral=np.pi,
)
"""Mode 1: the shear and bending loads.

The field is ``U = a + b``, ``V = a - b``: then ``a`` and ``u_z`` vanish on the axis and ``b`` is
free there, which keeps every strain finite, and a translation across the axis is ``b = 1`` alone.
"""
