"""Scenes of a folder of results, as the files themselves remember them."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from bondcell.errors import DataError, Violation
from bondcell.results.view import SAMPLE, parameters
from bondcell.scenes.parsing import recorded_scene
from bondcell.storage import read_dataset

if TYPE_CHECKING:
    from bondcell.scenes.scene import Scene


def found_scenes(results: Path) -> list[Scene]:
    """Every scene with a study.nc in the folder: sweeps first, extremes last, each kind by name.

    Parameters
    ----------
    results
        The folder with a folder for each scene.

    Raises
    ------
    DataError
        There is none, or a file is damaged or does not say what it was computed for.
    """
    paths = sorted(results.glob("*/study.nc"))
    if not paths:
        wanted = "a folder of results, with <scene>/study.nc in it"
        raise DataError([Violation("results", str(results), wanted)])
    return sorted(map(_scene, paths), key=_rank)


def _scene(path: Path) -> Scene:
    study = read_dataset(path)
    given = study.attrs.get("parameters")
    if given is None:
        wanted = "the parameters of the scene, as bondcell writes them"
        raise DataError([Violation("parameters", "no such attribute", wanted)], str(path))
    scene = recorded_scene(str(given), path.parent.name)
    if scene.design is not None and scene.design.table is not None:
        # The table may be gone or have grown; the file has the rows that were computed.
        names = [name for name in parameters(study) if study[name].dims == (SAMPLE,)]
        scene.design.set_values({name: study[name].values for name in names})
    return scene


def _rank(scene: Scene) -> int:
    kinds = (
        scene.stability,
        scene.prony is not None,
        scene.specimen is not None,
        scene.convergence is not None,
        scene.atlas,
    )
    return max((len(kinds) - place for place, is_kind in enumerate(kinds) if is_kind), default=0)
