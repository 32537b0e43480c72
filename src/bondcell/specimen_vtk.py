"""Files for ParaView: fields of the solid, and the deformed lattice with its forces."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from bondcell.cell import FloatArray
from bondcell.lattice.lattice import Lattice
from bondcell.lattice.solve import Solution
from bondcell.solid.tets import Tets


def write_solid(path: str | Path, mesh: Tets, displacement: FloatArray) -> None:
    """Write second-order tetrahedra with their displacements.

    Parameters
    ----------
    path
        The file; its suffix names the format, usually ``.vtu``.
    mesh
        The mesh.
    displacement
        Of the nodes [m], shape (nodes, 3).

    Notes
    -----
    Point data ``displacement`` and ``displacement_magnitude``; cell data ``particle``: its number
    from 1, 0 in the matrix.
    """
    import meshio

    meshio.Mesh(
        mesh.points,
        [("tetra10", mesh.nodes)],
        point_data={
            "displacement": displacement,
            "displacement_magnitude": np.linalg.norm(displacement, axis=1),
        },
        cell_data={"particle": [mesh.material + 1]},
    ).write(path)


def write_lattice(path: str | Path, lattice: Lattice, solution: Solution) -> None:
    """Write the nodes and bonds of a lattice where they are after the motion.

    Parameters
    ----------
    path
        The file; its suffix names the format, usually ``.vtu``.
    lattice, solution
        The lattice and its equilibrium.

    Notes
    -----
    Point data ``displacement`` and, where nodes have one, ``rotation``; cell data
    ``normal_force`` [N] of the bonds, and ``shear_force`` where they have one.
    """
    import meshio

    own, d = lattice.bonds, lattice.dimension
    shift = np.zeros((lattice.count, 3))
    shift[:, :d] = solution.motion[:, :d]
    where = np.zeros_like(shift)
    where[:, :d] = lattice.points
    points = {"displacement": shift}
    cells = {"normal_force": [solution.bond_forces[:, 0]]}
    if lattice.rotates:
        points["rotation"] = solution.motion[:, d:]
        across = slice(1, 2) if d == 2 else slice(1, 3)
        cells["shear_force"] = [np.linalg.norm(solution.bond_forces[:, across], axis=1)]
    ends = np.stack([own.first, own.second], axis=1)
    meshio.Mesh(where + shift, [("line", ends)], point_data=points, cell_data=cells).write(path)
