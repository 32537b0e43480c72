"""The bond cell: two spheres bonded through a matrix, as arrays that broadcast together."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from bondcell.errors import InputError, Violation

FloatArray = NDArray[np.float64]

REQUIRED = ("radius_i", "gap", "young_i", "young_m", "poisson_i", "poisson_m")
"""Inputs without a default."""

GEOMETRY = ("radius_i", "radius_j", "gap", "cylinder_radius")
"""Inputs that fix the mesh: points that share them share every assembled operator."""

UNITS = {
    "radius_i": "m",
    "radius_j": "m",
    "gap": "m",
    "cylinder_radius": "m",
    "young_i": "Pa",
    "young_j": "Pa",
    "young_m": "Pa",
    "poisson_i": "1",
    "poisson_j": "1",
    "poisson_m": "1",
}
"""Unit of each input."""

LONG_NAMES = {
    "radius_i": "radius of particle i",
    "radius_j": "radius of particle j",
    "gap": "shortest distance between the particles",
    "cylinder_radius": "radius of the representative volume",
    "young_i": "Young's modulus of particle i",
    "young_j": "Young's modulus of particle j",
    "young_m": "Young's modulus of the matrix",
    "poisson_i": "Poisson's ratio of particle i",
    "poisson_j": "Poisson's ratio of particle j",
    "poisson_m": "Poisson's ratio of the matrix",
}
"""Meaning of each input."""


@dataclass(frozen=True)
class Cell:
    """Inputs of one or many bond cells (theory: section "The bond cell"), SI units.

    All fields are float arrays that broadcast against each other. Build one with
    `Cell.from_values`, which fills the defaults and checks every value.

    Examples
    --------
    >>> cell = Cell.from_values(
    ...     radius_i=7.5e-3,
    ...     gap=[5e-4, 1e-3],
    ...     young_i=3e10,
    ...     young_m=1.4e6,
    ...     poisson_i=0.25,
    ...     poisson_m=0.46,
    ... )
    >>> cell.shape
    (2,)
    >>> cell.length
    array([0.0155, 0.016 ])
    """

    radius_i: FloatArray
    radius_j: FloatArray
    gap: FloatArray
    cylinder_radius: FloatArray
    young_i: FloatArray
    young_j: FloatArray
    young_m: FloatArray
    poisson_i: FloatArray
    poisson_j: FloatArray
    poisson_m: FloatArray

    @classmethod
    def from_values(cls, **values: ArrayLike) -> Cell:
        """Fill defaults, check, and convert to arrays.

        Parameters
        ----------
        **values
            The names of `UNITS`; `REQUIRED` ones must be there. Defaults: particle j like
            particle i, ``cylinder_radius = max(radius_i, radius_j)``. ``young_i = inf`` is a
            rigid particle.

        Raises
        ------
        InputError
            Names every missing, unknown, non-numeric and out-of-range value at once.
        """
        arrays, violations = _as_arrays(values)
        for name, value in arrays.items():
            violations += _range_violations(name, value)
        violations += [
            Violation(name, None, "a number: the value is required")
            for name in REQUIRED
            if name not in values
        ]
        violations += _shape_violations(arrays) or _cylinder_violations(arrays)
        if violations:
            raise InputError(violations)
        arrays.setdefault("radius_j", arrays["radius_i"])
        arrays.setdefault("young_j", arrays["young_i"])
        arrays.setdefault("poisson_j", arrays["poisson_i"])
        largest = np.maximum(arrays["radius_i"], arrays["radius_j"])
        arrays.setdefault("cylinder_radius", largest)
        return cls(**arrays)

    @property
    def shape(self) -> tuple[int, ...]:
        """Broadcast shape of all fields."""
        return np.broadcast_shapes(*(value.shape for value in self.as_dict().values()))

    @property
    def length(self) -> FloatArray:
        """Length of the cylinder, ``R_i + R_j + L_g`` [m]."""
        return self.radius_i + self.radius_j + self.gap

    def as_dict(self) -> dict[str, FloatArray]:
        """The fields by name."""
        return {field.name: getattr(self, field.name) for field in fields(self)}

    def ravel(self) -> Cell:
        """All fields broadcast to the common shape and flattened."""
        shape = self.shape
        return Cell(**{k: np.broadcast_to(v, shape).ravel() for k, v in self.as_dict().items()})

    def take(self, index: Any) -> Cell:
        """The points ``index`` of a raveled cell."""
        return Cell(**{name: value[index] for name, value in self.as_dict().items()})

    def swapped(self) -> Cell:
        """The same cells with particles i and j exchanged."""
        return Cell(
            radius_i=self.radius_j,
            radius_j=self.radius_i,
            gap=self.gap,
            cylinder_radius=self.cylinder_radius,
            young_i=self.young_j,
            young_j=self.young_i,
            young_m=self.young_m,
            poisson_i=self.poisson_j,
            poisson_j=self.poisson_i,
            poisson_m=self.poisson_m,
        )


def _as_arrays(values: Mapping[str, ArrayLike]) -> tuple[dict[str, FloatArray], list[Violation]]:
    arrays: dict[str, FloatArray] = {}
    violations = []
    for name, value in values.items():
        if name not in UNITS:
            violations.append(Violation(name, value, f"one of the inputs {', '.join(UNITS)}"))
            continue
        try:
            raw = np.asarray(value)
        except ValueError:  # a ragged nest of lists
            raw = np.empty((), dtype=object)
        if raw.dtype.kind not in "iuf":
            violations.append(Violation(name, value, f"numbers [{UNITS[name]}]"))
        elif not raw.size:
            violations.append(Violation(name, value, "at least one number"))
        else:
            arrays[name] = raw.astype(np.float64)
    return arrays, violations


def _range_violations(name: str, value: FloatArray) -> list[Violation]:
    """What is wrong with one input on its own."""
    if name in GEOMETRY or name == "young_m":
        good, allowed = np.isfinite(value) & (value > 0), f"(0, inf) {UNITS[name]}, finite"
    elif name in ("young_i", "young_j"):
        good, allowed = value > 0, "(0, inf] Pa, inf for a rigid particle"
    else:
        good, allowed = (value > -1) & (value <= 0.5), "(-1, 0.5]"
    return _violations(name, value[~good], allowed)


def _shape_violations(arrays: Mapping[str, FloatArray]) -> list[Violation]:
    try:
        np.broadcast_shapes(*(value.shape for value in arrays.values()))
    except ValueError:
        shapes = ", ".join(f"{name} {value.shape}" for name, value in arrays.items() if value.ndim)
        return [Violation("shapes", shapes, "shapes that broadcast against each other")]
    return []


def _cylinder_violations(arrays: Mapping[str, FloatArray]) -> list[Violation]:
    """Cylinders thinner than a particle; values that are wrong by themselves are not repeated."""
    if "cylinder_radius" not in arrays:
        return []
    radius = arrays["cylinder_radius"]
    largest = np.zeros(())
    for name in ("radius_i", "radius_j"):
        given = arrays.get(name, np.zeros(()))
        largest = np.maximum(largest, np.where(np.isfinite(given), given, 0.0))
    radius, largest = np.broadcast_arrays(radius, largest)
    bad = (radius > 0) & (radius < largest)
    if not bad.any():
        return []
    allowed = f"[max(radius_i, radius_j), inf) m, here at least {float(largest[bad][0])} m"
    return _violations("cylinder_radius", radius[bad], allowed)


def _violations(name: str, bad: FloatArray, allowed: str) -> list[Violation]:
    """One complaint about the first of the bad values, none if there are none."""
    if not bad.size:
        return []
    more = f" ({bad.size} such values)" if bad.size > 1 else ""
    return [Violation(name, float(bad[0]), allowed + more)]
