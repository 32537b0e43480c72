"""What the groups of a scene's file hold: names, dimensions, units and meaning of every variable.

The documentation prints it, and tests compare it with files as they are written.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

from bondcell.cell import LONG_NAMES, UNITS
from bondcell.models import MODELS
from bondcell.outputs import (
    DETAILS,
    FREQUENCY,
    OUTPUTS,
    STIFFNESS_UNITS,
    TIME,
    output_attributes,
    part_attributes,
)
from bondcell.results.finite_axes import PREFIX
from bondcell.results.relaxation_names import METHODS, attributes
from bondcell.results.relaxation_names import VARIABLES as RELAXATION_VARIABLES
from bondcell.results.view import SAMPLE
from bondcell.scenes.sweep import AXIS_NAMES
from bondcell.specimen.names import AXES as SPECIMEN_AXES

if TYPE_CHECKING:
    import xarray as xr

SWEPT = "axes"
"""Stands for the swept axes, in the order of the file, of which a variable may have some."""

BY_LOAD = "by load"
"""Stands for the unit of the stiffness under the group's load."""

NO_UNIT = ""
"""Text and flags have no unit."""


@dataclass(frozen=True)
class Variable:
    """One variable of a file.

    Parameters
    ----------
    name
        Its name.
    dims
        Names of its dimensions; `SWEPT` stands for the swept axes.
    units
        As UDUNITS writes them; `BY_LOAD` depends on the load, `NO_UNIT` for text and flags.
    meaning
        What it is.
    """

    name: str
    dims: tuple[str, ...]
    units: str
    meaning: str

    def fits(self, found: xr.Variable, axes: tuple[str, ...]) -> bool:
        """Whether a variable of a file has these dimensions and units.

        Parameters
        ----------
        found
            The variable in the file.
        axes
            The swept axes there.
        """
        fixed = tuple(dim for dim in self.dims if dim != SWEPT)
        others = tuple(dim for dim in found.dims if SWEPT not in self.dims or dim not in axes)
        unit = found.attrs.get("units", NO_UNIT)
        units = set(STIFFNESS_UNITS.values()) if self.units == BY_LOAD else {self.units}
        return others == fixed and unit in units


@dataclass(frozen=True)
class Group:
    """Variables of one group of a file.

    Parameters
    ----------
    name
        Name of the group, ``/`` for the root.
    where
        Which files have it.
    variables
        What it may hold; a file has those that its scene asks for.
    """

    name: str
    where: str
    variables: tuple[Variable, ...]


def sweep_variables() -> Iterator[Variable]:
    """Inputs and results at points, in the root group and in the group of each further load."""
    for name, unit in UNITS.items():
        yield Variable(name, (SWEPT,), unit, LONG_NAMES[name])
    for name, meaning in AXIS_NAMES.items():
        yield Variable(name, (SWEPT,), "1", meaning)
    yield Variable(SAMPLE, (SAMPLE,), "1", "number of a design's point")
    reciprocal = "reciprocal of the axis, 0 for rigid particles: to be plotted over"
    yield Variable(f"{PREFIX}modulus_ratio", ("modulus_ratio",), "1", reciprocal)
    yield Variable("model", ("model",), NO_UNIT, "name in bondcell.MODELS, or fe_<bc>")
    for name in (*OUTPUTS, *DETAILS):
        about = output_attributes("bending")[name]
        unit = BY_LOAD if name == "stiffness" else about.get("units", NO_UNIT)
        meaning = about["long_name"].replace("bending ", "")
        yield Variable(name, ("model", SWEPT), unit, meaning)
    for part in ("k_i", "k_int", "k_j"):
        meaning = part_attributes(part, MODELS["fsi"].name, "normal")["long_name"]
        yield Variable(part, (SWEPT,), BY_LOAD, meaning)


