"""The jobs of a specimen scene: lattices, each solid, relaxation, finite strain."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from bondcell.lattice.solve import Solution
from bondcell.solid.raise_order import second_order_part
from bondcell.specimen.bonds import Material
from bondcell.specimen.bound import softest_lattice
from bondcell.specimen.finite_strain import specimen_finite_strain
from bondcell.specimen.lattice_variants import SpecimenLattice
from bondcell.specimen.midplane import midplane
from bondcell.specimen.relaxation import specimen_relaxation
from bondcell.specimen.specimen import specimen

if TYPE_CHECKING:
    from bondcell.scenes.scene import Scene
    from bondcell.scenes.specimen_block import SpecimenBlock

FORCES = ("normal", "shear", "moment")
"""What a bond carries."""

REPEATS = 3
"""Timed runs of each lattice."""

BONDS = 41
"""Bonds of the paper's lattice, the last four of them to the sides; others have the first 37."""

SOFTEST = {
    "units": "N m-1",
    "long_name": "smallest 2 U / n^2 of any displacement of the particles of norm n",
}
FORCE = {"units": "N", "long_name": "force of the bond; moment: about its pivot, N m"}


def material_of(scene: Scene) -> Material:
    """The specimen's elastic constants: the cell's where given, else the paper's."""
    names = {
        "young_i": "young_particle",
        "poisson_i": "poisson_particle",
        "young_m": "young_matrix",
        "poisson_m": "poisson_matrix",
    }
    given = scene.cell.given()
    return Material(**{own: given[name] for name, own in names.items() if name in given})


def run_part(scene: Scene, part: str) -> list[xr.Dataset]:
    """Do one of the jobs that a scene's specimen is cut into.

    Parameters
    ----------
    scene
        A scene with a specimen block.
    part
        One of its ``specimen.parts``.

    Returns
    -------
    list
        Its result, and of elastic particles the field on the finest mesh (``point``, ``element``,
        ``particle`` of elements, -1 in the matrix, ``displacement``) and its cut at z = 0, see
        `bondcell.specimen.midplane`.
    """
    block, material = scene.specimen, material_of(scene)
    if block is None:
        raise ValueError(f"the scene {scene.name} has no specimen")
    if part == "lattices":
        return [_lattices(block, material)]
    if part == "relaxation":
        return [_relaxation(block, material)]
    if part == "finite_strain":
        return [_finite_strain(block, material)]
    found, *fields = _solid(block, material, part)
    return [found, *fields, *(midplane(field, material) for field in fields)]


def _lattices(block: SpecimenBlock, material: Material) -> xr.Dataset:
    """All lattices, with the forces of their bonds and their softest motions."""
    shape = (len(block.lattices), len(block.loadings), len(block.walls))
    forces = np.full((*shape, BONDS, len(FORCES)), np.nan)
    least = np.full((shape[0], shape[2]), np.nan)
    ends = np.full((BONDS, 2), -1)

    def watch(method: str, walls: str, own: SpecimenLattice, found: list[Solution]) -> None:
        row, column = block.lattices.index(method), block.walls.index(walls)
        count, kinds = found[0].bond_forces.shape
        for k, solution in enumerate(found):
            forces[row, k, column, :count, :kinds] = solution.bond_forces
        least[row, column] = softest_lattice(own.lattice, own.fixed)
        # The paper counts nodes from 1.
        ends[:count] = np.stack([own.lattice.bonds.first, own.lattice.bonds.second], axis=1) + 1

    # What is imported on the way belongs to no lattice's time.
    specimen(block.lattices[:1], block.loadings, block.walls[:1], material=material)
    asked = block.lattices, block.loadings, block.walls
    data = specimen(*asked, material=material, watch=watch, repeats=REPEATS)
    data = data.drop_dims(["per_gap", "order"]).drop_vars(["limit_energy", "limit_error"])
    return data.assign_coords(force=list(FORCES)).assign(
        bond_force=(("method", "loading", "walls", "bond", "force"), forces, FORCE),
        bond_nodes=(("bond", "end"), ends, {"units": "1", "long_name": "nodes of the bond"}),
        softest=(("method", "walls"), least, SOFTEST),
    )


def _solid(block: SpecimenBlock, material: Material, method: str) -> list[xr.Dataset]:
    """One solid on its ladders of meshes; the field with free walls, if they are solved."""
    asked = block.solids()[method]
    ladders = asked.sizes()
    least: dict[str, float] = {}
    kept: dict[str, xr.Dataset] = {}

    def watch(_: str, walls: str, mesh: Any, answer: Any) -> None:
        least[walls] = answer.softest
        if answer.field is not None:
            kept[walls] = _field(*second_order_part(mesh, answer.field), block.loadings, walls)

    found = [
        specimen([method], block.loadings, [walls], sizes, asked.orders, material, watch)
        for walls, sizes in ladders.items()
    ]
    every = sorted({size for sizes in ladders.values() for size in sizes}, reverse=True)
    data = xr.concat([one.reindex(per_gap=every) for one in found], "walls")
    data = data.assign(softest=(("method", "walls"), [list(least.values())], SOFTEST))
    return [data.drop_vars("mode_energy"), *list(kept.values())[:1]]


def _field(mesh: Any, field: Any, loadings: tuple[str, ...], walls: str) -> xr.Dataset:
    dims = ("node", "axis", "loading")
    return xr.Dataset(
        {
            "point": (dims[:2], mesh.points, {"units": "m", "long_name": "place of the node"}),
            "displacement": (dims, field, {"units": "m", "long_name": "displacement"}),
            "element": (
                ("element_number", "local"),
                mesh.nodes.astype(np.int32),
                {"units": "1", "long_name": "nodes of a second-order tetrahedron"},
            ),
            "particle": (
                "element_number",
                mesh.material.astype(np.int32),
                {"units": "1", "long_name": "particle of the element, -1 in the matrix"},
            ),
        },
        {"axis": ["x", "y", "z"], "loading": list(loadings)},
        {"walls": walls},
    )


def _relaxation(block: SpecimenBlock, material: Material) -> xr.Dataset:
    from bondcell.prony.prony import Prony

    wanted = block.relaxation
    assert wanted is not None
    series = wanted.series
    prony = Prony(series.weights, series.times, series.relative_to)
    time = [0.0, *wanted.times.values().tolist()]
    return specimen_relaxation(
        prony, time, wanted.methods, wanted.convention, "free", wanted.per_gap, material
    ).assign_attrs(per_gap=wanted.per_gap)


def _finite_strain(block: SpecimenBlock, material: Material) -> xr.Dataset:
    wanted = block.finite_strain
    assert wanted is not None
    return specimen_finite_strain(
        wanted.methods, wanted.directions, "free", wanted.per_gap, material, wanted.steps
    )
