"""Particles in a matrix as a three-dimensional solid.

A mesh is made by `sphere_mesh` (sizes: `size_field`; shape: `tets`; higher orders: `raise_order`).
On it `elastic` solves for elastic particles, `rigid` condenses the matrix to the motions of rigid
ones, `finite_strain` goes beyond small displacements, `moduli` serves all moduli of the matrix from
few solutions. Beneath are the element matrices (`elements`, `neo_hookean`), their assembly
(`stiffness`) and the preconditioner (`multigrid`). `layer_cells`, `layer_springs` and `wall_margin`
derive from small cells what a lattice of bonds lacks.
"""
