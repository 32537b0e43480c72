"""The block of a scene that makes its matrix relax: which series, at which times, with what checks.

Nothing here imports the code that computes relaxation.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, Any, Self

from pydantic import AfterValidator, BeforeValidator, Field, PrivateAttr, model_validator

from bondcell.scenes.fields import (
    NAME,
    Block,
    Flag,
    distinct,
    number_between,
    one_of,
    whole_number_between,
)
from bondcell.scenes.materials import Material, material_name
from bondcell.scenes.names import analytic_models
from bondcell.scenes.quantities import NotAllowed
from bondcell.scenes.series_cases import SeriesCase, Spectrum
from bondcell.scenes.time_fields import (
    FrequencySpan,
    Temperature,
    Terms,
    TimeSpan,
)

CONVENTIONS = ("constant_bulk", "constant_poisson")
"""How the matrix relaxes besides its shear modulus."""

MOST_SERIES = 1000
"""Most series of a scene."""

Convention = Annotated[
    str, one_of(lambda: CONVENTIONS), Field(json_schema_extra={"enum": list(CONVENTIONS)})
]
_Listed = Field(json_schema_extra={"minItems": 1, "uniqueItems": True})


class Methods(Block):
    """Error against run time: the exact series, time stepping, Laplace inversion, K(0) g(t)."""

    series: Annotated[
        tuple[Annotated[str, BeforeValidator(lambda v: _text(v))], ...], AfterValidator(distinct)
    ] = Field(description="Names of the series to compare them on.")
    order: Annotated[int, whole_number_between(2, 12)] = Field(
        4, description="Polynomial order of the finite elements of all methods."
    )
    steps: Annotated[
        tuple[Annotated[int, whole_number_between(1, 1000)], ...], AfterValidator(distinct), _Listed
    ] = Field((1, 2, 4, 8), description="Time steps a decade, a run for each.")
    nodes: Annotated[
        tuple[Annotated[int, whole_number_between(4, 40)], ...], AfterValidator(distinct), _Listed
    ] = Field((6, 10), description="Nodes of the contour of Laplace inversion, a run for each.")
    times: Annotated[int, whole_number_between(2, 100)] = Field(
        4, description="Times at which the methods are compared, spread over those of the curves."
    )
    repeats: Annotated[int, whole_number_between(1, 100)] = Field(
        1, description="Timed runs of each, of which the median is reported."
    )


def _result(value: Any) -> str:
    known = (*analytic_models(), "fe")
    if not isinstance(value, str) or value not in known:
        raise NotAllowed(f"one of {', '.join(known)}")
    return value


def _text(value: Any) -> str:
    if not isinstance(value, str):
        raise NotAllowed("the name of a series of this scene")
    return value


class BondTable(Block):
    """The bond's own series as a table for discrete element codes."""

    models: Annotated[
        tuple[Annotated[str, BeforeValidator(_result)], ...], AfterValidator(distinct)
    ] = Field(
        (),
        description="Models whose series are wanted, fe for the reference; left out: the "
        "reference, or without one all models.",
        json_schema_extra={"minItems": 1, "uniqueItems": True},
    )
    terms: Annotated[int, whole_number_between(1, 100)] | None = Field(
        None,
        description="Most terms of a series, fitted over `times`; left out: the exact series, "
        "however long.",
    )
    error: Annotated[float, number_between(1e-9, 0.5)] | None = Field(
        None,
        description="In place of `terms`: largest relative error of K(t) over `times`; every "
        "series gets as few terms as that takes.",
    )

    @model_validator(mode="after")
    def _check(self) -> Self:
        if self.terms is not None and self.error is not None:
            raise NotAllowed("either terms or error")
        return self


