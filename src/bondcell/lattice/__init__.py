"""Lattices of bonded spheres.

Begin with `packing` (spheres in a box, who is near whom), `bonds` (springs, and the motions of two
rigid bodies that strain them), `lattice` (all of it as one matrix) and `solve` (equilibrium,
energies by mode, forces); `bondcell.bonded_lattice` puts the first three together. `pockets` and
`walls` add what bonds do not know of each other. `mechanisms` names what nothing resists,
`multigrid` solves large systems, `large` follows large rotations in the plane.
"""
