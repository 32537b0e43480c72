"""What holds the cell and what moves it: prescribed components on the named boundaries.

One table a load and boundary condition (theory: section "The bond cell", table of loads). A moved
component gets the unit motion of its end plane; on the mid-gap plane of a symmetric pair it gets the
same unit, so a half cell's stiffness counts twice the cell's.
"""

from __future__ import annotations

from dataclasses import dataclass

from bondcell.fem.strain import AXIAL, FourierMode

U_R, U_Z = 0, 1


@dataclass(frozen=True)
class Supports:
    """Prescribed components of the displacement.

    Parameters
    ----------
    mode
        Fourier mode of the load.
    held
        Boundary name -> components that are zero there.
    moved
        Boundary name -> components that follow the unit motion there. Particle j moves with its end
        plane as a rigid body, which is the lift that keeps round-off small for stiff particles.
    """

    mode: FourierMode
    held: dict[str, tuple[int, ...]]
    moved: dict[str, tuple[int, ...]]


_ROLLER_HELD = {"axis": (U_R,), "end_i": (U_Z,), "end_j": (U_Z,), "middle": (U_Z,)}
_MOVED = {"end_j": (U_Z,), "middle": (U_Z,)}

NORMAL = {
    "roller": Supports(mode=AXIAL, held=_ROLLER_HELD, moved=_MOVED),
    "clamped": Supports(
        mode=AXIAL,
        held=_ROLLER_HELD | {"end_i": (U_R, U_Z), "end_j": (U_R, U_Z)},
        moved=_MOVED,
    ),
    "confined": Supports(mode=AXIAL, held=_ROLLER_HELD | {"lateral": (U_R,)}, moved=_MOVED),
}
"""Supports of the normal load by boundary condition."""