class PronyBlock(Block):
    """A matrix that relaxes: K(t), K*(omega) and the bond's own Prony series at every point."""

    materials: Annotated[
        tuple[Annotated[str, BeforeValidator(material_name)], ...], AfterValidator(distinct)
    ] = Field(
        (),
        description="Named materials, each a file of the folder materials beside the scene.",
        json_schema_extra={"minItems": 1, "uniqueItems": True},
    )
    own_modulus: Flag = Field(
        False,
        description="Whether a named material brings its own Young's modulus at t = 0 in place of "
        "the cell's young_m.",
    )
    temperatures: Annotated[tuple[Temperature, ...], AfterValidator(distinct)] = Field(
        (),
        description="Temperatures of the named materials, as in 20 degC; each of them needs the "
        "constants of a shift. Left out: the materials' own.",
    )
    series: dict[str, Terms] = Field(
        default_factory=dict,
        description="Name -> terms given here.",
        json_schema_extra={"propertyNames": {"pattern": f"^{NAME.pattern}$"}},
    )
    spectrum: Spectrum | None = Field(
        None, description="Generated series: number of terms, spread of times, weights."
    )
    conventions: Annotated[
        tuple[Convention, ...],
        AfterValidator(distinct),
        BeforeValidator(
            lambda v: [v] if isinstance(v, str) else v,
            json_schema_input_type=Convention | tuple[Convention, ...],
        ),
    ] = Field(
        ("constant_bulk",),
        description="constant_bulk: the shear modulus relaxes alone, poisson_m rises; "
        "constant_poisson: all moduli relax alike.",
    )
    times: TimeSpan = Field(description="Times of the curves; t = 0 comes besides.")
    frequencies: FrequencySpan | None = Field(
        None,
        description="Angular frequencies of the complex stiffness; left out: 1/t of `times`.",
    )
    bond: BondTable = Field(
        default_factory=lambda: BondTable(), description="What bond_series.csv holds."
    )
    checks: Annotated[int, whole_number_between(0, 100)] = Field(
        0,
        description="Real Laplace variables at which every series is checked against the elastic "
        "stiffness of the modulus there, into relaxation_stability.csv; 0: none.",
    )
    methods: Methods | None = Field(None, description="Error against run time; left out: none.")

    _materials: dict[str, Material] = PrivateAttr(default_factory=dict)

    @model_validator(mode="after")
    def _check(self) -> Self:
        if not (self.materials or self.series or self.spectrum):
            raise NotAllowed("something that relaxes: materials, series or spectrum")
        wrong = [name for name in self.series if not NAME.fullmatch(name)]
        if wrong:
            raise NotAllowed(f"names of small letters, digits and _ in series, not {wrong[0]!r}")
        return self

    def cases(self) -> list[SeriesCase]:
        """All series in the order materials, given terms, generated ones."""
        found = [case for name in self.materials for case in self._of_material(name)]
        found += [
            SeriesCase(
                name=name,
                weights=terms.weights,
                times=terms.times,
                relative_to=terms.relative_to,
            )
            for name, terms in self.series.items()
        ]
        return found + (list(self.spectrum.cases()) if self.spectrum else [])

    def add_material(self, name: str, material: Material) -> None:
        """Tell what the file of a named material says."""
        self._materials[name] = material

    def has_material(self, name: str) -> bool:
        """Whether the file of a named material could be read."""
        return name in self._materials

    def known_material(self, name: str) -> Material:
        """What the file of a named material says."""
        return self._materials[name]

    def _of_material(self, name: str) -> Iterator[SeriesCase]:
        material = self._materials.get(name)
        for temperature in self.temperatures or (None,) if material else ():
            assert material is not None
            label = name if temperature is None else f"{name}_{temperature:g}K"
            yield SeriesCase(
                name=label,
                weights=material.shares,
                times=material.times,
                kind=material.kind,
                material=name,
                temperature=material.temperature if temperature is None else temperature,
                young=material.instantaneous if self.own_modulus else None,
            )

    @property
    def dynamic_frequencies(self) -> Any:
        """Angular frequencies [rad/s], ascending."""
        if self.frequencies is not None:
            return self.frequencies.values()
        return 1 / self.times.values()[::-1]
