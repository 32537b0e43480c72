"""Motions that nothing in a lattice resists: found and named before it is solved."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import bsr_array, csr_array
from scipy.sparse.csgraph import connected_components

from bondcell.cell import FloatArray
from bondcell.errors import InputError, Violation
from bondcell.fem.blocks import block_diagonal
from bondcell.lattice.lattice import Lattice
from bondcell.lattice.rigid_modes import rigid_modes

EXHAUSTIVE = 1500
"""Unknowns up to which every mechanism is found, by eigenvalues; beyond, those named below."""

MOST_LISTED = 20
"""Mechanisms named one by one; what is beyond is counted."""

_ZERO = 1e-11
_NODES_NAMED = 8


def check_supported(lattice: Lattice, matrix: bsr_array, held: NDArray[np.bool_]) -> None:
    """Refuse a lattice that can move freely.

    Parameters
    ----------
    lattice, matrix
        The lattice and its stiffness matrix.
    held
        Prescribed unknowns, shape (nodes, width).

    Raises
    ------
    InputError
        Names every free mechanism: the nodes that move and how.

    Notes
    -----
    Nodes without resistance of their own and parts whose supports leave a rigid motion free are
    found in any lattice. Mechanisms inside a part (hinged chains) are null vectors of the
    stiffness matrix; they are sought up to `EXHAUSTIVE` unknowns.
    """
    violations = _loose_nodes(lattice, matrix, held) + _free_parts(lattice, held)
    if not violations and np.count_nonzero(~held) <= EXHAUSTIVE:
        violations = _null_vectors(lattice, matrix, held)
    if len(violations) > MOST_LISTED:
        rest = Violation("and more", len(violations) - MOST_LISTED, "none")
        violations = [*violations[:MOST_LISTED], rest]
    if violations:
        raise InputError(violations)


def _loose_nodes(lattice: Lattice, matrix: bsr_array, held: NDArray[np.bool_]) -> list[Violation]:
    """Nodes that can move alone, while all others stand still."""
    free = (~held).astype(np.float64)
    blocks = block_diagonal(matrix) * free[:, :, np.newaxis] * free[:, np.newaxis]
    blocks += held[:, :, np.newaxis] * np.eye(lattice.width)
    size = np.sqrt(np.einsum("nii->ni", blocks))
    # A force on its own and one in equilibrium with others differ in unit: compare without units.
    scale = np.where(size > 0, size, 1.0)
    values, vectors = np.linalg.eigh(blocks / scale[:, :, np.newaxis] / scale[:, np.newaxis])
    return [
        _violation(lattice, np.array([node]), (vectors[node, :, k] / scale[node])[np.newaxis])
        for node, k in np.argwhere(values < _ZERO).tolist()
    ]


def _free_parts(lattice: Lattice, held: NDArray[np.bool_]) -> list[Violation]:
    """Parts of several nodes that nothing joins to a support, or that can move as a whole."""
    part, count = _parts(lattice)
    members = np.bincount(part, minlength=count)
    middle = np.stack([np.bincount(part, x) / members for x in lattice.points.T], axis=1)
    modes = rigid_modes(lattice.points, lattice.rotates)
    modes = _recentred(lattice, modes, middle[part] - lattice.points.mean(axis=0))
    supported = held | lattice.grounded()
    size = modes.shape[2]
    resisted, moved = np.zeros((2, count, size, size))
    for c in range(lattice.width):
        rows = modes[:, c, :, np.newaxis] * modes[:, c, np.newaxis]
        np.add.at(moved, part, rows)
        np.add.at(resisted, part[supported[:, c]], rows[supported[:, c]])
    found = []
    scale = np.sqrt(np.maximum(np.einsum("pii->pi", moved), np.finfo(float).tiny))
    pair = scale[:, :, np.newaxis] * scale[:, np.newaxis]
    lowest = np.linalg.eigvalsh(resisted / pair)[:, 0]
    for k in np.flatnonzero((lowest < _ZERO) & (members > 1)).tolist():
        weight, basis = np.linalg.eigh(moved[k] / pair[k])
        basis = basis[:, weight > _ZERO]
        values, vectors = np.linalg.eigh(basis.T @ (resisted[k] / pair[k]) @ basis)
        nodes = np.flatnonzero(part == k)
        for motion in (basis @ vectors[:, values < _ZERO]).T / scale[k]:
            found.append(_violation(lattice, nodes, modes[nodes] @ motion, "as one body"))
    return found


def _parts(lattice: Lattice) -> tuple[NDArray[np.int64], int]:
    """Number of the connected part of each node, and how many there are."""
    ends = [np.stack([lattice.bonds.first, lattice.bonds.second])]
    corners = lattice.pockets.corners.T
    ends += [corners[[0, 1]], corners[[1, 2]]]
    i, j = np.concatenate(ends, axis=1)
    joined = csr_array((np.ones(i.size), (i, j)), shape=(lattice.count, lattice.count))
    count, part = connected_components(joined, directed=False)
    return part.astype(np.int64), int(count)


def _recentred(lattice: Lattice, modes: FloatArray, shift: FloatArray) -> FloatArray:
    """Rotations about each part's own middle, which lies ``shift`` from the mean of all nodes."""
    result, d = modes.copy(), lattice.dimension
    for turn in range(modes.shape[2] - d):
        if d == 2:
            result[:, 0, 2] += shift[:, 1]
            result[:, 1, 2] -= shift[:, 0]
        else:
            result[:, :3, 3 + turn] -= np.cross(np.eye(3)[turn], shift)
    return result


def _null_vectors(lattice: Lattice, matrix: bsr_array, held: NDArray[np.bool_]) -> list[Violation]:
    free = ~held.ravel()
    dense = matrix.toarray()[free][:, free]
    scale = np.sqrt(np.diag(dense))
    values, vectors = np.linalg.eigh(dense / scale / scale[:, np.newaxis])
    found = []
    for k in np.flatnonzero(values < _ZERO):
        motion = np.zeros(held.size)
        motion[free] = vectors[:, k] / scale
        rows = motion.reshape(held.shape)
        size = np.abs(rows).max(axis=1)
        nodes = np.flatnonzero(size > 1e-3 * size.max())
        found.append(_violation(lattice, nodes, rows[nodes]))
    return found


def _violation(
    lattice: Lattice, nodes: NDArray[np.int64], motion: FloatArray, how: str = ""
) -> Violation:
    """Name the nodes that move and their largest displacements or rotations."""
    d = lattice.dimension
    names = ["displacement x", "displacement y", "displacement z"][:d]
    names += ["rotation"] if d == 2 else ["rotation x", "rotation y", "rotation z"]
    arm = np.ptp(lattice.points, axis=0).max() or 1.0
    size = np.abs(motion).max(axis=0) * np.where(np.arange(lattice.width) < d, 1.0, arm)
    kinds = [name for name, s in zip(names, size, strict=False) if s > 0.01 * size.max()]
    shown = ", ".join(str(node) for node in nodes[:_NODES_NAMED])
    more = f" and {len(nodes) - _NODES_NAMED} more" if len(nodes) > _NODES_NAMED else ""
    field = f"free mechanism of node{'s' if len(nodes) > 1 else ''} {shown}{more}"
    allowed = "a motion that a bond, a ground spring or a prescribed displacement resists"
    return Violation(field, f"{', '.join(kinds)}{' ' + how if how else ''}", allowed)
