"""The condensed stiffness as a function of the matrix's moduli, from few solutions."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bondcell.cell import FloatArray
from bondcell.fem.blocks import IndexArray
from bondcell.lattice.packing import Packing
from bondcell.solid.rigid import Condensed, condense
from bondcell.solid.stiffness import Elastic, assemble_elements
from bondcell.solid.tets import MATRIX, Tets

TOLERANCE = 1e-5
"""Error of each solution in the energy norm."""


def elastic_of(bulk: float, shear: float) -> Elastic:
    """Material of a bulk and a shear modulus [Pa].

    Examples
    --------
    >>> found = elastic_of(bulk=2.0, shear=1.2)
    >>> round(found.young, 12), round(found.poisson, 12)
    (3.0, 0.25)
    """
    ratio = shear / bulk
    return Elastic(9 * shear / (3 + ratio), (3 - 2 * ratio) / (6 + 2 * ratio))


@dataclass(frozen=True)
class ModuliFamily:
    """Condensed stiffness of rigid particles for any moduli of the matrix.

    Parameters
    ----------
    by_bulk, by_shear
        Stiffness of the reduced fields for a unit bulk and a unit shear modulus [m], shape
        (fields, fields); the first ones are the particles' motions.
    moving, dof, nodes
        As in `bondcell.solid.rigid.Condensed`.

    Notes
    -----
    The stiffness of the matrix is ``kappa B + mu D``. Displacements are sought among the answers at
    some ratios of the moduli: one of them for each motion, and its differences to the others, which
    keep the particles at rest and give way. A Galerkin value is never too soft.
    """

    by_bulk: FloatArray
    by_shear: FloatArray
    moving: IndexArray
    dof: int
    nodes: IndexArray

    def at(self, bulk: float, shear: float) -> Condensed:
        """Condensed stiffness at moduli of the matrix [Pa]."""
        total = bulk * self.by_bulk + shear * self.by_shear
        count = 3 * self.moving.size
        outer, mixed, inner = total[:count, :count], total[count:, :count], total[count:, count:]
        # Differences of like fields are nearly dependent: the pseudo-inverse drops those that are.
        scale = 1 / np.sqrt(np.diag(inner))
        values, vectors = np.linalg.eigh(inner * scale * scale[:, np.newaxis])
        used = values > 1e-11 * values[-1]
        parts = (vectors[:, used] / np.sqrt(values[used])).T @ (scale[:, np.newaxis] * mixed)
        stiffness = outer - parts.T @ parts
        return Condensed((stiffness + stiffness.T) / 2, self.moving, self.dof, 0, None, self.nodes)


def moduli_family(
    mesh: Tets,
    packing: Packing,
    held: NDArray[np.bool_],
    ratios: FloatArray,
    tolerance: float = TOLERANCE,
) -> ModuliFamily:
    """Solve at some ratios of the moduli.

    Parameters
    ----------
    mesh, packing, held
        As in `bondcell.solid.rigid.condense`.
    ratios
        Shear over bulk modulus, at least two; they should span what will be asked.
    tolerance
        Error of each solution in the energy norm.
    """
    found = [
        condense(mesh, packing, elastic_of(1.0, float(ratio)), held, True, tolerance)
        for ratio in ratios
    ]
    first = found[0].fields
    assert first is not None
    fields = [first]
    for other in found[1:]:
        assert other.fields is not None
        fields.append(other.fields - first)
    every = np.concatenate(fields, axis=1)
    part, nodes = mesh.part(mesh.material == MATRIX)
    elements = np.arange(len(part.nodes))
    ones = np.ones(elements.size)
    bulk = assemble_elements(part, elements, ones, 0 * ones).fine
    by_bulk = every.T @ (bulk @ every)
    del bulk
    shear = assemble_elements(part, elements, -2 / 3 * ones, ones).fine
    by_shear = every.T @ (shear @ every)
    return ModuliFamily(by_bulk, by_shear, found[0].moving, found[0].dof, nodes)
