"""What the paper prints of its specimen."""

from __future__ import annotations

PRINTED = {"fe": (0.0055, 1.466e-3), "de": (0.0052, 1.357e-3)}
"""Energy [J] and displacement norm [m] that the paper prints for its two models."""

PAPER_RATIO = 0.944
"""Energy of its lattice over that of its solid, as printed."""

PAPER_NODES, PAPER_ELEMENTS = 830_098, 549_098
"""Size of its mesh of second-order tetrahedra."""


def printed_stiffness(model: str) -> float:
    """``2 U / n^2`` of the printed pair [N/m], n the norm of the particles' displacements.

    Examples
    --------
    >>> round(printed_stiffness("de"))
    5648
    """
    energy, norm = PRINTED[model]
    return 2 * energy / norm**2
