"""What no loading can fall below: energy over displacement norm."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from bondcell.cell import FloatArray
from bondcell.lattice.lattice import Lattice


def softest(stiffness: FloatArray, translations: NDArray[np.bool_]) -> float:
    """Smallest ``2 U / n^2`` that any displacement of the particles can have [N/m].

    Parameters
    ----------
    stiffness
        Of all free unknowns, shape (unknowns, unknowns).
    translations
        Which of them are displacements of particles, shape (unknowns,); the others give way.

    Notes
    -----
    With the others eliminated, ``2 U = n.S.n >= lambda_min(S) |n|^2``, whatever the loading.
    """
    inner = stiffness[translations][:, translations]
    if not translations.all():
        mixed = stiffness[~translations][:, translations]
        inner = inner - mixed.T @ np.linalg.solve(stiffness[~translations][:, ~translations], mixed)
    return float(np.linalg.eigvalsh((inner + inner.T) / 2)[0])


def softest_lattice(lattice: Lattice, fixed: NDArray[np.int64]) -> float:
    """`softest` of a lattice whose nodes ``fixed`` are held.

    Examples
    --------
    The paper's own lattice is four times too stiff for its printed pair:

    >>> from bondcell.specimen.bonds import Material
    >>> from bondcell.specimen.lattice_variants import specimen_lattice
    >>> paper = specimen_lattice("lattice_paper", Material(), "free")
    >>> round(softest_lattice(paper.lattice, paper.fixed))
    20887
    """
    free = np.ones((lattice.count, lattice.width), dtype=bool)
    free[fixed] = False
    moves = np.zeros_like(free)
    moves[:, : lattice.dimension] = True
    chosen = free.ravel()
    dense = lattice.matrix().toarray()[chosen][:, chosen]
    return softest(dense, moves.ravel()[chosen])
