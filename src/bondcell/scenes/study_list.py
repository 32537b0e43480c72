"""The list of scenes that make up the default study: params/study.yaml."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

from pydantic import AfterValidator, BeforeValidator, Field, ValidationError

from bondcell.errors import SceneError, Violation
from bondcell.scenes.fields import NAME, NAME_RULE, Block, SceneSchema, distinct
from bondcell.scenes.quantities import NotAllowed
from bondcell.scenes.violations import found_violations
from bondcell.scenes.yaml_loading import load_mapping


def _name(value: Any) -> str:
    if not isinstance(value, str) or not NAME.fullmatch(value):
        raise NotAllowed(NAME_RULE)
    return value


class StudyList(Block):
    """Scenes of a study, in the order of the report."""

    scenes: Annotated[
        tuple[Annotated[str, BeforeValidator(_name)], ...], AfterValidator(distinct)
    ] = Field(
        description="Names of scene files beside this one, without .yaml, in the report's order.",
        json_schema_extra={
            "minItems": 1,
            "uniqueItems": True,
            "items": {"type": "string", "pattern": f"^{NAME.pattern}$"},
        },
    )


def load_study_list(path: str | Path) -> tuple[str, ...]:
    """Read the names of a study's scenes.

    Parameters
    ----------
    path
        A YAML file with the one key ``scenes``.

    Returns
    -------
    tuple of str
        Names; each has a file ``<name>.yaml`` beside the list.

    Raises
    ------
    SceneError
        Lists every violation; a name without a file is one.
    """
    data = load_mapping(path, SceneError)
    try:
        names = StudyList.model_validate(data).scenes
    except ValidationError as error:
        found = [violation for _, violation in found_violations(error, StudyList)]
        raise SceneError(found, source=str(path)) from None
    missing = [
        Violation(f"scenes.{i}", name, f"a scene with a file {name}.yaml in {Path(path).parent}")
        for i, name in enumerate(names)
        if not (Path(path).parent / f"{name}.yaml").is_file()
    ]
    if missing:
        raise SceneError(missing, source=str(path))
    return names


def study_list_json_schema() -> dict[str, Any]:
    """JSON schema of the list, for editors."""
    schema = StudyList.model_json_schema(schema_generator=SceneSchema)
    return {"$schema": SceneSchema.schema_dialect, **schema}
