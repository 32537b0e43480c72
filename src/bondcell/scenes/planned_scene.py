"""A scene read again by a job: it must still be the one that the job was planned for."""

from __future__ import annotations

import warnings
from pathlib import Path

from bondcell.errors import DataError, Violation
from bondcell.scenes.parsing import load_scene
from bondcell.scenes.quantities import UnitsWarning
from bondcell.scenes.scene import Scene


def planned_scene(path: str | Path, **planned: str) -> Scene:
    """Load a scene that a plan was made for, and check that it still is that scene.

    Parameters
    ----------
    path
        The scene's file.
    **planned
        Name of one of the scene's digests -> what it was when the work was planned.

    Raises
    ------
    DataError
        The file was edited after planning: results would be filed under the wrong parameters.
    """
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UnitsWarning)  # said once, when the work was planned
        scene = load_scene(path)
    changed = [
        Violation(name, getattr(scene, name), f"{digest}: as planned; the file was edited since")
        for name, digest in planned.items()
        if getattr(scene, name) != digest
    ]
    if changed:
        raise DataError(changed, str(path))
    return scene
