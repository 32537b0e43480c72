"""Particles in a matrix as a three-dimensional solid: curved tetrahedra, multigrid."""
