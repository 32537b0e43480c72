"""Types of the values in a scene: what is accepted, and how the JSON schema describes it."""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from functools import partial
from typing import Annotated, Any

from pydantic import BaseModel, BeforeValidator, ConfigDict, WithJsonSchema
from pydantic.json_schema import GenerateJsonSchema, JsonSchemaValue
from pydantic_core import core_schema

from bondcell.cell import LONG_NAMES, UNITS
from bondcell.scenes.quantities import EXAMPLES, NotAllowed, parse_quantity

Schema = dict[str, Any]

NAME = re.compile(r"[a-z][a-z0-9_]{0,39}")
"""Names of scenes and of convergence cases: they become folders, file names and coordinates."""

NAME_RULE = "a name of at most 40 small letters, digits and _ that starts with a letter"

POSITIVE: Schema = {"exclusiveMinimum": 0}
POISSON: Schema = {"exclusiveMinimum": -1, "maximum": 0.5}

INTERVALS = {"m": "(0, inf) m", "Pa": "(0, inf) Pa", "1": "(-1, 0.5]"}
"""Range of the inputs of each unit, in words; the values themselves are checked by `Cell`."""

DEFAULTS = {
    "radius_j": "radius_i",
    "young_j": "young_i",
    "poisson_j": "poisson_i",
    "cylinder_radius": "max(radius_i, radius_j)",
}
"""What an input is when a scene leaves it out."""


class Block(BaseModel):
    """A mapping of a scene: immutable, no other keys than its own."""

    model_config = ConfigDict(frozen=True, extra="forbid")


class SceneSchema(GenerateJsonSchema):
    """Schema of what a file may hold: a key is there with a value, or left out."""

    def field_title_should_be_set(self, schema: Any) -> bool:
        """Whether to repeat a key as its title: never."""
        return False

    def nullable_schema(self, schema: core_schema.NullableSchema) -> JsonSchemaValue:
        """Schema of an optional key: null is not one of its values."""
        return self.generate_inner(schema["schema"])

    def default_schema(self, schema: core_schema.WithDefaultSchema) -> JsonSchemaValue:
        """Schema of a key with a default; None stands for absence and is not shown."""
        described = super().default_schema(schema)
        if described.get("default", ...) is None:
            del described["default"]
        return described


def quantity_schema(unit: str, limits: Schema, *, rigid: bool = False) -> Schema:
    """JSON schema of a number or a text with a unit.

    Parameters
    ----------
    unit
        SI unit.
    limits
        Bounds of a bare number, in the words of JSON schema.
    rigid
        Whether ``rigid`` is accepted.
    """
    units = "%|percent" if unit == "1" else "[A-Za-zµμÅ][A-Za-zµμÅ0-9²³^*/ -]*"
    pattern = rf"^\s*[-+]?[0-9.]+([eE][-+]?[0-9]+)?\s*({units})?\s*$"
    texts: list[Schema] = [{"type": "string", "pattern": pattern}]
    if rigid:
        texts.append({"enum": ["rigid"]})
    return {"anyOf": [{"type": "number", **limits}, *texts], "examples": [EXAMPLES[unit]]}


Length = Annotated[
    float,
    BeforeValidator(partial(parse_quantity, unit="m")),
    WithJsonSchema(quantity_schema("m", POSITIVE)),
]
Modulus = Annotated[
    float,
    BeforeValidator(partial(parse_quantity, unit="Pa")),
    WithJsonSchema(quantity_schema("Pa", POSITIVE)),
]
ParticleModulus = Annotated[
    float,
    BeforeValidator(partial(parse_quantity, unit="Pa", allow_infinite=True)),
    WithJsonSchema(quantity_schema("Pa", POSITIVE, rigid=True)),
]
PoissonRatio = Annotated[
    float,
    BeforeValidator(partial(parse_quantity, unit="1")),
    WithJsonSchema(quantity_schema("1", POISSON)),
]
Ratio = Annotated[
    float,
    BeforeValidator(partial(parse_quantity, unit="1")),
    WithJsonSchema({**quantity_schema("1", POSITIVE), "examples": [10]}),
]

ModulusRatio = Annotated[
    float,
    BeforeValidator(partial(parse_quantity, unit="1", allow_infinite=True)),
    WithJsonSchema({**quantity_schema("1", POSITIVE, rigid=True), "examples": [10]}),
]


def describe_input(name: str) -> str:
    """Say what an input of the cell is, with unit, range and default.

    Examples
    --------
    >>> describe_input("radius_j")
    'Radius of particle j [m], (0, inf) m; left out: radius_i.'
    """
    meaning = LONG_NAMES[name][0].upper() + LONG_NAMES[name][1:]
    rigid = ", or rigid" if name in ("young_i", "young_j") else ""
    default = f"; left out: {DEFAULTS[name]}" if name in DEFAULTS else ""
    return f"{meaning} [{UNITS[name]}], {INTERVALS[UNITS[name]]}{rigid}{default}."


def number_between(low: float, high: float) -> BeforeValidator:
    """Validate a dimensionless number of a closed interval."""

    def check(value: Any) -> float:
        allowed = f"a number in [{low:g}, {high:g}]"
        try:
            number = parse_quantity(value)
        except NotAllowed:
            raise NotAllowed(allowed) from None
        if not low <= number <= high:
            raise NotAllowed(allowed)
        return number

    return BeforeValidator(check)


def whole_number_between(low: int, high: int) -> BeforeValidator:
    """Validate a whole number of a closed interval; 1e3 is one."""

    def check(value: Any) -> int:
        allowed = f"a whole number in [{low}, {high}]"
        try:
            number = parse_quantity(value)
        except NotAllowed:
            raise NotAllowed(allowed) from None
        if not low <= number <= high or number != math.floor(number):
            raise NotAllowed(allowed)
        return int(number)

    return BeforeValidator(check)


def text_up_to(longest: int) -> BeforeValidator:
    """Validate a text that is not blank."""

    def check(value: Any) -> str:
        if not isinstance(value, str) or not value.strip() or len(value) > longest:
            raise NotAllowed(f"a text of 1 to {longest} characters")
        if not value.isascii() and value != value.encode("utf-8", "replace").decode():
            raise NotAllowed("a text without lone surrogates")
        return value.strip()

    return BeforeValidator(check)


def _flag(value: Any) -> bool:
    if not isinstance(value, bool):
        raise NotAllowed("true or false")
    return value


Flag = Annotated[bool, BeforeValidator(_flag)]


def one_of(names: Callable[[], tuple[str, ...]]) -> BeforeValidator:
    """Validate a name of a list that is looked up when it is needed."""

    def check(value: Any) -> str:
        if not isinstance(value, str) or value not in names():
            raise NotAllowed(f"one of {', '.join(names())}")
        return value

    return BeforeValidator(check)


def distinct(values: tuple[Any, ...]) -> tuple[Any, ...]:
    """Check that a list has values, each once."""
    if not values:
        raise NotAllowed("at least one value; leave the key out for none")
    seen: set[Any] = set()
    for value in values:
        if value in seen:
            raise NotAllowed(f"each value once; {value!r} is repeated")
        seen.add(value)
    return values
