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

RELAXING = ("fe_rigid", "lattice_fsi", "lattice_fe_normal", "lattice_fe_shear", "lattice_fe_beam")
"""Methods that follow the matrix's moduli in time."""

FINITE_STRAIN = ("fe_elastic", *LATTICES[:-1])
"""Methods at finite strain."""

LOWEST = 1e-2
"""Least share of the shear modulus to which the matrix may relax under a constant bulk modulus."""
