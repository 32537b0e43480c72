"""Rows of a scene's results: what is asked for at every point, with all that its values rest on."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from bondcell.errors import InputError, Violation
from bondcell.results.names import models_with, reference_variants

if TYPE_CHECKING:
    from bondcell.scenes.scene import Scene

ANALYTIC = "analytic"
"""Analytic models."""

REFERENCE = "fe"
"""The finite element reference."""

RELAXING_MODELS = "relaxation_models"
"""Relaxation by analytic models."""

RELAXING_REFERENCE = "relaxation_fe"
"""Relaxation by the reference."""

KINDS = (ANALYTIC, REFERENCE, RELAXING_MODELS, RELAXING_REFERENCE)
"""Kinds of rows; a batch holds rows of one kind."""


@dataclass(frozen=True)
class Row:
    """A model under a load: with a point's inputs it says all that a value depends on.

    Parameters
    ----------
    kind
        One of `KINDS`.
    load
        Load name.
    model
        Name of the model; of the reference ``fe_<boundary condition, or load>``.
    options
        Pairs of name and value that the values depend on besides.
    """

    kind: str
    load: str
    model: str
    options: tuple[tuple[str, Any], ...] = ()

    @property
    def file_prefix(self) -> str:
        """What the files of the row's batches begin with."""
        return self.model if self.kind == REFERENCE else f"{self.kind}_{self.load}"

    @property
    def condition(self) -> dict[str, str]:
        """The boundary condition of a row of the reference, of the normal load only.

        Examples
        --------
        >>> Row(REFERENCE, "normal", "fe_clamped").condition
        {'bc': 'clamped'}
        """
        head, _, variant = self.model.partition("_")
        if head != REFERENCE or not variant:
            allowed = f"{REFERENCE}_<boundary condition or load>"
            raise InputError([Violation("model", self.model, allowed)])
        return {"bc": variant} if self.load == "normal" else {}

    def as_list(self) -> list[Any]:
        """The row in plain lists, as JSON holds it."""
        return [self.kind, self.load, self.model, [list(option) for option in self.options]]

    @classmethod
    def from_list(cls, content: list[Any]) -> Row:
        """The row of `as_list`.

        Examples
        --------
        >>> row = Row(REFERENCE, "normal", "fe_roller", (("tolerance", 1e-6),))
        >>> Row.from_list(row.as_list()) == row
        True
        """
        kind, load, model, options = content
        return cls(kind, load, model, tuple((name, value) for name, value in options))


def wanted_rows(scene: Scene) -> list[Row]:
    """The rows of a scene's results, in the order of its file.

    Parameters
    ----------
    scene
        A scene.
    """
    found = []
    for load in scene.loads:
        found += analytic_rows(scene, load) + reference_rows(scene, load)
    return found + [row for load in scene.loads for row in relaxation_rows(scene, load)]


def analytic_rows(scene: Scene, load: str) -> list[Row]:
    """Rows of the analytic models under a load; the springs are the series model's only."""
    springs = (("contributions", True),) if scene.contributions else ()
    return [
        Row(ANALYTIC, load, model, springs if model == "fsi" else ())
        for model in models_with(scene, load)
    ]


def reference_rows(scene: Scene, load: str) -> list[Row]:
    """Rows of the reference under a load, one for each boundary condition."""
    variants = reference_variants(scene, load).values()
    return [
        Row(REFERENCE, load, f"{REFERENCE}_{variant}", _tolerance(scene)) for variant in variants
    ]


def relaxation_rows(scene: Scene, load: str) -> list[Row]:
    """Rows of relaxation under a load, none for a scene without time."""
    if scene.prony is None:
        return []
    series = (("prony", scene.prony_digest),)
    models = [Row(RELAXING_MODELS, load, name, series) for name in models_with(scene, load)]
    variants = reference_variants(scene, load).values()
    return models + [
        Row(RELAXING_REFERENCE, load, f"{REFERENCE}_{variant}", (*series, *_tolerance(scene)))
        for variant in variants
    ]


def _tolerance(scene: Scene) -> tuple[tuple[str, Any], ...]:
    assert scene.reference is not None
    return (("tolerance", scene.reference.tolerance),)
