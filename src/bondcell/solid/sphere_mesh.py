"""Meshing a box with spheres by gmsh."""

from __future__ import annotations

import tempfile
from pathlib import Path
from types import ModuleType

import numpy as np

from bondcell.errors import BondcellError, InputError, Violation
from bondcell.fem.blocks import IndexArray
from bondcell.fem.gmsh_session import gmsh_model
from bondcell.lattice.packing import Packing
from bondcell.solid.memory import check_memory
from bondcell.solid.size_field import SizeField, size_field
from bondcell.solid.tets import MATRIX, Tets, second_order

LARGEST_SIZE = 0.4
"""Largest element relative to the smallest radius: longer ones turn inside out on the spheres."""

_TETRAHEDRON = 4
# Triangles of its first surface algorithm do not dent the spheres at the poles of their charts.
_OPTIONS = {"Mesh.OptimizeThreshold": 0.35, "Mesh.Algorithm": 1}


def sphere_mesh(
    packing: Packing,
    per_gap: float,
    largest: float = LARGEST_SIZE,
    memory: float | None = None,
    order: int = 2,
) -> Tets:
    """Mesh spheres and the matrix around them.

    Parameters
    ----------
    packing
        Spheres in a bounded box; walls may cut them in half.
    per_gap
        Element size relative to the local gap between spheres.
    largest
        Largest element relative to the smallest radius.
    memory
        What a solution may take [bytes]; default: what the machine has free.
    order
        Order of the displacements that the mesh is meant for; its own is two.

    Raises
    ------
    InputError
        A size out of range, an unbounded box, or a mesh that would take more memory.
    MissingLibrary
        gmsh or a system library of it is absent.
    BondcellError
        gmsh could not mesh the body, or an element came out inverted.
    """
    violations = []
    if not 0 < per_gap <= 2:
        violations.append(Violation("per_gap", per_gap, "(0, 2]"))
    if not 0 < largest <= LARGEST_SIZE:
        violations.append(Violation("largest", largest, f"(0, {LARGEST_SIZE}]"))
    if not np.isfinite(packing.box).all():
        violations.append(Violation("box", packing.box.tolist(), "finite walls"))
    if violations:
        raise InputError(violations)
    sizes = size_field(packing, per_gap, largest * float(packing.radii.min()))
    check_memory(sizes.elements, memory, order)
    with gmsh_model("bondcell packing", _OPTIONS) as gmsh, tempfile.TemporaryDirectory() as folder:
        try:
            volumes = _draw(gmsh, packing)
            _set_sizes(gmsh, sizes, Path(folder) / "sizes.bin")
            gmsh.model.mesh.generate(3)
            points, corners, material = _read(gmsh, volumes)
        except Exception as error:  # gmsh raises nothing more specific
            text = f"gmsh could not mesh {packing.count} spheres at {per_gap} of the gap: {error}"
            raise BondcellError(text) from error
    return second_order(points, corners, material, packing)


def _draw(gmsh: ModuleType, packing: Packing) -> dict[int, int]:
    """Draw the box with its spheres; material of each volume."""
    occ, box = gmsh.model.occ, packing.box
    block = occ.addBox(*box[:, 0], *(box[:, 1] - box[:, 0]))
    whole = [
        occ.addSphere(*centre, radius)
        for centre, radius in zip(packing.centres.tolist(), packing.radii.tolist(), strict=True)
    ]
    balls = [
        occ.intersect([(3, ball)], [(3, block)], removeObject=True, removeTool=False)[0][0]
        for ball in whole
    ]
    _, pieces = occ.fragment([(3, block)], balls)
    occ.synchronize()
    owner = {piece[0][1]: particle for particle, piece in enumerate(pieces[1:])}
    return {tag: owner.get(tag, MATRIX) for _, tag in pieces[0]}


def _set_sizes(gmsh: ModuleType, sizes: SizeField, path: Path) -> None:
    """Hand the size field to gmsh, which interpolates it itself, through its binary format."""
    with path.open("wb") as file:
        for values in (sizes.origin, sizes.spacing):
            file.write(values.astype("<f8").tobytes())
        file.write(np.array(sizes.sizes.shape, dtype="<i4").tobytes())
        file.write(sizes.sizes.astype("<f8").tobytes())
    field = gmsh.model.mesh.field
    grid = field.add("Structured")
    field.setString(grid, "FileName", str(path))
    field.setNumber(grid, "TextFormat", 0)
    field.setAsBackgroundMesh(grid)


def _read(gmsh: ModuleType, volumes: dict[int, int]) -> tuple[np.ndarray, IndexArray, IndexArray]:
    """Nodes of straight tetrahedra, elements and materials; nothing goes through a file."""
    tags, coordinates, _ = gmsh.model.mesh.getNodes()
    elements, material = [], []
    for volume, name in volumes.items():
        _, nodes = gmsh.model.mesh.getElementsByType(_TETRAHEDRON, volume)
        elements.append(nodes.astype(np.int64).reshape(-1, 4))
        material.append(np.full(len(elements[-1]), name, dtype=np.int64))
    all_nodes = np.concatenate(elements)
    used, local = np.unique(all_nodes, return_inverse=True)
    where = np.zeros((int(tags.max()) + 1, 3))
    where[tags.astype(np.int64)] = coordinates.reshape(-1, 3)
    return where[used], local.reshape(all_nodes.shape), np.concatenate(material)
