"""What a scene's results are called: models and references under each of its loads."""

from __future__ import annotations

from typing import TYPE_CHECKING

from bondcell.scenes.names import covering

if TYPE_CHECKING:
    from bondcell.scenes.scene import Scene


def models_with(scene: Scene, load: str) -> tuple[str, ...]:
    """The scene's analytic models that cover a load."""
    able = covering([load])
    return tuple(name for name in scene.models if name in able)


def reference_variants(scene: Scene, load: str) -> dict[str, str]:
    """Names of the reference's results under a load -> boundary condition, or the load itself."""
    if load == "normal":
        return scene.fe_names
    return {} if scene.reference is None else {"fe": load}


def all_variants(scene: Scene) -> tuple[str, ...]:
    """What the reference is asked for: boundary conditions of the normal load, other loads."""
    return tuple(
        variant for load in scene.loads for variant in reference_variants(scene, load).values()
    )


def result_names(scene: Scene) -> list[str]:
    """The dimension ``model`` of the results, the same under every load."""
    references = [name for load in scene.loads for name in reference_variants(scene, load)]
    return [*scene.models, *dict.fromkeys(references)]
