"""A scene: what one parameter file asks for, checked, immutable, in SI units."""

from __future__ import annotations

from typing import Annotated, NamedTuple

from pydantic import AfterValidator, Field, PrivateAttr

from bondcell.cell import Cell, FloatArray
from bondcell.scenes import digests
from bondcell.scenes.blocks import CellInputs, Convergence, Reference
from bondcell.scenes.design import Design
from bondcell.scenes.fields import Block, Flag, distinct, text_up_to
from bondcell.scenes.names import LoadNames, ModelName
from bondcell.scenes.prony_block import PronyBlock
from bondcell.scenes.specimen_block import SpecimenBlock
from bondcell.scenes.sweep import DERIVED, Sweep


class ConvergenceCase(NamedTuple):
    """A complete cell of the convergence study, its load and (of the normal one) its condition."""

    cell: Cell
    bc: str
    load: str = "normal"


class Scene(Block):
    """What one parameter file asks for. What it does not name is neither computed nor imported.

    `bondcell.scenes.parsing` builds one and also checks what concerns several keys.
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
