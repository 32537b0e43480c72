"""What holds the cell and what moves it: prescribed components on the named boundaries.

One table a load and boundary condition (theory: section "The bond cell", table of loads).
Boundaries are ``axis``, ``end_i``, ``end_j``, ``lateral`` and, for half of a symmetric pair,
``middle`` (mid-gap).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from bondcell.cell import FloatArray
from bondcell.fem.strain import AXIAL, LATERAL, SWIRL, FourierMode

Motion = Callable[[FloatArray, FloatArray], FloatArray]
"""Rigid motion: radius and height above end plane j [m] -> components, shape (components, ...)."""


@dataclass(frozen=True)
class Supports:
    """Prescribed components of the displacement.

    Parameters
    ----------
    mode
        Fourier mode of the load.
    held
        Boundary name -> components that are prescribed there.
    moved
        Boundaries whose prescribed components follow the motions; elsewhere they are zero.
    motions
        Unit rigid motions of the moved boundaries. Particle j takes part as a rigid body: that is
        the lift which keeps round-off small for stiff particles.
    """

    mode: FourierMode
    held: Mapping[str, tuple[int, ...]]
    moved: tuple[str, ...]
    motions: tuple[Motion, ...]


def _push(r: FloatArray, z: FloatArray) -> FloatArray:
    """Axial translation ``(u_r, u_z) = (0, 1)``."""
    return np.stack([np.zeros_like(r), np.ones_like(r)])


def _twist(r: FloatArray, z: FloatArray) -> FloatArray:
    """Rotation about the axis, ``u_t = r``."""
    return np.stack([r])


def _shift(r: FloatArray, z: FloatArray) -> FloatArray:
    """Translation across the axis, ``b = 1``."""
    return np.stack([np.zeros_like(r), np.ones_like(r), np.zeros_like(r)])


def _tilt(r: FloatArray, z: FloatArray) -> FloatArray:
    """Rotation about y through the centre of end plane j, ``u_x = z``, ``u_z = -x``."""
    return np.stack([np.zeros_like(r), z, -r])


_ENDS = ("end_i", "end_j")
_MOVED = ("end_j", "middle")


def _axial(ends: tuple[int, ...], lateral: tuple[int, ...]) -> Supports:
    held = {"axis": (0,), "middle": (1,), "lateral": lateral} | dict.fromkeys(_ENDS, ends)
    return Supports(AXIAL, held, _MOVED, (_push,))


def _lateral(middle: tuple[int, ...], *motions: Motion) -> Supports:
    held = {"axis": (0, 2), "middle": middle} | dict.fromkeys(_ENDS, (0, 1, 2))
    return Supports(LATERAL, held, _MOVED, motions)


NORMAL = {
    "roller": _axial(ends=(1,), lateral=()),
    "clamped": _axial(ends=(0, 1), lateral=()),
    "confined": _axial(ends=(1,), lateral=(0,)),
}
"""Supports of the normal load by boundary condition."""

TORSION = Supports(
    SWIRL, {"axis": (0,), "middle": (0,)} | dict.fromkeys(_ENDS, (0,)), _MOVED, (_twist,)
)
"""Supports of the torsion load."""

BEAM = _lateral((), _shift, _tilt)
"""Both motions of the end plane across the axis: shear and bending of a whole cell."""

SHEAR_HALF = _lateral((0, 1), _shift)
"""Antisymmetric motion of a symmetric pair: mid-gap stays in line, its warping is free."""

BENDING_HALF = _lateral((2,), _tilt)
"""Symmetric motion of a symmetric pair: mid-gap stays plane and turns."""
