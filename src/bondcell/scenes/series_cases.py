"""Series of a scene one by one, and generated ones: all combinations of a few numbers."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import product
from typing import Annotated, Any

import numpy as np
from pydantic import AfterValidator, Field

from bondcell.scenes.fields import Block, distinct, number_between, one_of, whole_number_between
from bondcell.scenes.time_fields import MOST_TERMS, Time

PROFILES = ("even", "falling", "rising")
"""Weights of a generated series over its times."""

DECADES = (0.0, 50.0)
"""Spread of the times of a generated series."""

Profile = Annotated[
    str, one_of(lambda: PROFILES), Field(json_schema_extra={"enum": list(PROFILES)})
]
_Listed = Field(json_schema_extra={"minItems": 1, "uniqueItems": True})


class SeriesCase(Block):
    """One series of a scene, relative to the moduli that `relative_to` says.

    Parameters
    ----------
    name
        Label in the dimension ``series``.
    weights, times, relative_to
        Terms; times hold at `reference` where there is a shift with temperature.
    kind
        ``generated``, ``inline``, or the kind of the material.
    profile
        Of a generated series.
    decades
        Logarithm of the largest over the smallest time.
    material, temperature, young
        Of a named material: its name, temperature [K] and modulus at t = 0 [Pa].
    """

    name: str
    weights: tuple[float, ...]
    times: tuple[float, ...]
    relative_to: str = "instantaneous"
    kind: str = "inline"
    profile: str = ""
    material: str = ""
    temperature: float | None = None
    young: float | None = None

    @property
    def decades(self) -> float:
        """Logarithm of the largest over the smallest time."""
        return float(np.log10(max(self.times)) - np.log10(min(self.times)))

    @property
    def relaxing_share(self) -> float:
        """Share of the modulus at t = 0 that relaxes."""
        whole = float(np.sum(self.weights))
        return whole / (1 + whole) if self.relative_to == "long_term" else whole


class Spectrum(Block):
    """Generated series, all combinations of the lists."""

    terms: Annotated[
        tuple[Annotated[int, whole_number_between(1, MOST_TERMS)], ...],
        AfterValidator(distinct),
        _Listed,
    ] = Field(description=f"Numbers of terms, [1, {MOST_TERMS}].")
    decades: Annotated[
        tuple[Annotated[float, number_between(*DECADES)], ...], AfterValidator(distinct), _Listed
    ] = Field(description="Spreads of the times: decades from the smallest to the largest.")
    relaxing: Annotated[
        tuple[Annotated[float, number_between(0, 1)], ...], AfterValidator(distinct), _Listed
    ] = Field((0.99,), description="Shares of the modulus at t = 0 that relax; 1 is a fluid.")
    profile: Annotated[tuple[Profile, ...], AfterValidator(distinct), _Listed] = Field(
        ("even",),
        description="Weights of the terms: even, falling or rising (linearly) towards long times.",
    )
    centre: Time = Field(1.0, description="Geometric mean of the times [s].")

    def cases(self) -> Iterator[SeriesCase]:
        """The series, each number of terms with each spread, share and profile."""
        for terms, decades, share, profile in product(
            self.terms, self.decades, self.relaxing, self.profile
        ):
            end = "" if len(self.profile) == 1 else f"_{profile}"
            half = decades / 2 if terms > 1 else 0.0
            times = self.centre * np.logspace(-half, half, terms)
            yield SeriesCase(
                name=f"n{terms}_d{decades:g}_r{share:g}{end}",
                weights=tuple((share * _profile(profile, terms)).tolist()),
                times=tuple(times.tolist()),
                kind="generated",
                profile=profile,
            )


def _profile(name: str, terms: int) -> Any:
    """Weights that add up to 1."""
    rank = np.arange(1.0, terms + 1)
    weights = {"even": np.ones(terms), "falling": rank[::-1], "rising": rank}[name]
    return weights / weights.sum()
