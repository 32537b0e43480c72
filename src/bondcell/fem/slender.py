"""Slender cells under shear and bending, from two short cells of the same ends and materials.

A few radii from the ends the column of matrix is a beam, exactly (Saint-Venant). With the force F
across the axis and the moment M at mid-gap, a column that is longer by ``l`` than the cell of
gap ``g_0`` has the compliance (deflection and rotation for F and M)::

    C_FF = C_FF(g_0) + a l + C_MM(g_0) l^2 / 4 + l^3 / (12 EI)
    C_FM = C_FM(g_0) + b l
    C_MM = C_MM(g_0) + l / EI,                     EI = pi E_m R_c^4 / 4

``a`` holds the column's own shear and how the ends couple force and moment, ``b`` half the
difference of the ends' bending compliance; both follow from a second short cell. Elements along a
slender column would lose about ``(h/R)^4`` of the digits, ``h`` their length: bending is that much
softer than the other motions of their nodes.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from bondcell.cell import Cell, FloatArray

SLENDER = 40.0
"""Gap over the cylinder's radius from which a cell is slender."""

SHORT = (15.0, 30.0)
"""Gaps of the two short cells, in radii of the cylinder."""

SHARE = 0.1
"""Tolerance of the short cells over that of the slender one."""

END_EFFECTS, DECAY, LEAST_ERROR = 0.3, 3.3, 1e-11
"""Relative error of taking the column for a beam: size of the ends' effects, their decay per radius
of the shorter gap over ``sqrt(1 + nu)``, and the least. Measured at ``nu`` of -0.9 and -0.7."""

LARGEST_ERROR = 0.1
"""Estimated relative error from which nothing is known: errors do not add up linearly any more."""


def is_slender(cell: Cell, load: str) -> bool:
    """Whether a raveled cell, of one geometry, is solved as its short cells."""
    return load in ("shear", "bending") and bool(cell.gap[0] > SLENDER * cell.cylinder_radius[0])


def shortened(cell: Cell) -> tuple[Cell, Cell]:
    """The two short cells with the ends and materials of a slender one."""
    near, far = (Cell(**{**cell.as_dict(), "gap": share * cell.cylinder_radius}) for share in SHORT)
    return near, far


@dataclass(frozen=True)
class BeamStiffness:
    """Stiffness of the motions of end plane j, arrays of shape (points,).

    Parameters
    ----------
    shear, bending
        Of shift and rotation [N/m, N m/rad].
    coupling
        Force across the axis for a unit rotation [N/rad].
    """

    shear: FloatArray
    bending: FloatArray
    coupling: FloatArray


def lengthened(cell: Cell, near: BeamStiffness, far: BeamStiffness) -> BeamStiffness:
    """Stiffness of a slender cell from that of its `shortened` ones.

    Examples
    --------
    A beam that is clamped at both ends, ``K = 12 EI / L^3``:

    >>> cell = Cell.from_values(
    ...     radius_i=1, gap=998, young_i=1, young_m=1, poisson_i=0, poisson_m=0
    ... ).ravel()
    >>> def beam(length):
    ...     values = [3 * np.pi / length**3, np.pi / length, -1.5 * np.pi / length**2]
    ...     return BeamStiffness(*(np.array([value]) for value in values))
    >>> long = lengthened(cell, *(beam(2.0 + gap) for gap in SHORT))
    >>> [round(float(v[0]), 9) for v in (long.shear * 1e9 / np.pi, long.bending * 1e3 / np.pi)]
    [3.0, 1.0]
    """
    rigidity = np.pi * cell.young_m * cell.cylinder_radius**4 / 4
    gaps = [share * cell.cylinder_radius for share in SHORT]
    short, longer = (
        _compliance(stiffness, cell.radius_j + gap / 2)
        for stiffness, gap in zip((near, far), gaps, strict=True)
    )
    step, more = gaps[1] - gaps[0], cell.gap - gaps[0]

    def bent(length: FloatArray) -> FloatArray:
        return np.asarray(short[2] * length**2 / 4 + length**3 / (12 * rigidity))

    a = (longer[0] - short[0] - bent(step)) / step
    b = (longer[1] - short[1]) / step
    compliance = (short[0] + a * more + bent(more), short[1] + b * more, short[2] + more / rigidity)
    return _stiffness(compliance, cell.radius_j + cell.gap / 2)


def lengthened_error(
    cell: Cell,
    near: BeamStiffness,
    far: BeamStiffness,
    near_error: BeamStiffness,
    far_error: BeamStiffness,
) -> BeamStiffness:
    """Relative errors of `lengthened` where its short cells have the given relative errors.

    Each of the six values is moved by its error up and down, and the larger changes add up;
    infinite from `LARGEST_ERROR` on.
    """
    values, errors = (
        [*vars(a).values(), *vars(b).values()] for a, b in ((near, far), (near_error, far_error))
    )
    usual = _as_array(lengthened(cell, near, far))
    decay = DECAY * SHORT[0] * np.sqrt(1 + cell.poisson_m)
    total = np.tile(LEAST_ERROR + END_EFFECTS * np.exp(-decay), (len(usual), 1))
    for k, error in enumerate(errors):
        changes = []
        for sign in (-1.0, 1.0):
            moved = [*values[:k], values[k] * (1 + sign * error), *values[k + 1 :]]
            result = lengthened(cell, BeamStiffness(*moved[:3]), BeamStiffness(*moved[3:]))
            changes.append(np.abs(_as_array(result) / usual - 1))
        total += np.maximum(*changes)
    return BeamStiffness(*np.where(total <= LARGEST_ERROR, total, np.inf))


def _as_array(stiffness: BeamStiffness) -> FloatArray:
    return np.stack([stiffness.shear, stiffness.bending, stiffness.coupling])


def _compliance(
    stiffness: BeamStiffness, arm: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """``C_FF, C_FM, C_MM`` at mid-gap, where the moment is ``M_j + arm F``."""
    k = stiffness
    determinant = k.shear * k.bending - k.coupling**2
    force, mixed, moment = (v / determinant for v in (k.bending, -k.coupling, k.shear))
    return force - 2 * arm * mixed + arm**2 * moment, mixed - arm * moment, moment


def _stiffness(
    compliance: tuple[FloatArray, FloatArray, FloatArray], arm: FloatArray
) -> BeamStiffness:
    """The way back from mid-gap to end plane j."""
    at_middle, mixed, moment = compliance
    determinant = at_middle * moment - mixed**2
    force, mixed = at_middle + 2 * arm * mixed + arm**2 * moment, mixed + arm * moment
    return BeamStiffness(moment / determinant, force / determinant, -mixed / determinant)
