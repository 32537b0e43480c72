"""Names that the specimen's results go by."""

from __future__ import annotations

SOLIDS = ("fe_rigid", "fe_elastic")
"""The three-dimensional solid, with rigid and with elastic particles."""

LATTICES = (
    "lattice_paper",
    "lattice_fsi",
    "lattice_film",
    "lattice_fe_normal",
    "lattice_fe_shear",
    "lattice_fe_beam",
    "lattice_full",
)
"""Lattices, from the paper's to the one with pockets."""

METHODS = (*SOLIDS, *LATTICES)
"""Ways to answer."""

LOADINGS = {"horizontal": (1.0, 0.0), "vertical": (0.0, 1.0)}
"""Directions in which particles 1 to 3 are displaced."""

WALLS = ("free", "fixed")
"""The sides of the box."""

DIRECTIONS = {"+x": (1.0, 0.0), "-x": (-1.0, 0.0), "+y": (0.0, 1.0), "-y": (0.0, -1.0)}
"""Ways in which particles 1 to 3 are displaced at finite strain."""

AXES = {
    "method": {"long_name": "lattice or solid that answers"},
    "loading": {"long_name": "direction in which particles 1 to 3 are displaced"},
    "walls": {"long_name": "the sides of the box"},
    "particle": {"units": "1", "long_name": "number of the particle, rows from the top left"},
    "component": {"long_name": "component of a vector"},
    "mode": {"long_name": "part of a lattice's energy"},
    "per_gap": {"units": "1", "long_name": "element size per gap"},
    "order": {"units": "1", "long_name": "order of the displacements"},
    "force": {"long_name": "part of a bond's force: forces in N, the moment in N m"},
    "direction": {"long_name": "direction of the displacement at finite strain"},
    "end": {"long_name": "which of two"},
}
"""Dimensions of the results -> their attributes."""

RELAXING = ("fe_rigid", "lattice_fsi", "lattice_fe_normal", "lattice_fe_shear", "lattice_fe_beam")
"""Methods that follow the matrix's moduli in time."""

FINITE_STRAIN = ("fe_elastic", *LATTICES[:-1])
"""Methods at finite strain."""

LOWEST = 1e-2
"""Least share of the shear modulus to which the matrix may relax under a constant bulk modulus."""
