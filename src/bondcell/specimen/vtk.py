"""Files for ParaView: fields of the solid, and the deformed lattice with its forces."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import xarray as xr
from numpy.typing import NDArray
from scipy.sparse import csr_array

from bondcell.cell import FloatArray
from bondcell.lattice.lattice import Lattice
from bondcell.lattice.solve import Solution
from bondcell.lattice.specimen_geometry import specimen_packing
from bondcell.solid.tets import Tets


def write_solid(path: str | Path, mesh: Tets, displacement: FloatArray) -> None:
    """Write second-order tetrahedra with their displacements.

    Parameters
    ----------
    path
        The file, of VTK's format ``.vtu`` whatever it is called.
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
    ).write(path, file_format="vtu")


def write_lattice(path: str | Path, lattice: Lattice, solution: Solution) -> None:
    """Write the nodes and bonds of a lattice where they are after the motion.

    Parameters
    ----------
    path
        The file, of VTK's format ``.vtu`` whatever it is called.
    lattice, solution
        The lattice and its equilibrium.

    Notes
    -----
    Point data ``displacement`` and, where nodes have one, ``rotation``; cell data
    ``normal_force`` [N] of the bonds, and ``shear_force`` where they have one.
    """
    own, d = lattice.bonds, lattice.dimension
    shift = np.zeros((lattice.count, 3))
    shift[:, :d] = solution.motion[:, :d]
    where = np.zeros_like(shift)
    where[:, :d] = lattice.points
    points = {"displacement": shift}
    cells = {"normal_force": solution.bond_forces[:, 0]}
    if lattice.rotates:
        points["rotation"] = solution.motion[:, d:]
        across = slice(1, 2) if d == 2 else slice(1, 3)
        cells["shear_force"] = np.linalg.norm(solution.bond_forces[:, across], axis=1)
    _write_lines(path, where, np.stack([own.first, own.second], axis=1), points, cells)


def write_lattice_result(path: str | Path, study: xr.Dataset, bonds: xr.Dataset) -> None:
    """Write a lattice of a specimen's results where it is after the motion.

    Parameters
    ----------
    path
        The file.
    study, bonds
        Root group and group ``bonds`` at one method, loading and kind of walls.

    Notes
    -----
    As `write_lattice`; bonds to the walls are left out: the results hold particles only.
    """
    ends, forces = bonds["bond_nodes"].values - 1, bonds["bond_force"].values
    inside = (ends >= 0).all(axis=1) & (ends < study.sizes["particle"]).all(axis=1)
    inside &= np.isfinite(forces[:, 0])
    shift = np.zeros((study.sizes["particle"], 3))
    shift[:, :2] = study["displacement"].values
    where = specimen_packing().centres
    points = {"displacement": shift}
    cells = {"normal_force": forces[inside, 0]}
    if np.isfinite(study["rotation"]).all():
        points["rotation"] = study["rotation"].values[:, np.newaxis]
        cells["shear_force"] = np.abs(forces[inside, 1])
    _write_lines(path, where, ends[inside], points, cells)


def write_field(path: str | Path, field: xr.Dataset, loading: str) -> None:
    """Write the solid's field of one loading, as `bondcell.specimen.run.run_part` gives it."""
    mesh = Tets(
        field["point"].values,
        field["element"].values.astype(np.int64),
        field["particle"].values.astype(np.int64),
        0,
        csr_array((0, 0)),
    )
    write_solid(path, mesh, field["displacement"].sel(loading=loading).values)


def _write_lines(
    path: str | Path,
    where: FloatArray,
    ends: NDArray[np.int64],
    points: dict[str, FloatArray],
    cells: dict[str, FloatArray],
) -> None:
    import meshio

    data = {name: [values] for name, values in cells.items()}
    placed = where + points["displacement"]
    lines = meshio.Mesh(placed, [("line", ends)], point_data=points, cell_data=data)
    lines.write(path, file_format="vtu")
