"""The paper's specimen: lattices of bonds against the three-dimensional solid."""
