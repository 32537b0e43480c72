"""The swept axes of a scene: lists and ranges of values, and the inputs that follow from ratios."""

from __future__ import annotations

from collections.abc import Mapping
from math import inf, prod
from typing import Annotated, Any, Self

import numpy as np
from pydantic import (
    AfterValidator,
    Discriminator,
    Field,
    ModelWrapValidatorHandler,
    PrivateAttr,
    Tag,
    model_validator,
)

from bondcell.cell import FloatArray
from bondcell.scenes.fields import (
    Block,
    Length,
    Modulus,
    ModulusRatio,
    ParticleModulus,
    PoissonRatio,
    Ratio,
    describe_input,
    distinct,
)
from bondcell.scenes.quantities import NotAllowed
from bondcell.scenes.ranges import (
    LengthRange,
    ModulusRange,
    PoissonRange,
    Range,
    RatioRange,
)

DERIVED = {"modulus_ratio": "young_m", "gap_ratio": "gap", "radius_ratio": "radius_j"}
"""Axes that are ratios -> the input each of them sets."""

AXIS_NAMES = {
    "modulus_ratio": "ratio of Young's moduli, particle i to matrix",
    "gap_ratio": "ratio of gap to radius of particle i",
    "radius_ratio": "ratio of radii, particle j to particle i",
}
"""Meaning of the ratios."""


def _form(value: Any) -> str | None:
    if isinstance(value, (list, tuple)):
        return "list"
    return "range" if isinstance(value, (dict, Range)) else None


_Distinct = AfterValidator(distinct)
_Form = Discriminator(_form)
_Listed = Field(json_schema_extra={"minItems": 1, "uniqueItems": True})

LengthAxis = Annotated[
    Annotated[tuple[Length, ...], _Distinct, _Listed, Tag("list")]
    | Annotated[LengthRange, Tag("range")],
    _Form,
]
ModulusAxis = Annotated[
    Annotated[tuple[Modulus, ...], _Distinct, _Listed, Tag("list")]
    | Annotated[ModulusRange, Tag("range")],
    _Form,
]
ParticleModulusAxis = Annotated[
    Annotated[tuple[ParticleModulus, ...], _Distinct, _Listed, Tag("list")]
    | Annotated[ModulusRange, Tag("range")],
    _Form,
]
PoissonAxis = Annotated[
    Annotated[tuple[PoissonRatio, ...], _Distinct, _Listed, Tag("list")]
    | Annotated[PoissonRange, Tag("range")],
    _Form,
]
RatioAxis = Annotated[
    Annotated[tuple[Ratio, ...], _Distinct, _Listed, Tag("list")]
    | Annotated[RatioRange, Tag("range")],
    _Form,
]

ModulusRatioAxis = Annotated[
    Annotated[tuple[ModulusRatio, ...], _Distinct, _Listed, Tag("list")]
    | Annotated[RatioRange, Tag("range")],
    _Form,
]


def _axis(name: str) -> Any:
    also = " In a list also rigid: rigid particles in the matrix of `cell`."
    end = also if name == "modulus_ratio" else ""
    return Field(None, description=f"{describe_parameter(name)}{end}")


def describe_parameter(name: str) -> str:
    """Say what an input of the cell or a ratio is, with unit and range.

    Examples
    --------
    >>> describe_parameter("gap_ratio")
    'Ratio of gap to radius of particle i [1], (0, inf); sets gap.'
    """
    if name not in DERIVED:
        return describe_input(name)
    meaning = AXIS_NAMES[name][0].upper() + AXIS_NAMES[name][1:]
    return f"{meaning} [1], (0, inf); sets {DERIVED[name]}."


