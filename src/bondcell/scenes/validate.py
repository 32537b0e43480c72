"""Everything that is wrong or odd about a parameter file, without raising."""

from __future__ import annotations

import warnings
from pathlib import Path
from typing import NamedTuple

from bondcell.errors import SceneError, Violation
from bondcell.scenes.parsing import load_scene
from bondcell.scenes.quantities import UnitsWarning
from bondcell.scenes.study_list import load_study_list
from bondcell.scenes.yaml_loading import load_mapping


class Findings(NamedTuple):
    """What was found: `violations` make the file unusable, `warnings` are worth a look."""

    violations: tuple[Violation, ...]
    warnings: tuple[str, ...]


def validate_file(path: str | Path) -> Findings:
    """Check a scene file, or a list of scenes.

    Parameters
    ----------
    path
        A YAML file; one with the key ``scenes`` is a list of scenes, anything else a scene.

    Returns
    -------
    Findings
        The pair (violations, warnings); both empty if all is well.
    """
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        try:
            if "scenes" in load_mapping(path, SceneError):
                load_study_list(path)
            else:
                load_scene(path)
        except SceneError as error:
            return Findings(error.violations, ())
    odd = tuple(str(entry.message) for entry in caught if issubclass(entry.category, UnitsWarning))
    return Findings((), odd)
