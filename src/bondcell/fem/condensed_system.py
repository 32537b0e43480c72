"""A full system with the inside of its particles eliminated, once for all states of the matrix."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.sparse import csc_array, csr_array
from scipy.sparse.csgraph import connected_components

from bondcell.fem.full_system import FullSystem
from bondcell.fem.symmetric_solve import factored


def without_insides(system: FullSystem) -> FullSystem:
    """The same system on the unknowns of the matrix, interfaces included.

    Notes
    -----
    With i the unknowns that only particles have and o the others, ``P_oo - P_oi P_ii^-1 P_io``
    takes the place of the particles P. The lift moves particles rigidly, without energy.
    """
    in_matrix = np.diff(csc_array(system.shear).indptr) > 0
    in_matrix |= np.diff(csc_array(system.bulk_root).indptr) > 0
    inside = np.flatnonzero(system.free & ~in_matrix)
    if not inside.size:
        return system
    kept = np.flatnonzero(~(system.free & ~in_matrix))
    particles = csc_array(system.particles)
    condensed = particles[np.ix_(kept, kept)].tolil()
    _, part = connected_components(particles[np.ix_(inside, inside)], directed=False)
    for own in (inside[part == k] for k in np.unique(part)):
        link = csc_array(particles[np.ix_(own, kept)])
        touched = np.flatnonzero(np.diff(link.indptr) > 0)
        factors = factored(particles[np.ix_(own, own)])
        columns = link[:, touched].toarray()
        lost = columns.T @ factors.solve(columns)
        at = np.ix_(touched, touched)
        condensed[at] = condensed[at] - (lost + lost.T) / 2
    return replace(
        system,
        shear=csr_array(system.shear[np.ix_(kept, kept)]),
        bulk_root=csr_array(system.bulk_root[:, kept]),
        particles=csr_array(condensed),
        lift=system.lift[kept],
        free=system.free[kept],
    )
