"""What may be asked of the finite element reference, known without importing it."""

from __future__ import annotations

BOUNDARY_CONDITIONS = ("roller", "clamped", "confined")
"""Boundary conditions of the normal load, the default first."""

TOLERANCES = (1e-12, 0.1)
"""Closed interval of the relative error that may be asked for."""

TOLERANCE_RANGE = f"a number in [{TOLERANCES[0]:g}, {TOLERANCES[1]:g}]"
"""The same in words."""

DEFAULT_TOLERANCE = 1e-6
"""Relative error asked for where nothing is said."""
