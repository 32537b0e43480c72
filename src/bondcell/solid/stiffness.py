"""Assembly of the elastic stiffness, fine and coarse, chunk by chunk."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np
from scipy.sparse import bsr_array

from bondcell.cell import FloatArray
from bondcell.errors import InputError, Violation
from bondcell.fem.blocks import BlockAssembler, IndexArray
from bondcell.solid.elements import (
    QUADRATURE,
    element_matrices,
    lattice_of,
    order_of,
    physical_gradients,
    quadrature,
    shape_gradients,
)
from bondcell.solid.tets import MATRIX, Tets

CHUNK = 1_800_000
"""Entries of the element matrices held at once: small enough for the processor's cache."""


LocalMatrices = Callable[[IndexArray, FloatArray, FloatArray], FloatArray]
"""Positions of elements, gradients and weights -> element matrices, node by node."""


@dataclass(frozen=True)
class Elastic:
    """Isotropic elastic constants.

    Parameters
    ----------
    young
        Young's modulus [Pa].
    poisson
        Poisson's ratio, in (-1, 0.5).

    Raises
    ------
    InputError
        A constant is outside its range.
    """

    young: float
    poisson: float

    def __post_init__(self) -> None:
        violations = []
        if not 0 < self.young < np.inf:
            violations.append(Violation("young", self.young, "(0, inf) Pa"))
        if not -1 < self.poisson < 0.5:
            violations.append(Violation("poisson", self.poisson, "(-1, 0.5)"))
        if violations:
            raise InputError(violations)

    @property
    def lame(self) -> tuple[float, float]:
        """``lambda`` and ``mu`` [Pa]."""
        mu = self.young / (2 * (1 + self.poisson))
        return 2 * mu * self.poisson / (1 - 2 * self.poisson), mu

    @property
    def bulk(self) -> float:
        """Bulk modulus [Pa]."""
        return self.young / (3 * (1 - 2 * self.poisson))


@dataclass(frozen=True)
class Stiffness:
    """Stiffness of tetrahedra and of the first-order ones in them.

    Parameters
    ----------
    fine
        On all nodes; unknown ``3 n + c`` is component c of node n.
    coarse
        Its Galerkin projection on the linear functions of the corners.
    """

    fine: bsr_array
    coarse: bsr_array


def assemble(mesh: Tets, matrix: Elastic, particle: Elastic | None) -> Stiffness:
    """Assemble the stiffness.

    Parameters
    ----------
    mesh
        The mesh.
    matrix, particle
        Materials; without ``particle`` only the matrix material is assembled.
    """
    elements = np.arange(len(mesh.nodes))
    lam, mu = np.empty((2, elements.size))
    inside = mesh.material != MATRIX
    lam[~inside], mu[~inside] = matrix.lame
    if particle is None:
        elements = elements[~inside]
    else:
        lam[inside], mu[inside] = particle.lame
    return assemble_elements(mesh, elements, lam[elements], mu[elements])


def assemble_elements(
    mesh: Tets, elements: IndexArray, lam: FloatArray, mu: FloatArray
) -> Stiffness:
    """Assemble some elements with their Lame's constants [Pa], shape (elements,)."""

    def local(own: IndexArray, gradients: FloatArray, volumes: FloatArray) -> FloatArray:
        return element_matrices(gradients, volumes, lam[own], mu[own])

    return assemble_local(mesh, elements, local)


def assemble_local(mesh: Tets, elements: IndexArray, local: LocalMatrices) -> Stiffness:
    """Assemble element matrices of any origin, fine and coarse."""
    nodes = mesh.nodes[elements]
    fine = BlockAssembler(nodes, len(mesh.points), 3)
    coarse = BlockAssembler(nodes[:, :4], mesh.corners, 3)
    for own, gradients, volumes in chunks(mesh, elements):
        matrices = local(own, gradients, volumes)
        fine.add(own, matrices)
        coarse.add(own, coarsened(matrices))
    return Stiffness(fine.matrix(), coarse.matrix())


def chunks(mesh: Tets, elements: IndexArray) -> Iterator[tuple[IndexArray, FloatArray, FloatArray]]:
    """Some elements at a time: where they are in ``elements``, gradients and weights there.

    Gradients have the shape (chunk, points, nodes, 3), weights (chunk, points).
    """
    order = mesh.order
    size = max(1, CHUNK // (3 * mesh.nodes.shape[1]) ** 2)
    curved = mesh.is_curved[elements]
    straight_rule, curved_rule = QUADRATURE[order]
    for group, rule in ((curved, curved_rule), (~curved, straight_rule)):
        every = np.flatnonzero(group)
        points, weights = quadrature(rule)
        reference = shape_gradients(points, order)
        for start in range(0, every.size, size):
            own = every[start : start + size]
            corners = mesh.points[mesh.nodes[elements[own]]]
            yield own, *physical_gradients(corners, reference, weights)


def coarsened(local: FloatArray) -> FloatArray:
    """Element matrices on the four corners, shape (elements, 12, 12), of those on all nodes."""
    order = order_of(local.shape[1] // 3)
    wide = np.kron(lattice_of(order) / order, np.eye(3))
    return np.asarray(wide.T @ local @ wide)
