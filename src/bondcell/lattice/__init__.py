"""Lattices of bonded spheres: packings, bonds as springs between rigid bodies, their solution."""
