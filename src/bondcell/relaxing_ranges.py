"""What series of relaxation may hold; for files and numerics alike."""

TIMES = (1e-30, 1e30)
"""Range of relaxation times [s]."""

FLUID = 4 * 2.0**-52
"""A long-term modulus below this share of the instantaneous one is the round-off of a fluid's;
weights may exceed the whole by as much."""
