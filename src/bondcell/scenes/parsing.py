"""Scene files read and checked as a whole: every violation at once, or a scene."""

from __future__ import annotations

import json
import warnings
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from bondcell.errors import SceneError, Violation
from bondcell.scenes import checks
from bondcell.scenes.design_checks import read_design
from bondcell.scenes.fields import NAME, NAME_RULE
from bondcell.scenes.keys import KeyPath
from bondcell.scenes.materials import FOLDER
from bondcell.scenes.quantities import UnitsWarning
from bondcell.scenes.scene import Scene
from bondcell.scenes.scene_materials import read_materials
from bondcell.scenes.violations import as_given, found_violations, null_violations, without
from bondcell.scenes.yaml_loading import load_mapping

RESERVED = ("study",)
"""Names a scene cannot have: params/study.yaml is the list of scenes."""


def load_scene(path: str | Path) -> Scene:
    """Read and check a scene file.

    Parameters
    ----------
    path
        A YAML file; its name without the ending is the scene's name.

    Returns
    -------
    Scene
        Immutable, SI units.

    Raises
    ------
    SceneError
        Lists every violation with its dotted key, value and allowed range.

    Warns
    -----
    UnitsWarning
        A value is so large or small that its unit was probably forgotten.
    """
    source = str(path)
    content, folder = load_mapping(path, SceneError), Path(path).parent
    scene = parse_scene(
        content, name=Path(path).stem, source=source, materials=folder / FOLDER, tables=folder
    )
    for warning in checks.unit_warnings(scene):
        warnings.warn(f"{source}: {warning}", UnitsWarning, stacklevel=2)
    return scene


def parse_scene(
    data: Mapping[str, Any],
    name: str = "scene",
    source: str | None = None,
    materials: Path | None = None,
    tables: Path | None = None,
) -> Scene:
    """Check the content of a scene file.

    Parameters
    ----------
    data
        Nested mappings and lists of plain values.
    name
        The scene's name.
    source
        Where the content came from, for messages.
    materials
        Folder of the named materials; None: there are none.
    tables
        Folder of the tables of points; None: there are none.

    Raises
    ------
    SceneError
        Lists every violation with its dotted key, value and allowed range.

    Examples
    --------
    >>> scene = parse_scene(
    ...     {
    ...         "title": "One cell",
    ...         "models": ["fsi"],
    ...         "cell": {
    ...             "radius_i": "7.5 mm",
    ...             "gap": "0.5 mm",
    ...             "young_i": "30 GPa",
    ...             "poisson_i": 0.25,
    ...             "young_m": "1.4 MPa",
    ...             "poisson_m": 0.46,
    ...         },
    ...     }
    ... )
    >>> scene.cell.gap, scene.points
    (0.0005, 1)
    """
    violations = _name_violations(name)
    nulls = dict(null_violations(data))
    bad = {_prunable(path) for path in nulls}
    violations += nulls.values()
    scene: Scene | None
    try:
        scene = Scene.model_validate(without(data, nulls))
    except ValidationError as error:
        # A block emptied by a null is not wrong besides.
        around = {path[:depth] for path in nulls for depth in range(len(path))}
        records = found_violations(error, Scene)
        found = [(path, violation) for path, violation in records if path not in around]
        violations += [violation for _, violation in found]
        bad |= {_prunable(path) for path, _ in found}
        scene = _salvage(data, set(bad))
    if scene is not None:
        violations += read_materials(scene.prony, materials)
        violations += read_design(scene.design, tables)
        joint = checks.joint_violations(scene, bad)
        violations += [as_given(violation, data) for violation in joint]
    unique = {violation.field: violation for violation in reversed(violations)}
    if unique:
        raise SceneError(reversed(unique.values()), source=source)
    assert scene is not None
    scene._name = name
    scene._given = json.dumps(data, ensure_ascii=False, default=str)
    return scene


def recorded_scene(given_json: str, name: str) -> Scene:
    """A scene as the file of its results remembers it.

    Parameters
    ----------
    given_json
        The file's attribute ``parameters``.
    name
        The scene's name.

    Raises
    ------
    SceneError
        The text is no scene of this version.

    Notes
    -----
    What concerns the scene's surroundings (its materials, its folder) was checked when the results
    were computed, and is not checked again.
    """
    try:
        scene = Scene.model_validate(json.loads(given_json))
    except ValidationError as error:
        violations = [violation for _, violation in found_violations(error, Scene)]
        raise SceneError(violations, source=name) from error
    except ValueError as error:
        wrong = Violation("parameters", given_json[:40], "JSON text as bondcell writes it")
        raise SceneError([wrong], source=name) from error
    scene._name = name
    scene._given = given_json
    return scene


def _name_violations(name: str) -> list[Violation]:
    if NAME.fullmatch(name) and name not in RESERVED:
        return []
    return [Violation("name", name, f"{NAME_RULE}, other than {', '.join(RESERVED)}")]


_SALVAGED = (("cell",), ("sweep",), ("design",), ("convergence",), ("specimen",))
"""Blocks of which the sound keys are kept where others are wrong."""


def _prunable(path: KeyPath) -> KeyPath:
    """The part of a scene that can be left out when something in it is wrong."""
    if path[:2] == ("convergence", "cases"):
        return path[:3]
    return path[:2] if path[:1] in _SALVAGED else path[:1]


def _salvage(data: Mapping[str, Any], bad: set[KeyPath]) -> Scene | None:
    """The scene without its wrong parts, so that what concerns several keys is checked as well."""
    for _ in range(4):
        try:
            return Scene.model_validate({"title": "untitled", **without(data, bad)})
        except ValidationError as error:
            # Leaving a part out can empty the block around it: leave that out too.
            bad |= {_prunable(path) for path, _ in found_violations(error, Scene)}
    return None