class Sweep(Block):
    """Axes of the sweep; the points are all combinations, the axes in the order of the file."""

    radius_i: LengthAxis | None = _axis("radius_i")
    radius_j: LengthAxis | None = _axis("radius_j")
    radius_ratio: RatioAxis | None = _axis("radius_ratio")
    gap: LengthAxis | None = _axis("gap")
    gap_ratio: RatioAxis | None = _axis("gap_ratio")
    cylinder_radius: LengthAxis | None = _axis("cylinder_radius")
    young_i: ParticleModulusAxis | None = _axis("young_i")
    young_j: ParticleModulusAxis | None = _axis("young_j")
    young_m: ModulusAxis | None = _axis("young_m")
    modulus_ratio: ModulusRatioAxis | None = _axis("modulus_ratio")
    poisson_i: PoissonAxis | None = _axis("poisson_i")
    poisson_j: PoissonAxis | None = _axis("poisson_j")
    poisson_m: PoissonAxis | None = _axis("poisson_m")

    _order: tuple[str, ...] = PrivateAttr(())

    @model_validator(mode="wrap")
    @classmethod
    def _keep_order(cls, data: Any, handler: ModelWrapValidatorHandler[Self]) -> Self:
        sweep = handler(data)
        if isinstance(data, Mapping):
            sweep._order = tuple(name for name in data if name in cls.model_fields)
        if not sweep._order:
            raise NotAllowed("at least one axis; leave the key out for a single point")
        return sweep

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the axes in the order of the file."""
        return self._order

    def axes(self) -> dict[str, FloatArray]:
        """The axes in the order of the file: name -> SI values, shape (length of the axis,)."""
        return {name: self._values(name) for name in self._order}

    def points(self) -> int:
        """Number of combinations of the axes' values."""
        axes = (getattr(self, name) for name in self._order)
        return prod(axis.points if isinstance(axis, Range) else len(axis) for axis in axes)

    @property
    def has_rigid_ratio(self) -> bool:
        """Whether a modulus ratio is infinite, which a range cannot say."""
        axis = self.modulus_ratio
        return isinstance(axis, tuple) and inf in axis

    def _values(self, name: str) -> FloatArray:
        axis = getattr(self, name)
        return axis.values() if isinstance(axis, Range) else np.asarray(axis, dtype=np.float64)


def resolve_inputs(given: Mapping[str, Any], axes: Mapping[str, Any]) -> dict[str, Any]:
    """Inputs of the cell on the axes; a swept value takes the place of a given one.

    Parameters
    ----------
    given
        Values of the ``cell`` block [SI].
    axes
        Swept values [SI], shaped to broadcast against each other, or labelled.

    Returns
    -------
    dict
        Input name -> value, the ratios replaced by what they set:
        ``young_m = young_i / modulus_ratio``, ``gap = gap_ratio radius_i``,
        ``radius_j = radius_ratio radius_i``. An infinite ``modulus_ratio`` makes the particles
        rigid and leaves the matrix as given.

    Examples
    --------
    >>> resolve_inputs(
    ...     {"young_i": 3e10, "young_m": 1.4e6}, {"modulus_ratio": np.array([1, 1e4])}
    ... )
    {'young_i': 30000000000.0, 'young_m': array([3.e+10, 3.e+06])}
    """
    inputs = {**given, **{name: axis for name, axis in axes.items() if name not in DERIVED}}
    if "modulus_ratio" in axes and "young_i" in inputs:
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            inputs["young_m"] = inputs["young_i"] / axes["modulus_ratio"]
        _make_rigid(inputs, given, np.isinf(axes["modulus_ratio"]))
    for ratio, name in (("gap_ratio", "gap"), ("radius_ratio", "radius_j")):
        if ratio in axes and "radius_i" in inputs:
            inputs[name] = axes[ratio] * inputs["radius_i"]
    return inputs


def _make_rigid(inputs: dict[str, Any], given: Mapping[str, Any], rigid: Any) -> None:
    """Rigid particles in the given matrix at the points of an infinite ratio."""
    if not rigid.any():
        return
    choose = _where_labelled if hasattr(rigid, "dims") else np.where
    inputs["young_m"] = choose(rigid, given.get("young_m", np.nan), inputs["young_m"])
    for name in {"young_i", "young_j"} & set(inputs):
        inputs[name] = choose(rigid, np.inf, inputs[name])


def _where_labelled(condition: Any, chosen: Any, other: Any) -> Any:
    if not hasattr(other, "where"):  # a plain number
        return condition.copy(data=np.where(condition.values, chosen, other))
    return other.where(~condition, chosen)
