"""Numbers, units and names as people read them, the same in tables, figures and on screen."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Any

SYMBOLS = {
    "modulus_ratio": "E_i/E_m",
    "gap_ratio": "L_g/R_i",
    "radius_ratio": "R_j/R_i",
    "radius_i": "R_i",
    "radius_j": "R_j",
    "gap": "L_g",
    "cylinder_radius": "R_c",
    "young_i": "E_i",
    "young_j": "E_j",
    "young_m": "E_m",
    "poisson_i": "ν_i",
    "poisson_j": "ν_j",
    "poisson_m": "ν_m",
    "time": "t",
    "temperature": "T",
}
"""Symbol of each axis, plain text."""

MEANINGS = {
    "modulus_ratio": "modulus ratio",
    "gap_ratio": "relative gap",
    "radius_ratio": "radius ratio",
    "gap": "gap",
    "radius_i": "radius of particle i",
    "radius_j": "radius of particle j",
    "cylinder_radius": "cylinder radius",
    "young_i": "modulus of particle i",
    "young_j": "modulus of particle j",
    "young_m": "modulus of the matrix",
    "poisson_i": "Poisson's ratio of particle i",
    "poisson_j": "Poisson's ratio of particle j",
    "poisson_m": "Poisson's ratio of the matrix",
}
"""What each axis is, in a few words."""

STIFFNESS_SYMBOLS = {"normal": "K_n", "shear": "K_s", "torsion": "K_t", "bending": "K_b"}
"""Symbol of the stiffness under each load."""

NAMES = {
    "fsi": "FSI (paper)",
    "general": "general",
    "generatrix": "generatrix",
    "slices": "slices",
    "film": "film",
    "parallel_bond": "parallel bond",
    "cementation": "cementation",
    "fe": "finite elements",
    "fe_roller": "finite elements (roller)",
    "fe_clamped": "finite elements (clamped)",
    "fe_confined": "finite elements (confined)",
}
"""Model names in tables and legends."""

LADDERS = {
    "structured": "structured mesh, order p",
    "structured_h": "structured mesh, order 4, size h",
    "triangles": "triangles P2, size h",
    "reduced_basis": "reduced basis, a point online",
}
"""Discretisations in tables and legends."""

METHODS = {
    "exact_series": "exact series",
    "time_stepping": "time stepping",
    "laplace_inversion": "Laplace inversion",
    "shortcut": "shortcut K(0) g(t)",
}
"""Ways to K(t) in tables and legends."""

_PREFIXES = {-12: "p", -9: "n", -6: "µ", -3: "m", 0: "", 3: "k", 6: "M", 9: "G", 12: "T"}
_PREFIXED = {"m": "m", "Pa": "Pa", "s": "s", "N m-1": "N/m", "N m rad-1": "N m/rad"}


class Printed(str):
    """A number as it is printed, that still knows its value: tables can be sorted by it."""

    value: float

    def __new__(cls, text: str, value: float) -> Printed:
        """A text with its value, in SI units or as a fraction of one."""
        made = super().__new__(cls, text)
        made.value = value
        return made


def model_name(model: str) -> str:
    """Model name for tables and legends.

    Examples
    --------
    >>> model_name("parallel_bond")
    'parallel bond'
    """
    return NAMES.get(model, model.replace("_", " "))


def model_phrase(model: str) -> str:
    """A model as it is called within a sentence.

    Examples
    --------
    >>> model_phrase("fsi"), model_phrase("slices"), model_phrase("fe")
    ('FSI', 'the slices model', 'finite elements')
    """
    if model == "fsi":
        return "FSI"
    name = model_name(model)
    return name if name.startswith("finite elements") else f"the {name} model"


def ladder_name(method: str) -> str:
    """A discretisation of a convergence study in tables and legends.

    Examples
    --------
    >>> ladder_name("structured"), ladder_name("triangles")
    ('structured mesh, order p', 'triangles P2, size h')
    """
    return LADDERS.get(method, method.replace("_", " "))


def case_name(case: str) -> str:
    """A case of a convergence study in headings.

    Examples
    --------
    >>> case_name("narrow_gap")
    'narrow gap'
    """
    return case.replace("_", " ")


def symbol(axis: str) -> str:
    """Symbol of an axis, its plain name when it has none.

    Examples
    --------
    >>> symbol("poisson_m")
    'ν_m'
    """
    return SYMBOLS.get(axis, axis.replace("_", " "))


def meaning(axis: str) -> str:
    """What an axis is, in a few words."""
    return MEANINGS.get(axis, axis.replace("_", " "))


def unit_text(unit: str) -> str:
    """A UDUNITS unit as it is printed.

    Examples
    --------
    >>> unit_text("N m-1"), unit_text("1")
    ('N/m', '')
    """
    return "" if unit in ("1", "") else _PREFIXED.get(unit, unit)


def number(value: Any, digits: int = 4) -> str:
    """A number with that many significant digits and no needless zeros.

    Examples
    --------
    >>> number(84065.1275), number(0.46), number(1e6), number(float("nan"))
    ('84070', '0.46', '1e6', '–')
    """
    if isinstance(value, str):
        return value
    return Printed(_number(float(value), digits), float(value))


def _number(value: float, digits: int) -> str:
    if math.isnan(value):
        return "–"
    if math.isinf(value):
        return "∞" if value > 0 else "−∞"
    rounded = float(f"{value:.{digits}g}")
    if rounded == 0:
        return "0"
    power = math.floor(math.log10(abs(rounded)))
    if -3 <= power < 5:
        return _trimmed(f"{rounded:.{max(0, digits - 1 - power)}f}")
    mantissa = f"{rounded:.{digits - 1}e}".split("e")[0]
    return f"{_trimmed(mantissa)}e{power}"


def quantity(value: Any, unit: str, digits: int = 4) -> str:
    """A value with its unit, prefixed so that the number is a handy one.

    Examples
    --------
    >>> quantity(5e-4, "m"), quantity(1.4e6, "Pa"), quantity(162460.7672, "N m-1")
    ('0.5 mm', '1.4 MPa', '162.5 kN/m')
    >>> quantity(0.46, "1"), quantity(float("inf"), "Pa"), quantity(7.5e-3, "m")
    ('0.46', 'rigid', '7.5 mm')
    """
    if isinstance(value, str):
        return f"{value} {unit_text(unit)}".strip()
    return Printed(_quantity(float(value), unit, digits), float(value))


def _quantity(value: float, unit: str, digits: int) -> str:
    if unit not in _PREFIXED:
        return f"{number(value, digits)} {unit_text(unit)}".strip()
    if unit == "Pa" and math.isinf(value):
        return "rigid"
    if not math.isfinite(value) or value == 0:
        return f"{number(value)} {_PREFIXED[unit]}"
    power = 3 * math.floor(math.log10(abs(value)) / 3)
    # Lengths below a millimetre are still said in millimetres down to a tenth of one.
    if unit == "s" and power > 0:  # nobody counts megaseconds
        return f"{number(value, digits)} s"
    power = -3 if unit == "m" and 1e-4 <= abs(value) < 1e-3 else min(max(power, -12), 12)
    return f"{number(value / 10.0**power, digits)} {_PREFIXES[power]}{_PREFIXED[unit]}"


def percent(value: Any, digits: int = 2, *, sign: bool = False) -> str:
    """A relative number in per cent.

    Examples
    --------
    >>> percent(-0.48258), percent(0.0401, sign=True), percent(3e-9), percent(12.0)
    ('−48 %', '+4 %', '3e-7 %', '1200 %')
    """
    value = float(value)
    if math.isnan(value):
        return Printed("–", value)
    text = number(abs(value) * 100, digits)
    mark = "−" if value < 0 else "+" if sign and value > 0 else ""
    return Printed(f"{mark}{text} %", value)


def at(axis: str, value: Any, unit: str = "1") -> str:
    """A position on an axis.

    Examples
    --------
    >>> at("gap", 5e-4, "m"), at("poisson_m", 0.46)
    ('L_g = 0.5 mm', 'ν_m = 0.46')
    """
    return f"{symbol(axis)} = {quantity(value, unit)}"


def listed(words: Iterable[str], last: str = "and") -> str:
    """Words as an enumeration.

    Examples
    --------
    >>> listed(["a"]), listed(["a", "b", "c"])
    ('a', 'a, b and c')
    """
    items = list(words)
    return items[0] if len(items) == 1 else f"{', '.join(items[:-1])} {last} {items[-1]}"


def _trimmed(text: str) -> str:
    return text.rstrip("0").rstrip(".") if "." in text else text
