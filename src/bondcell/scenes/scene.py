"""A scene: what one parameter file asks for, checked, immutable, in SI units."""

from __future__ import annotations

import json
import warnings
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, NamedTuple

from pydantic import AfterValidator, Field, PrivateAttr, ValidationError

from bondcell.cell import Cell, FloatArray
from bondcell.errors import SceneError, Violation
from bondcell.scenes import checks, digests
from bondcell.scenes.blocks import CellInputs, Convergence, Reference
from bondcell.scenes.design import Design
from bondcell.scenes.design_checks import read_design
from bondcell.scenes.fields import (
    NAME,
    NAME_RULE,
    Block,
    Flag,
    SceneSchema,
    distinct,
    text_up_to,
)
from bondcell.scenes.keys import block_of
from bondcell.scenes.materials import FOLDER
from bondcell.scenes.names import LoadNames, ModelName
from bondcell.scenes.prony_block import PronyBlock
from bondcell.scenes.quantities import UnitsWarning
from bondcell.scenes.scene_materials import read_materials
from bondcell.scenes.specimen_block import SpecimenBlock
from bondcell.scenes.sweep import DERIVED, Sweep
from bondcell.scenes.violations import KeyPath, as_given, found_violations, null_violations, without
from bondcell.scenes.yaml_loading import load_mapping

RESERVED = ("study",)
"""Names a scene cannot have: params/study.yaml is the list of scenes."""


class ConvergenceCase(NamedTuple):
    """A complete cell of the convergence study, its load and (of the normal one) its condition."""

    cell: Cell
    bc: str
    load: str = "normal"


