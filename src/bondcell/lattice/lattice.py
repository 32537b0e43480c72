"""A lattice: rigid bodies at nodes, bonds, pockets and springs to the ground between them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.sparse import bsr_array

from bondcell.cell import FloatArray
from bondcell.errors import InputError, Violation
from bondcell.fem.blocks import BlockAssembler, IndexArray
from bondcell.lattice.bonds import MODES, Bonds, strains
from bondcell.lattice.pockets import Pockets, pocket_strains, pockets
from bondcell.lattice.walls import Wall

CHUNK = 50_000
"""Bonds whose element matrices are held at once."""


@dataclass(frozen=True)
class Lattice:
    """A linear lattice; build it with `lattice`, which checks it.

    Parameters
    ----------
    points
        Nodes [m], shape (nodes, 2) or (nodes, 3).
    bonds, pockets
        What joins them.
    ground
        Stiffness of the springs between each unknown and the ground, shape (nodes, width).
    rotates
        Whether nodes have rotations; without them bonds resist along their axis only.
    walls
        Stiffness of walls, each against the motions of several nodes at once.
    """

    points: FloatArray
    bonds: Bonds
    pockets: Pockets
    ground: FloatArray
    rotates: bool
    walls: tuple[Wall, ...] = ()

    @property
    def count(self) -> int:
        """Number of nodes."""
        return len(self.points)

    @property
    def dimension(self) -> int:
        """2 in the plane, 3 in space."""
        return int(self.points.shape[1])

    @property
    def width(self) -> int:
        """Unknowns of a node: displacements, then rotations."""
        return node_width(self.dimension, self.rotates)

    def bond_strains(self, rows: slice = slice(None)) -> FloatArray:
        """Strains of bonds by the motions of their nodes, shape (bonds, strains, 2 width)."""
        full = strains(self.points, self.bonds.take(rows))
        if self.rotates:
            return full
        shifts = full.reshape(len(full), -1, 2, full.shape[2] // 2)[..., : self.dimension]
        return np.asarray(shifts[:, :1].reshape(len(full), 1, -1))

    def bond_stiffness(self) -> FloatArray:
        """Stiffness of each of `bond_strains`, shape (bonds, strains)."""
        full = self.bonds.stiffness(self.dimension)
        return full if self.rotates else full[:, :1]

    def pocket_strains(self) -> FloatArray:
        """Strains of the pockets by the motions of the corners, shape (pockets, 7, 3 width)."""
        return pocket_strains(self.points, self.pockets.corners, self.width)

    def matrix(self) -> bsr_array:
        """Stiffness matrix; unknown ``width n + c`` is component c of node n."""
        ends = np.stack([self.bonds.first, self.bonds.second], axis=1)
        every = np.arange(self.count)[:, np.newaxis]
        assembler = BlockAssembler(ends, self.count, self.width)
        stiffness = self.bond_stiffness()
        for start in range(0, self.bonds.count, CHUNK):
            rows = slice(start, start + CHUNK)
            assembler.add(rows, _element_matrices(self.bond_strains(rows), stiffness[rows]))
        total = assembler.matrix()
        own = BlockAssembler(every, self.count, self.width)
        own.add(slice(None), self.ground[:, :, np.newaxis] * np.eye(self.width))
        total = bsr_array(total + own.matrix())
        if self.pockets.count:
            three = BlockAssembler(self.pockets.corners, self.count, self.width)
            local = _element_matrices(self.pocket_strains(), self.pockets.constants())
            three.add(slice(None), local)
            total = bsr_array(total + three.matrix())
        for wall in self.walls:
            part = BlockAssembler(wall.nodes[np.newaxis], self.count, self.width)
            part.add(slice(None), wall.stiffness[np.newaxis])
            total = bsr_array(total + part.matrix())
        return total

    def grounded(self) -> NDArray[np.bool_]:
        """Unknowns that something ties to the ground, shape (nodes, width)."""
        result = self.ground > 0
        for wall in self.walls:
            result[wall.nodes] |= np.diag(wall.stiffness).reshape(-1, self.width) > 0
        return result


def node_width(dimension: int, rotates: bool) -> int:
    """Unknowns of a node."""
    return dimension + (0 if not rotates else 1 if dimension == 2 else 3)


def lattice(
    points: ArrayLike,
    bonds: Bonds,
    pockets_: Pockets | None = None,
    ground: ArrayLike = 0.0,
    rotates: bool | None = None,
    walls: Sequence[Wall] = (),
) -> Lattice:
    """Check a lattice.

    Parameters
    ----------
    points
        Nodes [m], shape (nodes, 2) or (nodes, 3).
    bonds, pockets_
        What joins them.
    ground
        Stiffness of springs to the ground, broadcast to (nodes, width) [N/m, N m/rad].
    rotates
        Whether nodes have rotations. Default: if a bond resists more than its lengthening, or a
        pocket rotations.
    walls
        See `bondcell.lattice.walls.wall`.

    Raises
    ------
    InputError
        A node that does not exist, two bonded nodes at one place, a triangle without an area, a
        negative ground spring.

    Examples
    --------
    Two particles are the bond between them:

    >>> from bondcell.lattice.bonds import bonds
    >>> pair = lattice([[0, 0], [0.0155, 0]], bonds([[0, 1]], normal=1.6e5))
    >>> pair.matrix().toarray()[::2, ::2]
    array([[ 160000., -160000.],
           [-160000.,  160000.]])
    """
    where = np.asarray(points, dtype=np.float64)
    if where.ndim != 2 or where.shape[1] not in (2, 3):
        raise InputError([Violation("points", where.shape, "shape (nodes, 2) or (nodes, 3)")])
    three = pockets_ if pockets_ is not None else pockets(np.zeros((0, 3), dtype=np.int64), 0.0)
    if rotates is None:
        rotates = three.turns or any(getattr(bonds, mode).any() for mode in MODES[3][1:])
    violations = _unknown_nodes("bonds", np.stack([bonds.first, bonds.second], 1), len(where))
    violations += _unknown_nodes("pockets", three.corners, len(where))
    width = node_width(where.shape[1], rotates)
    springs = np.asarray(ground, dtype=np.float64)
    if not (np.isfinite(springs) & (springs >= 0)).all():
        violations.append(Violation("ground", springs.tolist(), "[0, inf) N/m, N m/rad"))
    for k, wall in enumerate(walls):
        violations += _unknown_nodes(f"walls[{k}].nodes", wall.nodes[:, np.newaxis], len(where))
        if len(wall.stiffness) != width * wall.nodes.size:
            allowed = f"{width} unknowns for each of its nodes"
            violations.append(Violation(f"walls[{k}].stiffness", wall.stiffness.shape, allowed))
    if where.shape[1] == 3 and bonds.offset.any():
        violations.append(Violation("bonds.offset", bonds.offset.tolist(), "0 m in space"))
    if violations:
        raise InputError(violations)
    result = Lattice(
        where,
        bonds,
        three,
        np.broadcast_to(springs, (len(where), width)).copy(),
        rotates,
        tuple(walls),
    )
    _check_shapes(result)
    return result


def _unknown_nodes(field: str, nodes: IndexArray, count: int) -> list[Violation]:
    bad = np.flatnonzero(((nodes < 0) | (nodes >= count)).any(axis=1))
    allowed = f"nodes 0 to {count - 1}"
    return [Violation(f"{field}[{k}]", nodes[k].tolist(), allowed) for k in bad[:20]]


def _check_shapes(own: Lattice) -> None:
    """Raise for bonds without a direction and triangles without an area."""
    first, second = own.points[own.bonds.first], own.points[own.bonds.second]
    lost = np.flatnonzero((first == second).all(axis=1))
    pairs = np.stack([own.bonds.first, own.bonds.second], axis=1)
    violations = [
        Violation(f"bonds[{k}]", pairs[k].tolist(), "two nodes at different places")
        for k in lost[:20]
    ]
    sides = own.points[own.pockets.corners]
    padded = np.zeros((len(sides), 3, 3))
    padded[..., : own.dimension] = sides
    edges = padded[:, 1:] - padded[:, :1]
    area = np.linalg.norm(np.cross(edges[:, 0], edges[:, 1]), axis=1)
    flat = np.flatnonzero(area <= 1e-9 * (edges**2).sum(axis=(1, 2)))
    violations += [
        Violation(f"pockets[{k}]", own.pockets.corners[k].tolist(), "corners not on one line")
        for k in flat[:20]
    ]
    if violations:
        raise InputError(violations)


def _element_matrices(strain: FloatArray, stiffness: FloatArray) -> FloatArray:
    """``B^T diag(k) B`` of each element."""
    weighted = strain * stiffness[:, :, np.newaxis]
    return np.asarray(strain.transpose(0, 2, 1) @ weighted)
