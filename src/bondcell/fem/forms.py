"""The energy of a displacement field as scikit-fem forms: what the fast code is tested on.

`bondcell.fem.element_matrices` computes the same matrices by batched products; these forms are what
they mean. Coordinates are ``x = (r, z)``; the angle around the axis is integrated out.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from skfem import BilinearForm
from skfem.helpers import ddot, grad


def axial_strain(u: Any, r: Any) -> Any:
    """Strain of ``(u_r, u_z)``: the gradient's symmetric part, and the hoop strain ``u_r / r``."""
    du = grad(u)
    e_rz = (du[0, 1] + du[1, 0]) / 2
    zero = np.zeros_like(e_rz)
    return np.array([[du[0, 0], zero, e_rz], [zero, u[0] / r, zero], [e_rz, zero, du[1, 1]]])


def _trace(strain: Any) -> Any:
    return strain[0, 0] + strain[1, 1] + strain[2, 2]


def _deviator(strain: Any) -> Any:
    third = _trace(strain) / 3
    identity = np.eye(3).reshape((3, 3) + (1,) * (strain.ndim - 2))
    return strain - third * identity


def _axial_shear(u: Any, v: Any, w: Any) -> Any:
    """Integral of ``2 dev eps(u) : dev eps(v)`` over the solid, mode 0."""
    r = w.x[0]
    return 2 * np.pi * r * 2 * ddot(_deviator(axial_strain(u, r)), _deviator(axial_strain(v, r)))


def _axial_bulk(u: Any, v: Any, w: Any) -> Any:
    """Integral of ``tr eps(u) tr eps(v)`` over the solid, mode 0."""
    r = w.x[0]
    return 2 * np.pi * r * _trace(axial_strain(u, r)) * _trace(axial_strain(v, r))


axial_shear = BilinearForm(_axial_shear)
axial_bulk = BilinearForm(_axial_bulk)