def relaxation_variables() -> Iterator[Variable]:
    """What a relaxing matrix adds to the root group and to the groups of further loads."""
    for name, dims in RELAXATION_VARIABLES.items():
        about = attributes(name, "bending")
        stiffness = about.get("units") == STIFFNESS_UNITS["bending"]
        unit = BY_LOAD if stiffness else about.get("units", NO_UNIT)
        known = tuple(SWEPT if dim == "point" else dim for dim in dims)
        yield Variable(name, known, unit, about["long_name"].replace("bending ", ""))
    yield Variable("time", ("time",), TIME["units"], TIME["long_name"])
    yield Variable("frequency", ("frequency",), FREQUENCY["units"], FREQUENCY["long_name"])
    yield from _read(
        """
        convention     | convention |   | constant_bulk: shear relaxes; constant_poisson: all alike
        series         | series     |   | name of the Prony series of the matrix
        series_kind    | series     |   | kind of material, inline or generated
        series_profile | series     |   | weights of a generated series over its times
        series_decades | series     | 1 | decades from the smallest to the largest time
        series_relaxing | series    | 1 | share of the modulus that relaxes
        series_size    | series     | 1 | terms of the matrix
        temperature    | series     | K | temperature to which the series is shifted
        """
    )


def _read(table: str) -> Iterator[Variable]:
    """Variables of a table: name, dimensions, unit, meaning."""
    for line in table.strip().splitlines():
        name, dims, units, meaning = (cell.strip() for cell in line.split("|"))
        yield Variable(name, tuple(dims.split()), units, meaning)


def _axes(*names: str) -> Iterator[Variable]:
    """Axes of the specimen."""
    for name in names:
        about = SPECIMEN_AXES[name]
        yield Variable(name, (name,), about.get("units", NO_UNIT), about["long_name"])


_LADDER = """
    case       | case              |   | name of the cell
    method     | method            |   | discretisation
    level      | level             |   | from coarse to fine
    refinement | case method level | 1 | order, ratio of neighbours, element size or basis vectors
    stiffness  | case method level | N m-1 | stiffness under normal load and shear
    rotational_stiffness | case method level | N m rad-1 | stiffness under torsion and bending
    error      | case method level | 1 | relative to the finest structured level
    order      | case method level | 1 | observed: in dof^(-1/2) of triangles, else the rate in p
    seconds_mesh | case method level | s | wall time of meshing, median of repeats
    seconds_assembly | case method level | s | wall time of assembly, median of repeats
    seconds_solve | case method level | s | wall time of the solution, median of repeats
    seconds    | case method level | s | wall time of all stages
    seconds_spread | case method level | s | slowest repeat less the quickest
    seconds_cpu | case method level | s | processor time of all stages, median of repeats
    bound      | case method level | 1 | largest bound of the reduced basis over random materials
    sample_error | case method level | 1 | largest true error of it over a sample of them
    dof        | case method level | 1 | degrees of freedom
    elements   | case method level | 1 | elements of the mesh
    status     | case method level |   | outcome, a flag
    analytic_model | analytic_model |  | name in bondcell.MODELS
    model_stiffness | case analytic_model | N m-1 | stiffness by that model
    model_rotational_stiffness | case analytic_model | N m rad-1 | the same, torsion and bending
    model_error | case analytic_model | 1 | relative to the finest structured level
    model_seconds | case analytic_model | s | wall time per point among many, median of repeats
    model_seconds_spread | case analytic_model | s | slowest repeat less the quickest, per point
    model_seconds_cpu | case analytic_model | s | processor time per point, median of repeats
    model_status | case analytic_model |  | outcome, a flag
    reference_error | case         | 1 | relative difference of the two finest levels
    load       | case              |   | load of the case
    bc         | case              |   | its boundary condition
    unit       | case              |   | unit of its stiffness
"""

_METHODS_IN_TIME = """
    case       | case              |   | name of the matrix's series
    method     | method            |   | way to K(t)
    level      | level             |   | from coarse to fine
    compared_time | compared_time  | s | times since the step at which they are compared
    refinement | case method level | 1 | tolerance, steps a decade, or nodes
    error      | case method level | 1 | largest relative error over the times
    seconds    | case method level | s | wall time, set-up included, median of repeats
    seconds_spread | case method level | s | slowest repeat less the quickest
    seconds_cpu | case method level | s | processor time, median of repeats
    dof        | case method level | 1 | degrees of freedom
    status     | case method level |   | outcome, a flag
    curve      | case method level compared_time | by load | stiffness after a step
    truth      | case compared_time | by load | what the others are compared with
    reference_error | case         | 1 | error estimate of that
    convention | case              |   | what relaxes
    load       | case              |   | load of the case
    bc         | case              |   | its boundary condition
    unit       | case              |   | unit of its stiffness
"""

