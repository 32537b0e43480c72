"""Numbers and texts with units: what is read, to the last bit, and what is refused."""

import contextlib
import math
import subprocess
import sys
from decimal import Decimal

import pint
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bondcell.scenes.quantities import PREFIXES, NotAllowed, parse_quantity


@pytest.mark.parametrize(
    ("text", "unit", "value"),
    [
        ("0.5 mm", "m", 5e-4),
        ("0.3 mm", "m", 3e-4),
        ("0.3mm", "m", 3e-4),
        (" 7.5  mm ", "m", 7.5e-3),
        ("7.5 um", "m", 7.5e-6),
        ("7.5 µm", "m", 7.5e-6),
        ("1 inch", "m", 0.0254),
        ("-1 mm", "m", -1e-3),
        ("1e-3", "m", 1e-3),
        ("+1.E-3", "m", 1e-3),
        (".5e0 cm", "m", 5e-3),
        ("1.4 MPa", "Pa", 1.4e6),
        ("30 GPa", "Pa", 3e10),
        ("1.4 N/mm^2", "Pa", 1.4e6),
        ("1.4 N/mm**2", "Pa", 1.4e6),
        ("1.4 N mm^-2", "Pa", 1.4e6),
        ("1.4 N/mm²", "Pa", 1.4e6),
        ("14 bar", "Pa", 1.4e6),
        ("46 %", "1", 0.46),
        ("46 percent", "1", 0.46),
        ("0.46", "1", 0.46),
        (7, "m", 7.0),
        (0, "1", 0.0),
    ],
)
def test_value_in_si(text, unit, value):
    assert parse_quantity(text, unit) == value


@pytest.mark.parametrize("unit", ["m", "Pa", "s"])
def test_prefixes_are_those_of_the_library_of_units(unit):
    registry = pint.UnitRegistry(non_int_type=Decimal)
    for prefix in PREFIXES:
        size, _ = registry.get_base_units(registry.parse_units(f"{prefix}{unit}"))
        of_unit, _ = registry.get_base_units(registry.parse_units(unit))
        assert parse_quantity(f"7.3 {prefix}{unit}", unit) == float(
            Decimal("7.3") * Decimal(str(size)) / Decimal(str(of_unit))
        )


@pytest.mark.parametrize("text", ["rigid", "Rigid", ".inf", "inf", math.inf])
def test_rigid_is_infinite_only_where_asked_for(text):
    assert parse_quantity(text, "Pa", allow_infinite=True) == math.inf
    with pytest.raises(NotAllowed):
        parse_quantity(text, "Pa")


@pytest.mark.parametrize("value", ["-inf", -math.inf, math.nan, "nan", ".nan", "1e999 Pa"])
def test_only_plus_infinity_is_rigid(value):
    with pytest.raises(NotAllowed):
        parse_quantity(value, "Pa", allow_infinite=True)


@pytest.mark.parametrize(
    "value",
    [
        True,
        False,
        None,
        "",
        " ",
        "mm",
        "abc",
        "yes",
        [],
        {},
        [1],
        b"1",
        1j,
        "0,5 mm",
        "1_000 mm",
        "0x10",
        "1 2",
        "1 mm 2",
        "2*3 mm",
        "2 * mm",
        "1/2 mm",
        "1 mm + 1 mm",
        "(1 mm)",
        "5 kg",
        "5 s",
        "5 MPa",
        "5 %",
        "5 m^2",
        "5 m^0",
        "5 1/m",
        "5 m/rad",
        "5 m/pi",
        "5 mpa",
        "5 degC",
        "5 dB",
        "5 furlongs_per",
        "5 nan",
        "__import__('os')",
        "5 __class__",
        "٣ mm",
        "5 " + "m" * 80,
        "1" * 5000,
        10**400,
        "1e999 km",
        1e308 * 10,
    ],
)
def test_refused_as_a_length(value):
    with pytest.raises(NotAllowed, match=r"\[m\]"):
        parse_quantity(value, "m")


@pytest.mark.parametrize("value", ["0.3 mm", "0.3 rad", "0.1 pi", "3 dB", "46 ppm %"])
def test_dimensionless_takes_no_unit_but_per_cent(value):
    with pytest.raises(NotAllowed, match="without unit"):
        parse_quantity(value)


@given(st.floats(allow_nan=False, allow_infinity=False))
def test_numbers_as_text_keep_every_bit(number):
    assert parse_quantity(repr(number), "m") == number
    assert parse_quantity(number, "m") == number


@settings(deadline=None)  # the first unit loads its library
@given(st.decimals(min_value=-1000, max_value=1000, places=6))
def test_millimetres_round_once(number):
    assert parse_quantity(f"{number:f} mm", "m") == float(f"{number:f}e-3")


@settings(deadline=None)  # the first unit loads its library
@given(st.text(max_size=70))
def test_no_text_does_anything_but_parse_or_be_refused(text):
    with contextlib.suppress(NotAllowed):
        assert math.isfinite(parse_quantity(text, "m"))


@settings(deadline=None)  # the first unit loads its library
@given(
    st.floats(0.1, 10),
    st.text("mMkgPasNµ/^*²-123 %eiI_()", max_size=12),
    st.sampled_from(["m", "Pa", "1"]),
)
def test_no_unit_does_anything_but_parse_or_be_refused(number, unit, wanted):
    with contextlib.suppress(NotAllowed):
        assert math.isfinite(parse_quantity(f"{number} {unit}", wanted))


def test_units_library_is_loaded_at_the_first_unit_only():
    code = (
        "import sys; from bondcell.scenes.quantities import parse_quantity as p;"
        "p(1.0, 'm'); p('1e-3', 'm'); p('46 %'); p('rigid', 'Pa', allow_infinite=True);"
        "p('1 mm', 'm'); assert 'pint' not in sys.modules;"
        "p('1 inch', 'm'); assert 'pint' in sys.modules"
    )
    subprocess.run([sys.executable, "-c", code], check=True)