class Scene(Block):
    """What one parameter file asks for. What it does not name is neither computed nor imported.

    Build one with `load_scene` or `parse_scene`, which also check what concerns several keys.
    """

    title: Annotated[str, text_up_to(200)] = Field(
        description="Heading of the scene's section in the report.",
        json_schema_extra={"minLength": 1, "maxLength": 200},
    )
    question: Annotated[str, text_up_to(4000)] | None = Field(
        None,
        description="What the scene is to answer, and what a reader should know.",
        json_schema_extra={"minLength": 1, "maxLength": 4000},
    )
    cell: CellInputs = Field(default_factory=CellInputs, description="The bond cell.")
    sweep: Sweep | None = Field(None, description="Swept axes; left out: the one cell.")
    design: Design | None = Field(
        None,
        description="Points that are no grid, at every point of the sweep if there is one; on the "
        "dimension sample of the results.",
    )
    models: Annotated[tuple[ModelName, ...], AfterValidator(distinct)] = Field(
        (),
        description="Analytic models to evaluate at every point.",
        json_schema_extra={"minItems": 1, "uniqueItems": True},
    )
    reference: Reference | None = Field(
        None, description="Finite element reference; left out: nothing is meshed."
    )
    loads: LoadNames = Field(
        ("normal",),
        alias="load",
        description="Load on the cell, one or a list; a model is evaluated for those it covers. "
        "The results of the first are in the root group of study.nc, those of each other one in "
        "a group of its name.",
    )
    contributions: Flag = Field(
        False, description="Whether to store the springs k_i, k_int, k_j of the model fsi."
    )
    stability: Flag = Field(
        False,
        description="Whether to write stability.csv: every point of the reference with its error "
        "estimate, flag, cost and condition, worst first.",
    )
    atlas: Flag = Field(
        False,
        description="Whether the sweep is an accuracy atlas: error by region, best models and "
        "error against run time instead of curves. With the axes gap_ratio, modulus_ratio, "
        "poisson_m.",
    )
    convergence: Convergence | None = Field(None, description="Convergence study; left out: none.")
    prony: PronyBlock | None = Field(
        None, description="A matrix that relaxes; left out: there is no time."
    )
    specimen: SpecimenBlock | None = Field(
        None,
        description="The paper's specimen as lattices of bonds and as a solid, in a scene of its "
        "own; of the cell only the moduli count, left out: the paper's.",
    )

    _name: str = PrivateAttr("scene")
    _given: str = PrivateAttr("{}")

    @property
    def name(self) -> str:
        """Name of the scene: the file's name without folder and ending."""
        return self._name

    @property
    def load(self) -> str:
        """The first load, whose results are in the root group of the scene's file."""
        return self.loads[0]

    @property
    def given_json(self) -> str:
        """The parameters as they were given, as JSON text."""
        return self._given

    @property
    def axis_names(self) -> tuple[str, ...]:
        """Names of the swept axes in the order of the file."""
        return self.sweep.names if self.sweep else ()

    @property
    def swept_inputs(self) -> tuple[str, ...]:
        """Inputs that axes and design set, those behind ratios included."""
        names = (*self.axis_names, *(self.design.names if self.design else ()))
        return tuple(dict.fromkeys(DERIVED.get(name, name) for name in names))

    @property
    def axes(self) -> dict[str, FloatArray]:
        """Swept axes in the order of the file: name -> SI values, shape (length of the axis,)."""
        return self.sweep.axes() if self.sweep else {}

    @property
    def samples(self) -> dict[str, FloatArray]:
        """Parameters of the design: name -> SI values, shape (samples,)."""
        return self.design.values() if self.design else {}

    @property
    def points(self) -> int:
        """Number of points: of the sweep times those of the design, 1 without either."""
        points = self.sweep.points() if self.sweep else 1
        return points * (self.design.count() if self.design else 1)

    @property
    def has_points(self) -> bool:
        """Whether anything is evaluated at the points of the sweep (or at the one cell)."""
        return bool(self.models) or self.reference is not None

    @property
    def uses_finite_elements(self) -> bool:
        """Whether anything is meshed."""
        solid = self.specimen is not None and self.specimen.needs_meshes
        return self.reference is not None or self.convergence is not None or solid

    @property
    def uses_triangles(self) -> bool:
        """Whether the unstructured mesher is needed."""
        solid = self.specimen is not None and self.specimen.needs_meshes
        return solid or (self.convergence is not None and bool(self.convergence.sizes))

    @property
    def fe_names(self) -> dict[str, str]:
        """Names of the reference's results -> boundary condition; the first one is ``fe``."""
        if self.reference is None:
            return {}
        first, *others = self.reference.bc
        return {"fe": first, **{f"fe_{bc}": bc for bc in others}}

    def cases(self) -> dict[str, ConvergenceCase]:
        """Cells of the convergence study by case name."""
        if self.convergence is None:
            return {}
        given = self.cell.given()
        block = self.convergence
        return {
            name: ConvergenceCase(
                cell=Cell.from_values(**{**given, **case.given()}),
                bc=case.bc or block.bc,
                load=case.load or self.load,
            )
            for name, case in block.cases.items()
        }

    @property
    def digest(self) -> str:
        """Identity of everything the scene says."""
        return digests.everything(self)

    @property
    def prony_digest(self) -> str:
        """Identity of what relaxation depends on besides points, models and their options."""
        return digests.prony(self)

    @property
    def methods_digest(self) -> str:
        """Identity of what the comparison of methods in time depends on."""
        return digests.methods(self)

    @property
    def specimen_digest(self) -> str:
        """Identity of what the specimen's results depend on."""
        return digests.specimen(self)

    @property
    def convergence_digest(self) -> str:
        """Identity of what the convergence study depends on."""
        return digests.convergence(self)


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
        records = found_violations(error, known_keys)
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
        violations = [violation for _, violation in found_violations(error, known_keys)]
        raise SceneError(violations, source=name) from error
    except ValueError as error:
        wrong = Violation("parameters", given_json[:40], "JSON text as bondcell writes it")
        raise SceneError([wrong], source=name) from error
    scene._name = name
    scene._given = given_json
    return scene


def known_keys(path: KeyPath) -> tuple[str, ...]:
    """Keys that the block at a path may have."""
    block = block_of(path) or Scene
    return tuple(field.alias or name for name, field in block.model_fields.items())


def scene_json_schema() -> dict[str, Any]:
    """JSON schema of a scene file, for editors."""
    schema = Scene.model_json_schema(schema_generator=SceneSchema)
    about = {
        "title": "bondcell scene",
        "description": "What it names is computed; what it leaves out is not even imported.",
    }
    return {"$schema": SceneSchema.schema_dialect, **schema, **about}


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
            bad |= {_prunable(path) for path, _ in found_violations(error, known_keys)}
    return None