_SPECIMEN = """
    energy     | method loading walls | J | strain energy
    error_estimate | method loading walls | 1 | relative numerical error of the energy
    status     | method loading walls |   | outcome, a flag
    dof        | method loading walls | 1 | degrees of freedom
    seconds    | method loading walls | s | wall time of all loadings together, mesh excluded
    seconds_spread | method loading walls | s | slowest run less the quickest, of lattices
    seconds_cpu | method loading walls | s | processor time of all loadings together
    displacement | method loading walls particle component | m | of the particle's centre
    rotation   | method loading walls particle | rad | of the particle
    mode_energy | method loading walls mode | J | strain energy by mode of deformation
    displacement_norm | method loading walls | m | root of the sum of squared displacements
    softest    | method walls | N m-1 | smallest 2 U / n^2 of any displacement of norm n
    limit_energy | method loading walls | J | extrapolated over the meshes
    limit_error | method loading walls | 1 | relative uncertainty of that energy
    reference_energy | loading walls | J | best known energy of the solid
    reference_error | loading walls | 1 | relative uncertainty of that energy
    energy_ratio | method loading walls | 1 | energy over the best known one
    norm_ratio | method loading walls | 1 | displacement norm over that of the solid
    displacement_error | method loading walls | 1 | norm of the difference from the solid's, relative
    rotation_error | method loading walls | 1 | the same of the rotations
"""

_SPECIMEN_GROUPS = {
    "ladder": (
        ("method", "loading", "walls", "per_gap", "order"),
        """
        level_energy | method loading walls per_gap order | J | strain energy on each mesh
        level_dof | method loading walls per_gap order | 1 | degrees of freedom of each mesh
        level_seconds | method loading walls per_gap order | s | wall time on each mesh, mesh excluded
        level_seconds_cpu | method loading walls per_gap order | s | processor time on each mesh, mesh excluded
        """,
    ),
    "bonds": (
        ("method", "loading", "walls", "force"),
        """
        bond_force | method loading walls bond force | N | of the bond; the moment in N m
        bond_nodes | bond end | 1 | numbers of its nodes, particles first
        """,
    ),
    "midplane": (
        ("loading", "component", "end"),
        """
        place | vertex component | m | of a vertex in the mid-plane
        displacement | vertex component loading | m | there
        principal_stress | loading vertex end | Pa | largest and smallest principal stress
        triangle | triangle_number corner | 1 | vertices of a triangle, counted from 0
        triangle_particle | triangle_number | 1 | particle of a triangle, 0 in the matrix
        """,
    ),
    "relaxation": (
        ("method", "loading"),
        f"""
        time | time | s | {TIME["long_name"]}
        reaction | method loading time | N | force on the displaced particles
        energy | method loading time | J | half of force times displacement
        fit_error | method loading | 1 | relative error of the fitted springs
        """,
    ),
    "finite_strain": (
        ("method", "direction"),
        """
        energy | method direction | J | energy at finite strain
        linear_energy | method direction | J | energy of the linear theory
        ratio | method direction | 1 | one over the other
        """,
    ),
}


def groups() -> list[Group]:
    """Every group that a scene's file may have."""
    case_inputs = [Variable(name, ("case",), unit, LONG_NAMES[name]) for name, unit in UNITS.items()]
    specimen = (*_axes("method", "loading", "walls", "particle", "component", "mode"),)
    return [
        Group("/", "a sweep; every further load in a group of its name", (*sweep_variables(),)),
        Group("/", "besides, with a `prony` block", (*relaxation_variables(),)),
        Group("/convergence", "with a `convergence` block", (*_read(_LADDER), *case_inputs)),
        Group(f"/{METHODS}", "with `methods` in its `prony` block", (*_read(_METHODS_IN_TIME),)),
        Group("/", "with a `specimen` block", (*specimen, *_read(_SPECIMEN))),
        *(
            Group(f"/{name}", "with a `specimen` block", (*_axes(*axes), *_read(table)))
            for name, (axes, table) in _SPECIMEN_GROUPS.items()
        ),
    ]
