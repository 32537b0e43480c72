"""Named materials: how a matrix relaxes, with source, temperature and units in a file."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Annotated, Any, Literal, Self

from pydantic import AfterValidator, Field, ValidationError, model_validator

from bondcell.errors import InputError, Violation
from bondcell.scenes.fields import NAME, NAME_RULE, Block, Modulus, SceneSchema, text_up_to
from bondcell.scenes.quantities import NotAllowed
from bondcell.scenes.time_fields import (
    PositiveNumber,
    Temperature,
    Time,
    Weight,
    check_terms,
    some_terms,
)
from bondcell.scenes.violations import found_violations, null_violations, without
from bondcell.scenes.yaml_loading import load_mapping

FOLDER = "materials"
"""Folder of the materials beside the scenes."""


class MaterialError(InputError):
    """A material's file is wrong."""


def _positive(modulus: float) -> float:
    if not modulus > 0:
        raise NotAllowed("a modulus above 0 Pa")
    return modulus


class Wlf(Block):
    """Constants of the shift of Williams, Landel and Ferry."""

    c_1: PositiveNumber = Field(description="Dimensionless constant.")
    c_2: PositiveNumber = Field(description="Temperature constant [K].")


class Arrhenius(Block):
    """Constant of the shift of Arrhenius."""

    activation_energy: PositiveNumber = Field(description="Activation energy [J/mol].")


class Material(Block):
    """How a material relaxes; values carry units (``5286 MPa``, ``0.3 s``) or are SI.

    Either `weights` (shares of the modulus at t = 0) with `young`, the modulus at t = 0, or
    absolute `moduli` with `long_term`.
    """

    title: Annotated[str, text_up_to(200)] = Field(description="What it is.")
    kind: Literal["mixture", "binder", "polymer", "other"] = Field(
        description="mixture: binder with aggregate, as a whole; binder: the binder alone."
    )
    source: Annotated[str, text_up_to(400)] = Field(description="Where the values come from.")
    note: Annotated[str, text_up_to(1000)] | None = Field(
        None, description="What a reader should know."
    )
    temperature: Temperature | None = Field(
        None, description="Temperature at which the times hold; left out: not stated."
    )
    times: Annotated[tuple[Time, ...], AfterValidator(some_terms)] = Field(
        description="Relaxation time of each term [s]."
    )
    weights: Annotated[tuple[Weight, ...], AfterValidator(some_terms)] | None = Field(
        None, description="Share of the modulus at t = 0 of each term."
    )
    young: Annotated[Modulus, AfterValidator(_positive)] | None = Field(
        None, description="Young's modulus at t = 0 [Pa]."
    )
    moduli: (
        Annotated[
            tuple[Annotated[Modulus, AfterValidator(_positive)], ...], AfterValidator(some_terms)
        ]
        | None
    ) = Field(None, description="Young's modulus of each term [Pa], in place of weights and young.")
    long_term: Annotated[Modulus, AfterValidator(_positive)] | None = Field(
        None, description="Young's modulus that never relaxes [Pa], beside moduli; left out: none."
    )
    wlf: Wlf | None = Field(None, description="Shift with temperature.")
    arrhenius: Arrhenius | None = Field(None, description="Shift with temperature.")

    @model_validator(mode="after")
    def _check(self) -> Self:
        relative = self.weights is not None and self.young is not None
        absolute = self.moduli is not None
        mixed = absolute and (self.weights is not None or self.young is not None)
        if mixed or not (relative or absolute) or (self.long_term and not absolute):
            raise NotAllowed("either weights and young, or moduli (and long_term)")
        if self.wlf is not None and self.arrhenius is not None:
            raise NotAllowed("one shift with temperature, wlf or arrhenius")
        if self.has_shift and self.temperature is None:
            raise NotAllowed("a temperature beside the constants of a shift")
        check_terms(self.shares, self.times, "instantaneous")
        return self

    @property
    def has_shift(self) -> bool:
        """Whether other temperatures can be asked for."""
        return self.wlf is not None or self.arrhenius is not None

    def shift(self, temperature: float) -> float:
        """Times at a temperature [K] over those of the file; raises as `prony.shift` does."""
        from bondcell.prony.shift import arrhenius, wlf

        assert self.temperature is not None
        if self.wlf is not None:
            return float(wlf(temperature, self.temperature, self.wlf.c_1, self.wlf.c_2))
        assert self.arrhenius is not None
        energy = self.arrhenius.activation_energy
        return float(arrhenius(temperature, self.temperature, energy))

    @property
    def instantaneous(self) -> float:
        """Young's modulus at t = 0 [Pa]."""
        if self.moduli is None:
            assert self.young is not None
            return self.young
        return math.fsum([*self.moduli, self.long_term or 0.0])

    @property
    def shares(self) -> tuple[float, ...]:
        """Share of the modulus at t = 0 of each term."""
        if self.moduli is None:
            assert self.weights is not None
            return self.weights
        whole = self.instantaneous
        return tuple(modulus / whole for modulus in self.moduli)


def load_material(folder: str | Path, name: str) -> Material:
    """Read and check a material.

    Parameters
    ----------
    folder
        Where the materials are.
    name
        The file's name without its ending.

    Raises
    ------
    MaterialError
        No such material, or everything that is wrong with it.
    """
    known = known_materials(folder)
    if name not in known:
        allowed = f"one of {', '.join(known)}" if known else f"none: {folder} holds no material"
        raise MaterialError([Violation("material", name, allowed)])
    path = Path(folder) / f"{name}.yaml"
    return parse_material(load_mapping(path, MaterialError), str(path))


def parse_material(data: dict[str, Any], source: str | None = None) -> Material:
    """Check the content of a material's file; raises as `load_material`.

    Examples
    --------
    >>> material = parse_material(
    ...     {
    ...         "title": "A rubber",
    ...         "kind": "polymer",
    ...         "source": "made up",
    ...         "moduli": ["3 MPa"],
    ...         "long_term": "1 MPa",
    ...         "times": ["2 ms"],
    ...     }
    ... )
    >>> material.instantaneous, material.shares
    (4000000.0, (0.75,))
    """
    nulls = dict(null_violations(data))
    violations = list(nulls.values())
    try:
        material = Material.model_validate(without(data, nulls))
    except ValidationError as error:
        violations += [
            found if path else Violation("material", ", ".join(map(str, data)), found.allowed)
            for path, found in found_violations(error, Material)
        ]
    if violations:
        raise MaterialError({v.field: v for v in reversed(violations)}.values(), source)
    return material


def known_materials(folder: str | Path) -> tuple[str, ...]:
    """Names of the materials in a folder, sorted; none if there is no such folder."""
    paths = sorted(Path(folder).glob("*.yaml"))
    return tuple(path.stem for path in paths if NAME.fullmatch(path.stem))


def material_name(value: Any) -> str:
    """Check a name, before any file is looked for."""
    if not isinstance(value, str) or not NAME.fullmatch(value):
        raise NotAllowed(NAME_RULE)
    return value


def material_json_schema() -> dict[str, Any]:
    """JSON schema of a material's file, for editors."""
    schema = Material.model_json_schema(schema_generator=SceneSchema)
    about = {"title": "bondcell material", "description": "How a matrix relaxes."}
    return {"$schema": SceneSchema.schema_dialect, **schema, **about}
