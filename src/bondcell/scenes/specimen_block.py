"""The block of a scene that asks for the paper's specimen."""

from __future__ import annotations

from collections.abc import Iterable
from itertools import pairwise
from typing import Annotated, Any, Self

from pydantic import AfterValidator, Field, model_validator

from bondcell.scenes.fields import Block, distinct, number_between, one_of, whole_number_between
from bondcell.scenes.quantities import NotAllowed
from bondcell.scenes.time_fields import Terms, TimeSpan
from bondcell.specimen.names import (
    DIRECTIONS,
    FINITE_STRAIN,
    LATTICES,
    LOADINGS,
    RELAXING,
    WALLS,
)

SIZES = (0.15, 2.0)
"""Element sizes of the solid relative to the gap."""

LARGEST_POISSON = 0.49
"""Largest Poisson's ratio that the solid's displacement elements bear."""


def _listed(names: Iterable[str]) -> Any:
    return Field(json_schema_extra={"enum": list(names)})


def _names(default: tuple[str, ...], description: str) -> Any:
    return Field(
        default,
        description=description,
        json_schema_extra={"minItems": 1, "uniqueItems": True},
    )


def _falling(sizes: tuple[float, ...]) -> tuple[float, ...]:
    if not sizes or any(later >= earlier for earlier, later in pairwise(sizes)):
        raise NotAllowed("decreasing values, each once, at least one; leave the key out for none")
    return sizes


Lattice = Annotated[str, one_of(lambda: LATTICES), _listed(LATTICES)]
Loading = Annotated[str, one_of(lambda: tuple(LOADINGS)), _listed(tuple(LOADINGS))]
Wall = Annotated[str, one_of(lambda: WALLS), _listed(WALLS)]
Relaxing = Annotated[str, one_of(lambda: RELAXING), _listed(RELAXING)]
Finite = Annotated[str, one_of(lambda: FINITE_STRAIN), _listed(FINITE_STRAIN)]
Direction = Annotated[str, one_of(lambda: tuple(DIRECTIONS)), _listed(tuple(DIRECTIONS))]
Size = Annotated[float, number_between(*SIZES)]
Ladder = Annotated[tuple[Size, ...], AfterValidator(_falling)]


Order = Annotated[int, whole_number_between(3, 4)]


class Ladders(Block):
    """Meshes of the solid: element sizes relative to the gap, falling, for each kind of walls.

    All are solved with second-order displacements, the coarsest one with `orders` besides.
    """

    free: Ladder | None = Field(
        None, description=f"Sizes with free sides, {list(SIZES)}, decreasing; left out: not solved."
    )
    fixed: Ladder | None = Field(
        None, description="Sizes with fixed sides, likewise; left out: not solved."
    )
    orders: Annotated[tuple[Order, ...], AfterValidator(distinct)] = Field(
        (),
        description="Higher orders of the displacements, on the coarsest mesh besides.",
        json_schema_extra={"uniqueItems": True},
    )

    @model_validator(mode="after")
    def _check(self) -> Self:
        if not self.sizes():
            raise NotAllowed("sizes for free or fixed walls")
        return self

    def sizes(self) -> dict[str, tuple[float, ...]]:
        """Walls -> sizes, of those that are to be solved."""
        both = {"free": self.free, "fixed": self.fixed}
        return {name: sizes for name, sizes in both.items() if sizes}


class SpecimenRelaxation(Block):
    """The specimen held displaced while its matrix relaxes."""

    series: Terms = Field(description="Prony series of the matrix's shear modulus.")
    times: TimeSpan = Field(description="Times of the curves; t = 0 comes besides.")
    methods: Annotated[tuple[Relaxing, ...], AfterValidator(distinct)] = _names(
        RELAXING[1:], "Lattices that relax, and fe_rigid for the condensed solid."
    )
    convention: Annotated[
        str,
        one_of(lambda: ("constant_bulk", "constant_poisson")),
        Field(json_schema_extra={"enum": ["constant_bulk", "constant_poisson"]}),
    ] = Field("constant_bulk", description="What else relaxes with the shear modulus.")
    per_gap: Size = Field(1.0, description="Element size of the solid relative to the gap.")


class SpecimenFiniteStrain(Block):
    """The specimen at finite strain: energy over that of the linear theory."""

    methods: Annotated[tuple[Finite, ...], AfterValidator(distinct)] = _names(
        FINITE_STRAIN[1:], "Lattices, and fe_elastic for the neo-Hookean solid."
    )
    directions: Annotated[tuple[Direction, ...], AfterValidator(distinct)] = _names(
        tuple(DIRECTIONS), "Ways in which particles 1 to 3 are displaced."
    )
    per_gap: Size = Field(1.0, description="Element size of the solid relative to the gap.")
    steps: Annotated[int, whole_number_between(1, 100)] = Field(2, description="Load steps.")


class SpecimenBlock(Block):
    """The paper's eighteen particles in a matrix: lattices of bonds against the 3D solid."""

    lattices: Annotated[tuple[Lattice, ...], AfterValidator(distinct)] = _names(
        LATTICES, "Lattices: which bonds and which of their springs."
    )
    loadings: Annotated[tuple[Loading, ...], AfterValidator(distinct)] = _names(
        tuple(LOADINGS), "Directions in which particles 1 to 3 are displaced."
    )
    walls: Annotated[tuple[Wall, ...], AfterValidator(distinct)] = _names(
        WALLS, "Sides of the box in the lattices."
    )
    elastic: Ladders | None = Field(
        None, description="Solid with elastic particles; left out: not solved."
    )
    rigid: Ladders | None = Field(
        None, description="Solid with rigid particles, condensed; left out: not solved."
    )
    relaxation: SpecimenRelaxation | None = Field(None, description="Left out: nothing relaxes.")
    finite_strain: SpecimenFiniteStrain | None = Field(
        None, description="Left out: the linear theory only."
    )

    def solids(self) -> dict[str, Ladders]:
        """Names of the solids that are solved -> their meshes."""
        both = {"fe_rigid": self.rigid, "fe_elastic": self.elastic}
        return {name: ladders for name, ladders in both.items() if ladders}

    @property
    def parts(self) -> tuple[str, ...]:
        """Names of the jobs that the specimen is cut into."""
        more = {"relaxation": self.relaxation, "finite_strain": self.finite_strain}
        return ("lattices", *self.solids(), *(name for name, block in more.items() if block))

    @property
    def needs_meshes(self) -> bool:
        """Whether any solid is meshed; the pockets of the full lattice are one as well."""
        solid = {"lattice_full"} & set(self.lattices) or self.solids()
        return bool(solid or "relaxation" in self.parts or "finite_strain" in self.parts)
