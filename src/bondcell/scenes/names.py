"""Names of models and loads in a scene: looked up in the package, so that both agree."""

from __future__ import annotations

from collections.abc import Collection
from typing import Annotated, Any

from pydantic import BeforeValidator, Field

from bondcell.scenes.fields import one_of
from bondcell.scenes.quantities import NotAllowed


def analytic_models() -> tuple[str, ...]:
    """Names of the models a scene may list; the reference has a block of its own."""
    from bondcell.models import MODELS

    return tuple(name for name, model in MODELS.items() if not model.is_reference)


def known_loads() -> tuple[str, ...]:
    """Names of the loads that any model covers."""
    from bondcell.models import MODELS

    return tuple(dict.fromkeys(load for model in MODELS.values() for load in model.loads))


def _model(name: Any) -> str:
    known = analytic_models()
    if not isinstance(name, str) or name not in known:
        hint = "; the reference is asked for by the key `reference`" if name == "fe" else ""
        raise NotAllowed(f"one of {', '.join(known)}{hint}")
    return name


def _show_models(schema: dict[str, Any]) -> None:
    schema["enum"] = list(analytic_models())


def _show_loads(schema: dict[str, Any]) -> None:
    schema["enum"] = list(known_loads())


ModelName = Annotated[str, BeforeValidator(_model), Field(json_schema_extra=_show_models)]


def _loads(value: Any) -> tuple[str, ...]:
    known = known_loads()
    names = value if isinstance(value, (list, tuple)) else [value]
    sound = all(isinstance(name, str) and name in known for name in names)
    if not (names and sound and len(set(names)) == len(names)):
        raise NotAllowed(f"one of {', '.join(known)}, or a list of them, each once")
    return tuple(names)


def covering(loads: Collection[str]) -> tuple[str, ...]:
    """Names of the models that cover at least one of the loads."""
    from bondcell.models import MODELS

    return tuple(name for name, model in MODELS.items() if set(loads) & set(model.loads))


LoadName = Annotated[str, one_of(known_loads), Field(json_schema_extra=_show_loads)]
LoadNames = Annotated[
    tuple[LoadName, ...],
    BeforeValidator(_loads, json_schema_input_type=LoadName | tuple[LoadName, ...]),
]
