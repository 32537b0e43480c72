"""What a wall does to the spheres near it, through the margin of matrix between."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from bondcell.cell import FloatArray
from bondcell.fem.blocks import IndexArray
from bondcell.lattice.packing import Packing
from bondcell.solid.mirror_cell import ORDER
from bondcell.solid.raise_order import raise_order
from bondcell.solid.rigid import condense
from bondcell.solid.sphere_mesh import sphere_mesh
from bondcell.solid.stiffness import Elastic


def wall_stiffness(
    spheres: Packing,
    matrix: Elastic,
    wall: int,
    held: Sequence[int],
    per_gap: float,
) -> tuple[FloatArray, IndexArray]:
    """Stiffness that a margin has more when its wall is held than when it is free.

    Parameters
    ----------
    spheres
        The rigid spheres next to the wall in a box that ends behind them; half of it, cut at the
        lower side of z, which is a mirror.
    matrix
        The matrix material.
    wall
        Side of the box in question, counted as in ``box.ravel()``.
    held
        Sides that are held in any case; a sphere cut by one is fixed.
    per_gap
        Element size relative to the gap.

    Returns
    -------
    tuple
        Stiffness of the whole depth by motions (x, y, rotation) of the spheres that move [N/m, N,
        N m], shape (3 moving, 3 moving), and the numbers of these spheres.

    Notes
    -----
    The rest of the body is the same in both solutions: behind the first spheres nothing of the wall
    is felt, and the difference does not know where the box ends.
    """
    mesh = raise_order(sphere_mesh(spheres, per_gap, order=ORDER), ORDER, spheres)
    fixed = np.zeros((len(mesh.points), 3), dtype=bool)
    fixed[mesh.on_plane(2, spheres.box[2, 0]), 2] = True
    for side in held:
        fixed[mesh.on_plane(side // 2, spheres.box.ravel()[side])] = True
    free = condense(mesh, spheres, matrix, fixed)
    fixed[mesh.on_plane(wall // 2, spheres.box.ravel()[wall])] = True
    walled = condense(mesh, spheres, matrix, fixed)
    return 2 * (walled.stiffness - free.stiffness), free.moving
