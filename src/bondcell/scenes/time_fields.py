"""Types of what relaxes in parameter files: times, spans of them, temperatures, terms."""

from __future__ import annotations

import math
import re
from functools import partial
from typing import Annotated, Any, Literal, Self

from pydantic import AfterValidator, BeforeValidator, Field, WithJsonSchema, model_validator

from bondcell.cell import FloatArray
from bondcell.relaxing_ranges import FLUID, TIMES
from bondcell.scenes.fields import POSITIVE, Block, quantity_schema, whole_number_between
from bondcell.scenes.quantities import EXAMPLES, NUMBER, NotAllowed, describe, parse_quantity
from bondcell.scenes.spread import check_apart, spread

MOST_TERMS = 1000
"""Most terms of a series."""

CELSIUS = 273.15
"""Zero of the Celsius scale [K]."""

_TEMPERATURE = re.compile(rf"\s*({NUMBER})\s*(degC|°C|K)\s*")


def _time(value: Any) -> float:
    number = parse_quantity(value, "s")
    if not TIMES[0] <= number <= TIMES[1]:
        raise NotAllowed(f"{describe('s')}, in [{TIMES[0]:g}, {TIMES[1]:g}] s")
    return number


def parse_temperature(value: Any) -> float:
    """Read a temperature with its unit, in kelvin.

    Examples
    --------
    >>> parse_temperature("20 degC"), parse_temperature("300 K")
    (293.15, 300.0)
    """
    match = _TEMPERATURE.fullmatch(value) if isinstance(value, str) else None
    allowed = "a temperature above 0 K with its unit, as in 20 degC or 293.15 K"
    if match is None:
        raise NotAllowed(allowed)
    # Rounded: 20 + 273.15 is 293.15, not its neighbour.
    kelvin = round(float(match[1]) + (0.0 if match[2] == "K" else CELSIUS), 9)
    if not 0 < kelvin <= 1e6:
        raise NotAllowed(allowed)
    return kelvin


def _weight(value: Any) -> float:
    number = parse_quantity(value)
    if number < 0:
        raise NotAllowed("a number in [0, inf)")
    return number


Time = Annotated[
    float,
    BeforeValidator(_time),
    WithJsonSchema(quantity_schema("s", {"minimum": TIMES[0], "maximum": TIMES[1]})),
]
Temperature = Annotated[
    float,
    BeforeValidator(parse_temperature),
    WithJsonSchema({"type": "string", "examples": ["20 degC"]}),
]
Weight = Annotated[
    float, BeforeValidator(_weight), WithJsonSchema(quantity_schema("1", {"minimum": 0}))
]
PositiveNumber = Annotated[
    float,
    BeforeValidator(partial(parse_quantity, unit="1")),
    AfterValidator(lambda value: _above_zero(value)),
    WithJsonSchema({**quantity_schema("1", POSITIVE), "examples": [10]}),
]


def _above_zero(value: float) -> float:
    if value <= 0:
        raise NotAllowed("a number above 0")
    return value


def some_terms(values: tuple[Any, ...]) -> tuple[Any, ...]:
    """Check the number of terms."""
    if not 1 <= len(values) <= MOST_TERMS:
        raise NotAllowed(f"1 to {MOST_TERMS} values, one for each term")
    return values


class Terms(Block):
    """A Prony series: weights and times, one of each for every term."""

    weights: Annotated[tuple[Weight, ...], AfterValidator(some_terms)] = Field(
        description="Weight of each term, relative to what `relative_to` says."
    )
    times: Annotated[tuple[Time, ...], AfterValidator(some_terms)] = Field(
        description=f"Relaxation time of each term [s], as in {EXAMPLES['s']}."
    )
    relative_to: Literal["instantaneous", "long_term"] = Field(
        "instantaneous",
        description="Which modulus the weights are shares of; young_m and poisson_m of the cell "
        "are then those at t = 0, or those at the end.",
    )

    @model_validator(mode="after")
    def _check(self) -> Self:
        check_terms(self.weights, self.times, self.relative_to)
        return self


def check_terms(weights: tuple[float, ...], times: tuple[float, ...], relative_to: str) -> None:
    """Check that weights and times belong together, and that no more relaxes than there is."""
    if len(weights) != len(times):
        raise NotAllowed(f"as many times as weights: {len(times)} times, {len(weights)} weights")
    whole = math.fsum(weights)
    if relative_to == "instantaneous" and whole > 1 + FLUID:
        raise NotAllowed(f"weights that add up to at most 1; these give {whole:.17g}")


class TimeSpan(Block):
    """Times at equal ratios from start to stop, both included."""

    start: Time = Field(description="First time after 0 [s].")
    stop: Time = Field(description="Last time [s].")
    points: Annotated[int, whole_number_between(2, 10_000)] = Field(
        49, description="Number of values.", json_schema_extra={"minimum": 2, "maximum": 10_000}
    )

    @model_validator(mode="after")
    def _check(self) -> Self:
        _check_ascending(self.start, self.stop, self.points)
        return self

    def values(self) -> FloatArray:
        """The values, ascending."""
        return spread(self.start, self.stop, self.points, "log")


class FrequencySpan(Block):
    """Angular frequencies at equal ratios from start to stop, both included."""

    start: PositiveNumber = Field(description="Lowest angular frequency [rad/s], a bare number.")
    stop: PositiveNumber = Field(description="Highest angular frequency [rad/s], a bare number.")
    points: Annotated[int, whole_number_between(2, 10_000)] = Field(
        49, description="Number of values.", json_schema_extra={"minimum": 2, "maximum": 10_000}
    )

    @model_validator(mode="after")
    def _check(self) -> Self:
        _check_ascending(self.start, self.stop, self.points)
        return self

    def values(self) -> FloatArray:
        """The values, ascending."""
        return spread(self.start, self.stop, self.points, "log")


def _check_ascending(start: float, stop: float, points: int) -> None:
    if not start < stop:
        raise NotAllowed("a stop above start")
    check_apart(start, stop, points)
