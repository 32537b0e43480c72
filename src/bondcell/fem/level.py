"""One rung of a convergence ladder: what a single finite element solve gave and cost."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Level:
    """Result of one discretisation of one cell.

    Parameters
    ----------
    stiffness
        K_n of the whole cell [N/m].
    dof
        Unknowns solved for.
    elements
        Elements of the mesh.
    seconds_mesh, seconds_assembly, seconds_solve
        Wall time of the three stages [s].
    """

    stiffness: float
    dof: int
    elements: int
    seconds_mesh: float
    seconds_assembly: float
    seconds_solve: float

    @property
    def seconds(self) -> float:
        """Wall time of all stages [s]."""
        return self.seconds_mesh + self.seconds_assembly + self.seconds_solve
