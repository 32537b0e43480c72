"""Results of costly scenes that are kept: whether they still are those of the scene's file."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from bondcell.errors import DataError
from bondcell.storage import read_dataset

if TYPE_CHECKING:
    from bondcell.scenes.scene import Scene


def was_computed(scene: Scene, study: str | Path) -> bool:
    """Whether a file holds the results of a scene as its file is now.

    Parameters
    ----------
    scene
        The scene.
    study
        Its study.nc.
    """
    try:
        return bool(read_dataset(study).attrs.get("parameters") == scene.given_json)
    except DataError:
        return False
