"""Points that are no grid: a Latin hypercube, a Sobol' sequence, or a table of one's own."""

from __future__ import annotations

import warnings
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import BeforeValidator, Field, PrivateAttr

from bondcell.cell import FloatArray
from bondcell.scenes.fields import Block, whole_number_between
from bondcell.scenes.quantities import NotAllowed
from bondcell.scenes.ranges import (
    MOST_POINTS,
    LengthSpan,
    ModulusSpan,
    PoissonSpan,
    RatioSpan,
    Span,
)
from bondcell.scenes.sweep import describe_parameter
from bondcell.scenes.table_files import TABLE_NAME, TABLE_RULE

LARGEST_SEED = 2**32 - 1

_count = whole_number_between(1, MOST_POINTS)


def _span(name: str) -> Any:
    return Field(None, description=describe_parameter(name))


class Ranges(Block):
    """Parameters that a design fills: inputs of the cell and ratios."""

    radius_i: LengthSpan | None = _span("radius_i")
    radius_j: LengthSpan | None = _span("radius_j")
    radius_ratio: RatioSpan | None = _span("radius_ratio")
    gap: LengthSpan | None = _span("gap")
    gap_ratio: RatioSpan | None = _span("gap_ratio")
    cylinder_radius: LengthSpan | None = _span("cylinder_radius")
    young_i: ModulusSpan | None = _span("young_i")
    young_j: ModulusSpan | None = _span("young_j")
    young_m: ModulusSpan | None = _span("young_m")
    modulus_ratio: RatioSpan | None = _span("modulus_ratio")
    poisson_i: PoissonSpan | None = _span("poisson_i")
    poisson_j: PoissonSpan | None = _span("poisson_j")
    poisson_m: PoissonSpan | None = _span("poisson_m")

    def given(self) -> dict[str, Span]:
        """The ranges that were given, in a fixed order: that of the file does not matter."""
        found = {name: getattr(self, name) for name in PARAMETERS}
        return {name: span for name, span in found.items() if span is not None}


PARAMETERS = tuple(Ranges.model_fields)
"""What a design may fill, and what may stand above the columns of a table."""


def _table_name(value: Any) -> str:
    if not isinstance(value, str) or not TABLE_NAME.fullmatch(value):
        raise NotAllowed(TABLE_RULE)
    return value


def _counts(value: Any) -> Any:
    return value if isinstance(value, (list, tuple)) else (value,)


class Design(Block):
    """Points that are no grid, on the dimension ``sample`` of the results."""

    kind: Literal["sobol", "latin_hypercube"] | None = Field(
        None,
        description="sobol: a scrambled Sobol' sequence, of which more points keep the first ones; "
        "latin_hypercube: each parameter evenly filled.",
    )
    points: Annotated[
        tuple[Annotated[int, _count], ...],
        BeforeValidator(
            _counts, json_schema_input_type=Annotated[int, Field(ge=1)] | tuple[int, ...]
        ),
    ] = Field(
        (),
        description="Number of points. Of a latin_hypercube a list is the sizes of independent "
        "ones: another number at its end keeps the points of the others, a changed one does not.",
    )
    seed: Annotated[int, whole_number_between(0, LARGEST_SEED)] = Field(
        0,
        description="Seed of the random numbers.",
        json_schema_extra={"minimum": 0, "maximum": LARGEST_SEED},
    )
    ranges: Ranges | None = Field(
        None, description="Parameter -> {start, stop, spacing}; spacing lin or log."
    )
    table: Annotated[str, BeforeValidator(_table_name)] | None = Field(
        None,
        description="CSV or netCDF file beside the scene, a column or variable for each parameter; "
        "instead of all other keys.",
        json_schema_extra={"pattern": f"^{TABLE_NAME.pattern}$"},
    )

    _values: dict[str, FloatArray] | None = PrivateAttr(None)

    def set_values(self, values: dict[str, FloatArray]) -> None:
        """Give the design what its table says: name -> SI values, shape (points,)."""
        self._values = values

    def spans(self) -> dict[str, Span]:
        """The ranges by name, none of a table."""
        return self.ranges.given() if self.ranges else {}

    @property
    def is_complete(self) -> bool:
        """Whether it says enough to have points."""
        if self.table is not None:
            return bool(self._values)
        return self.kind is not None and bool(self.points) and bool(self.spans())

    @property
    def names(self) -> tuple[str, ...]:
        """Parameters that it fills, also where it is not complete."""
        return tuple(self.spans()) or tuple(self._values or ())

    @property
    def has_rigid_ratio(self) -> bool:
        """Whether a modulus ratio of its table is infinite, which a range cannot say."""
        ratios = (self._values or {}).get("modulus_ratio") if self.table else None
        return ratios is not None and bool(np.isinf(ratios).any())

    def count(self) -> int:
        """Number of points; one where they are not known."""
        if self.table is None:
            return sum(self.points) or 1
        return len(next(iter(self.values().values()), np.empty(1)))

    def values(self) -> dict[str, FloatArray]:
        """Name of a parameter -> SI values, shape (points,); made once."""
        if self._values is None:
            sampled = self.table is None and self.is_complete
            self._values = self._sampled() if sampled else {}
        return self._values

    def about(self) -> dict[str, Any]:
        """What made the points, for a result's attributes."""
        if self.table is not None:
            return {"table": self.table}
        about: dict[str, Any] = {"kind": self.kind, "points": list(self.points), "seed": self.seed}
        return about | {"ranges": {k: span.model_dump() for k, span in self.spans().items()}}

    def _sampled(self) -> dict[str, FloatArray]:
        spans = self.spans()
        shares = unit_points(self.kind, self.points, len(spans), self.seed)
        return {name: span.at(shares[:, i]) for i, (name, span) in enumerate(spans.items())}


def unit_points(
    kind: str | None, counts: tuple[int, ...], dimensions: int, seed: int
) -> FloatArray:
    """Points of a design in the unit cube.

    Parameters
    ----------
    kind
        ``sobol`` or ``latin_hypercube``.
    counts
        Number of points; of ``latin_hypercube`` the sizes of independent ones.
    dimensions
        Number of parameters.
    seed
        Seed of the random numbers.

    Returns
    -------
    numpy.ndarray
        Shape (points, dimensions). More points of a sequence, and another hypercube at the end,
        leave the first points what they were.

    Examples
    --------
    >>> few, many = (unit_points("sobol", (n,), 2, seed=1) for n in (3, 8))
    >>> bool((few == many[:3]).all())
    True
    """
    from scipy.stats import qmc  # takes most of a second

    if kind == "sobol":
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of counts that are no power of two
            return qmc.Sobol(dimensions, rng=seed).random(sum(counts))
    seeds = np.random.SeedSequence(seed).spawn(len(counts))
    cubes = [
        qmc.LatinHypercube(dimensions, rng=np.random.default_rng(own)).random(count)
        for own, count in zip(seeds, counts, strict=True)
    ]
    return np.concatenate(cubes)
