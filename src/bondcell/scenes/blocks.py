"""The blocks of a scene besides the sweep: cell, reference, convergence."""

from __future__ import annotations

from itertools import pairwise
from typing import Annotated, Any

from pydantic import AfterValidator, BeforeValidator, Field

from bondcell.cell import UNITS
from bondcell.reference_options import BOUNDARY_CONDITIONS, TOLERANCES
from bondcell.scenes.fields import (
    NAME,
    NAME_RULE,
    Block,
    Length,
    Modulus,
    ParticleModulus,
    PoissonRatio,
    describe_input,
    distinct,
    number_between,
    one_of,
    whole_number_between,
)
from bondcell.scenes.names import LoadName
from bondcell.scenes.quantities import NotAllowed

ORDERS = (1, 20)
"""Polynomial orders that may be asked of the structured discretisation."""

GRADINGS = (1.2, 20.0)
"""Ratios of neighbouring element sizes of the structured discretisation."""

SIZES = (0.02, 4.0)
"""Element sizes of the triangles, relative to the local scale."""

REPEATS = (1, 1000)
"""Timed runs of which the median is reported."""

BoundaryCondition = Annotated[
    str,
    one_of(lambda: BOUNDARY_CONDITIONS),
    Field(json_schema_extra={"enum": list(BOUNDARY_CONDITIONS)}),
]


def _bounds(interval: tuple[float, float]) -> dict[str, Any]:
    return {"minimum": interval[0], "maximum": interval[1]}


def _input(name: str) -> Any:
    return Field(None, description=describe_input(name))


class CellInputs(Block):
    """Inputs of the bond cell; bare numbers are SI."""

    radius_i: Length | None = _input("radius_i")
    radius_j: Length | None = _input("radius_j")
    gap: Length | None = _input("gap")
    cylinder_radius: Length | None = _input("cylinder_radius")
    young_i: ParticleModulus | None = _input("young_i")
    young_j: ParticleModulus | None = _input("young_j")
    young_m: Modulus | None = _input("young_m")
    poisson_i: PoissonRatio | None = _input("poisson_i")
    poisson_j: PoissonRatio | None = _input("poisson_j")
    poisson_m: PoissonRatio | None = _input("poisson_m")

    def given(self) -> dict[str, float]:
        """The inputs that were given: name -> SI value."""
        values = {name: getattr(self, name) for name in UNITS}
        return {name: value for name, value in values.items() if value is not None}


class Case(CellInputs):
    """A cell of the convergence study: what differs from the scene's `cell`."""

    bc: BoundaryCondition | None = Field(
        None,
        description="Boundary condition of this case, of the normal load; left out: that of the "
        "block.",
    )
    load: LoadName | None = Field(
        None, description="Load of this case; left out: the scene's first."
    )


def _as_list(value: Any) -> Any:
    return [value] if isinstance(value, str) else value


class Reference(Block):
    """The finite element reference at every point of the sweep; {} takes the defaults."""

    bc: Annotated[
        tuple[BoundaryCondition, ...],
        AfterValidator(distinct),
        BeforeValidator(
            _as_list, json_schema_input_type=BoundaryCondition | tuple[BoundaryCondition, ...]
        ),
    ] = Field(
        ("roller",),
        description="Boundary conditions of the normal load, one or a list: roller, clamped, "
        "confined. The first is the one that the models are compared with.",
    )
    tolerance: Annotated[float, number_between(*TOLERANCES)] = Field(
        1e-6,
        description="Relative error [1] at which refinement stops.",
        json_schema_extra=_bounds(TOLERANCES),
    )


def _case_name(value: Any) -> str:
    if not isinstance(value, str) or not NAME.fullmatch(value):
        raise NotAllowed(NAME_RULE)
    return value


def _some_case(cases: dict[str, Case]) -> dict[str, Case]:
    if not cases:
        raise NotAllowed("at least one case, as in {base: {}}")
    return cases


def _increasing(orders: tuple[int, ...]) -> tuple[int, ...]:
    if any(later <= earlier for earlier, later in pairwise(orders)):
        raise NotAllowed("increasing orders, each once")
    return orders


def _decreasing(sizes: tuple[float, ...]) -> tuple[float, ...]:
    if any(later >= earlier for earlier, later in pairwise(sizes)):
        raise NotAllowed("decreasing values, each once")
    return sizes


class Convergence(Block):
    """Ladders of refinement: error against work of each discretisation."""

    cases: Annotated[
        dict[Annotated[str, BeforeValidator(_case_name)], Case], AfterValidator(_some_case)
    ] = Field(
        default_factory=lambda: {"base": Case()},
        description="Case name -> inputs that differ from those of `cell`.",
        json_schema_extra={
            "minProperties": 1,
            "propertyNames": {"pattern": f"^{NAME.pattern}$"},
        },
    )
    orders: Annotated[
        tuple[Annotated[int, whole_number_between(*ORDERS)], ...], AfterValidator(_increasing)
    ] = Field(
        (),
        description=f"Polynomial orders of the structured discretisation, {list(ORDERS)}, "
        "increasing; none: it is not run.",
    )
    sizes: Annotated[
        tuple[Annotated[float, number_between(*SIZES)], ...], AfterValidator(_decreasing)
    ] = Field(
        (),
        description=f"Element sizes of the triangles relative to the local scale, {list(SIZES)}, "
        "decreasing; none: they are not meshed.",
    )
    gradings: Annotated[
        tuple[Annotated[float, number_between(*GRADINGS)], ...], AfterValidator(_decreasing)
    ] = Field(
        (),
        description="Ratios of neighbouring element sizes of the structured discretisation at the "
        f"fixed order 4, {list(GRADINGS)}, decreasing: an h-ladder; none: it is not run.",
    )
    basis_order: Annotated[int, whole_number_between(2, ORDERS[1])] | None = Field(
        None,
        description="Order of the discretisation on which a reduced basis is grown, vector by "
        "vector; left out: none is.",
    )
    bc: BoundaryCondition = Field(
        "roller", description="Boundary condition of the cases under the normal load."
    )
    repeats: Annotated[int, whole_number_between(*REPEATS)] = Field(
        3,
        description="Timed runs of each level; the median is reported.",
        json_schema_extra=_bounds(REPEATS),
    )
