"""The specimen as a lattice: which springs each variant has, and its answer to a load."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from bondcell.cell import FloatArray
from bondcell.fem.blocks import IndexArray
from bondcell.lattice import specimen_geometry as given
from bondcell.lattice.bonds import bonds
from bondcell.lattice.lattice import Lattice, lattice
from bondcell.lattice.solve import Solution, solve
from bondcell.lattice.specimen_geometry import specimen_packing
from bondcell.specimen.bonds import Material, bond_springs, wall_spring
from bondcell.specimen.full_lattice import LayerEnergies, full_springs

VARIANTS: Mapping[str, tuple[str, tuple[str, ...]]] = {
    "lattice_paper": ("paper", ("normal",)),
    "lattice_fsi": ("fsi", ("normal",)),
    "lattice_film": ("film", ("normal",)),
    "lattice_fe_normal": ("fe", ("normal",)),
    "lattice_fe_shear": ("fe", ("normal", "shear", "pivot")),
    "lattice_fe_beam": ("fe", ("normal", "shear", "pivot", "bending", "torsion")),
    "lattice_full": ("fe", ("normal", "shear", "pivot", "bending", "torsion")),
}
"""Lattices: where the bonds come from and which of their springs are used."""

Springs = Callable[[Material, str], Mapping[str, float]]

NEIGHBOURS = 2 * given.GAP
"""Gap up to which spheres are bonded [m]."""


@dataclass(frozen=True)
class SpecimenLattice:
    """A lattice with the nodes it is held at.

    Parameters
    ----------
    lattice
        The first 18 nodes are the particles.
    fixed
        Nodes held: those on the bottom wall, and those on the sides if there are any.
    """

    lattice: Lattice
    fixed: IndexArray

    def solve(self, displacement: FloatArray) -> Solution:
        """Displace particles 1 to 3 by (x, y) [m]; their rotation is free."""
        shape = (self.lattice.count, self.lattice.width)
        held, values = np.zeros(shape, dtype=bool), np.zeros(shape)
        held[self.fixed] = True
        held[list(given.LOADED), :2] = True
        values[list(given.LOADED), :2] = displacement
        return solve(self.lattice, held, values)


def specimen_lattice(
    variant: str,
    material: Material,
    walls: str,
    layer: LayerEnergies | None = None,
    springs_of: Springs = bond_springs,
) -> SpecimenLattice:
    """Build one of `VARIANTS`.

    Parameters
    ----------
    variant
        The name.
    material
        The elastic constants; ``lattice_paper`` has its own stiffnesses.
    walls
        Sides of the box: ``free`` or ``fixed``.
    layer
        Energies of the cells of its layer of spheres; for ``lattice_full``.
    springs_of
        Gives the springs of a bond; another one may remember what it gave.

    Notes
    -----
    ``lattice_paper`` has its side springs whatever the walls: 22 nodes, 41 elements. In the other
    ones, particles next to a fixed side stand on `wall_spring` across it and along it; in
    ``lattice_full`` on what a cell of the margin gives.
    """
    source, used = VARIANTS[variant]
    packed = specimen_packing()
    pairs = packed.neighbours(NEIGHBOURS)
    points = packed.centres[:, :2]
    bottom = np.flatnonzero(packed.on_wall(2))
    if source == "paper":
        return _paper(points, pairs, bottom)
    springs = springs_of(material, source)
    own = bonds(pairs, **{name: springs[name] for name in used})
    three = None
    if variant == "lattice_full":
        if layer is None:
            raise ValueError("lattice_full needs the energies of its layer's cells")
        own, three = full_springs(own, points, springs, layer)
    bare = lattice(points, own, three)
    ground = np.zeros((bare.count, bare.width))
    if walls == "fixed" and layer is not None:
        return SpecimenLattice(lattice(points, own, three, walls=layer.walls), bottom)
    if walls == "fixed":
        shear = 1 / (2 * (1 + material.poisson_matrix))
        for node in given.SIDE:
            distance = given.BOX[0][1] - abs(points[node, 0])
            ground[node, :2] = wall_spring(material.young_matrix, distance) * np.array([1, shear])
    return SpecimenLattice(lattice(points, own, three, ground), bottom)


def _paper(points: FloatArray, pairs: IndexArray, bottom: IndexArray) -> SpecimenLattice:
    """The paper's: bonds of one stiffness and four springs to nodes on the sides."""
    sides = np.array([[np.sign(points[n, 0]) * given.BOX[0][1], points[n, 1]] for n in given.SIDE])
    walls = len(points) + np.arange(len(sides))
    links = np.stack([np.array(given.SIDE), walls], axis=1)
    own = bonds(pairs, given.PAPER_STIFFNESS).joined(bonds(links, given.PAPER_SIDE_STIFFNESS))
    every = lattice(np.concatenate([points, sides]), own)
    return SpecimenLattice(every, np.concatenate([bottom, walls]))
