"""What a lattice of bonds lacks of a triangular layer: pockets, and other bonds at its border.

A bond's stiffness is that of two particles in a cylinder. In a layer the pockets between three
bonds are shared, and along its border the matrix goes on to a free surface or a wall. Here the
springs for that are the rest that bonds leave of small cells' energies.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from bondcell.cell import FloatArray
from bondcell.lattice.bonds import bonds
from bondcell.lattice.lattice import lattice
from bondcell.lattice.pockets import pockets, triangles
from bondcell.solid.layer_cells import BorderEnergies, TriangleEnergies


@dataclass(frozen=True)
class PairSprings:
    """A bond of equal particles.

    Parameters
    ----------
    normal, shear
        [N/m].
    bending
        [N m/rad].
    offset
        As in `bondcell.lattice.bonds.Bonds`, away from the layer [m].
    """

    normal: float
    shear: float
    bending: float
    offset: float = 0.0


def pocket_springs(
    triangle: TriangleEnergies, bond: PairSprings, length: float
) -> Mapping[str, float]:
    """Constants of `bondcell.lattice.pockets.pockets` [J].

    Notes
    -----
    Half of each side's bond belongs to a triangle. Under the strain (1, 1)
    ``2 U = 3/2 K_n L^2 + 4 K_tri``, under (1, -1) ``2 U = 3/4 (K_n + K_s) L^2 + 4 K_dev``; when all
    spheres turn ``2 U = 3/2 K_s L^2 + K_turn``; when rows turn against each other
    ``2 U = 1/2 K_s L^2 + 4 K_b + 1/9 K_turn + 8/3 K_twist``.
    """
    square = length**2
    normal, shear = bond.normal * square, bond.shear * square
    turning = triangle.turn - 1.5 * shear
    twist = triangle.twist - 0.5 * shear - 4 * bond.bending - turning / 9
    return {
        "stiffness": (triangle.dilation - 1.5 * normal) / 4,
        "deviator": (triangle.deviator - 0.75 * (normal + shear)) / 4,
        "turning": turning,
        "twist": 3 / 8 * twist,
    }


def border_bond(
    border: BorderEnergies, bond: PairSprings, pocket: Mapping[str, float], length: float
) -> PairSprings:
    """The bond between two spheres of a layer's last row.

    Notes
    -----
    With k, s, b the springs beyond those of the bond, c the coupling of normal force and relative
    rotation, alternating motions cost ``4 k u^2 + 8 c u th + 4 b th^2`` more by sphere than in
    the lattice of bonds and pockets, and uniform rotations ``s L^2 th^2``. A normal force beside
    the nodes carries the coupling: ``offset = -c / (K_n + k)``, ``K_b + b = K_bb + K_nn offset^2``.
    """
    alternate, turn = _row_energies(bond, pocket, length)
    more = (border.alternate - alternate) / 4
    normal = bond.normal + float(more[0, 0])
    offset = -float(more[0, 1]) / normal
    return PairSprings(
        normal=normal,
        shear=bond.shear + float(border.turn - turn) / length**2,
        bending=bond.bending + float(more[1, 1]) - normal * offset**2,
        offset=offset,
    )


def _row_energies(
    bond: PairSprings, pocket: Mapping[str, float], length: float
) -> tuple[FloatArray, float]:
    """The lattice's ``alternate`` and ``turn`` of `BorderEnergies`, by the work on one sphere."""
    row = length * np.arange(-2, 3)
    below = length * np.arange(-1.5, 2)
    heights = np.repeat([0.0, -np.sqrt(3) / 2 * length], [row.size, below.size])
    points = np.column_stack([np.concatenate([row, below]), heights])
    distance = np.linalg.norm(points[:, np.newaxis] - points, axis=2)
    pairs = np.argwhere(np.triu((distance > 0) & (distance < 1.1 * length)))
    own = bonds(pairs, bond.normal, bond.shear, bond.bending)
    net = lattice(points, own, pockets(triangles(pairs, len(points)), **pocket))
    motions = np.zeros((len(points), 3, 3))
    motions[:5, 0, 0] = motions[:5, 2, 1] = [1, -1, 1, -1, 1]
    motions[:5, 2, 2] = 1
    forces = (net.matrix() @ motions.reshape(-1, 3)).reshape(motions.shape)[2]
    return forces[[0, 2], :2], float(forces[2, 2])
