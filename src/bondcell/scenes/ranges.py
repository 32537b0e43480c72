"""Ranges of values: what lies between two ends, and evenly spaced values from one to the other."""

from __future__ import annotations

from typing import Annotated, Literal, Self

import numpy as np
from pydantic import Field, model_validator

from bondcell.cell import FloatArray
from bondcell.scenes.fields import (
    Block,
    Length,
    Modulus,
    PoissonRatio,
    Ratio,
    whole_number_between,
)
from bondcell.scenes.quantities import NotAllowed
from bondcell.scenes.spread import check_apart, spread

MOST_POINTS = 10_000_000
"""Largest number of points in a sweep."""

_start = Field(description="First value.")
_stop = Field(description="Last value.")
_points = Field(
    description="Number of values, the ends included.",
    json_schema_extra={"minimum": 2, "maximum": MOST_POINTS},
)


class Span(Block):
    """Whatever lies between start and stop."""

    start: float = _start
    stop: float = _stop
    spacing: Literal["lin", "log"] = Field(
        "lin", description="lin: evenly in the value; log: in its logarithm (both above 0)."
    )

    @model_validator(mode="after")
    def _check_ends(self) -> Self:
        if self.start == self.stop:
            raise NotAllowed("a stop that differs from start; for one value write a list")
        if self.spacing == "log" and not (self.start > 0 and self.stop > 0):
            raise NotAllowed("start and stop above 0 where spacing is log")
        return self

    def at(self, shares: FloatArray) -> FloatArray:
        """Values at shares of the way from start to stop, 0 to 1."""
        if self.spacing == "log":
            raw = np.exp((1 - shares) * np.log(self.start) + shares * np.log(self.stop))
        else:
            raw = self.start + shares * (self.stop - self.start)
        return np.clip(raw, min(self.start, self.stop), max(self.start, self.stop))


class Range(Span):
    """Values from start to stop, both included."""

    points: Annotated[int, whole_number_between(2, MOST_POINTS)] = _points

    @model_validator(mode="after")
    def _check_steps(self) -> Self:
        check_apart(self.start, self.stop, self.points)
        return self

    def values(self) -> FloatArray:
        """The values, the ends included; read-only."""
        return spread(self.start, self.stop, self.points, self.spacing)


class LengthSpan(Span):
    """Lengths between start and stop."""

    start: Length = _start
    stop: Length = _stop


class LengthRange(LengthSpan, Range):
    """Lengths from start to stop, both included."""


class ModulusSpan(Span):
    """Moduli between start and stop."""

    start: Modulus = _start
    stop: Modulus = _stop


class ModulusRange(ModulusSpan, Range):
    """Moduli from start to stop, both included."""


class PoissonSpan(Span):
    """Poisson's ratios between start and stop."""

    start: PoissonRatio = _start
    stop: PoissonRatio = _stop


class PoissonRange(PoissonSpan, Range):
    """Poisson's ratios from start to stop, both included."""


class RatioSpan(Span):
    """Ratios between start and stop."""

    start: Ratio = _start
    stop: Ratio = _stop


class RatioRange(RatioSpan, Range):
    """Ratios from start to stop, both included."""
