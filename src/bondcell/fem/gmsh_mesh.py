"""Unstructured second-order triangles of the bond cell's meridional section, made by gmsh.

The unit of length is the cylinder radius.
"""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass
from types import ModuleType
from typing import NamedTuple

import numpy as np

from bondcell.errors import BondcellError
from bondcell.fem.gmsh_session import gmsh_model
from bondcell.fem.section_mesh import MATRIX, PARTICLE_I, PARTICLE_J, TriangleMesh

LARGEST_SIZE = 0.12
"""Largest element of ``size = 1``, as a fraction of the larger sphere's radius."""

CUSP_END = 1e-3
"""Height of the triangle that closes a zero-angle end of the matrix."""

_TOUCHES = 1e-9
_SIX_NODE_TRIANGLE = 9
_OPTIONS = {
    "Geometry.Tolerance": 1e-14,
    "Mesh.Algorithm": 6,
    "Mesh.SecondOrderLinear": 0,
    "Mesh.HighOrderOptimize": 0,
}


@dataclass(frozen=True)
class Section:
    """Half plane ``r >= 0`` of a bond cell, or the lower half of it when the pair is symmetric.

    Parameters
    ----------
    radius_i, radius_j, gap
        As in `bondcell.cell.Cell`, in units of the cylinder radius.
    half
        Only ``z <= L/2``; asks for equal radii.
    fine_corners
        Refine toward the corners of matrix between end planes and side: where a clamped plane
        meets a free surface the stress is singular.
    """

    radius_i: float
    radius_j: float
    gap: float
    half: bool = False
    fine_corners: bool = False

    @property
    def length(self) -> float:
        """``L = R_i + R_j + L_g``."""
        return self.radius_i + self.radius_j + self.gap

    @property
    def largest_radius(self) -> float:
        """Radius of the larger sphere."""
        return max(self.radius_i, self.radius_j)


def triangle_mesh(section: Section, size: float) -> TriangleMesh:
    """Mesh a section.

    Parameters
    ----------
    section
        The geometry.
    size
        Element size relative to the local scale: the distance between the two spheres in the film,
        growing outward, never above `LARGEST_SIZE` of the larger radius. Halving it halves every
        element.

    Raises
    ------
    MissingLibrary
        gmsh or a system library of it is absent.
    BondcellError
        gmsh could not mesh the section, or an element came out inverted.

    Notes
    -----
    The spheres are exact circle arcs and the mid-nodes of their elements lie on them. Where the
    cylinder touches a sphere (``R_c = R``) the matrix ends in a film of zero angle; it is not cut
    off but closed by one curved triangle, two sides of which are tangent at the tip.
    """
    with gmsh_model("bondcell section", _OPTIONS) as gmsh:
        try:
            _draw(gmsh, section)
            _set_size(gmsh, section, size)
            gmsh.model.mesh.generate(2)
            gmsh.model.mesh.setOrder(2)
            mesh = _read(gmsh)
        except Exception as error:  # gmsh raises nothing more specific
            raise BondcellError(f"gmsh could not mesh {section} at size {size}: {error}") from error
    if mesh.is_inverted():
        raise BondcellError(f"a triangle of {section} at size {size} is inverted: reduce the size")
    return mesh


def expected_triangles(section: Section, size: float) -> float:
    """Rough number of triangles: the bulk at the largest size, and the film between the spheres."""
    bulk = section.length / (LARGEST_SIZE * section.largest_radius) ** 2
    film = 2 * np.pi * np.sqrt(min(section.radius_i, section.radius_j) / section.gap)
    return float(2.3 * (bulk + film) / size**2)


class _Side(NamedTuple):
    """One end of the matrix, from a point on the axis to the foot of the lateral line."""

    axis_point: int
    path: list[int]
    foot: int


class _Drawing:
    """Entities of the section by group, in gmsh's built-in kernel (its circle arcs are exact)."""

    def __init__(self, gmsh: ModuleType) -> None:
        self.model = gmsh.model
        self.geo = gmsh.model.geo
        self.curves: defaultdict[str, list[int]] = defaultdict(list)
        self.surfaces: dict[int, int] = {}
        self.undivided: list[int] = []

    def point(self, r: float, z: float) -> int:
        return int(self.geo.addPoint(r, z, 0.0))

    def line(self, group: str, start: int, end: int) -> int:
        self.curves[group].append(self.geo.addLine(start, end))
        return self.curves[group][-1]

    def arc(self, group: str, start: int, centre: int, end: int) -> int:
        self.curves[group].append(self.geo.addCircleArc(start, centre, end))
        return self.curves[group][-1]

    def surface(self, material: int, loop: list[int]) -> None:
        self.surfaces[material] = self.geo.addPlaneSurface([self.geo.addCurveLoop(loop)])

    def particle(self, material: int, plane: str, arc: str, base: float, pole: float) -> _Side:
        """A quarter disc on an end plane, and what the matrix sees of it and of the plane."""
        radius = abs(pole - base)
        centre, top, equator = self.point(0, base), self.point(0, pole), self.point(radius, base)
        flat = self.line(plane, centre, equator)
        if radius < 1 - _TOUCHES:
            foot = self.point(1, base)
            surface = [self.arc(arc, equator, centre, top)]
            path = [-surface[0], self.line(plane, equator, foot)]
        else:
            tip = CUSP_END * (pole - base)
            foot = self.point(1, base + tip)
            split = self.point(float(np.sqrt(radius**2 - tip**2)), base + tip)
            surface = [self.arc(arc, equator, centre, split), self.arc(arc, split, centre, top)]
            closing = self.line("lateral", equator, foot)
            self.undivided += [surface[0], closing]
            path = [-surface[1], -surface[0], closing]
        self.surface(material, [flat, *surface, self.line("axis", top, centre)])
        return _Side(top, path, foot)

    def middle(self, height: float) -> _Side:
        """The mid-plane of a symmetric pair."""
        axis_point = self.point(0, height)
        foot = self.point(1, height)
        return _Side(axis_point, [self.line("top", axis_point, foot)], foot)

    def finish(self) -> None:
        self.geo.synchronize()
        for curve in self.undivided:
            self.model.mesh.setTransfiniteCurve(curve, 2)
        for name, curves in self.curves.items():
            self.model.addPhysicalGroup(1, curves, name=name)
        for material, surface in self.surfaces.items():
            self.model.addPhysicalGroup(2, [surface], tag=material)


def _draw(gmsh: ModuleType, section: Section) -> None:
    drawing = _Drawing(gmsh)
    length = section.length
    lower = drawing.particle(PARTICLE_I, "bottom", "arc_i", 0.0, section.radius_i)
    upper = (
        drawing.middle(length / 2)
        if section.half
        else drawing.particle(PARTICLE_J, "top", "arc_j", length, length - section.radius_j)
    )
    side = drawing.line("lateral", lower.foot, upper.foot)
    axis = drawing.line("axis", upper.axis_point, lower.axis_point)
    drawing.surface(MATRIX, [*lower.path, side, *(-curve for curve in reversed(upper.path)), axis])
    drawing.finish()


def _set_size(gmsh: ModuleType, section: Section, size: float) -> None:
    """Set the local element size.

    h = min(size (|d_i| + |d_j|), size LARGEST_SIZE R, c_i, c_j, a_i, a_j)

    with d the distance to a sphere, so that the sum is the distance between the spheres in the film
    and grows outward. Between sphere and side the film is R_c - R + z^2/(2 R) thick; curved
    elements fit in if they are shorter than
    c = min(size, 1) [sqrt(2 R (R_c - R)) + distance to (R, 0)] / 2. Last, a is half the distance
    to an outer corner, times the size, where corners are to be fine.
    """
    field = gmsh.model.mesh.field
    spheres = ((0.0, section.radius_i), (section.length, section.radius_j))
    film = "+".join(f"Fabs(Sqrt(x^2+(y-{height!r})^2)-{radius!r})" for height, radius in spheres)
    formulas = [f"{size!r}*({film})", repr(size * LARGEST_SIZE * section.largest_radius)]
    shortest = min(size, 1.0) / 2
    for height, radius in spheres:
        clearance = float(np.sqrt(2 * radius * max(1 - radius, 0.0)))
        formulas.append(f"{shortest!r}*({clearance!r}+{_distance(radius, height)})")
        if section.fine_corners and radius < 1 - _TOUCHES:
            formulas.append(f"{shortest!r}*{_distance(1.0, height)}")
    terms = [field.add("MathEval") for _ in formulas]
    for term, formula in zip(terms, formulas, strict=True):
        field.setString(term, "F", formula)
    smallest = field.add("Min")
    field.setNumbers(smallest, "FieldsList", terms)
    field.setAsBackgroundMesh(smallest)


def _distance(r: float, z: float) -> str:
    """Distance to a point, not below `CUSP_END`, as a formula of gmsh in its x and y."""
    return f"Sqrt((x-{r!r})^2+(y-{z!r})^2+{CUSP_END**2!r})"


def _read(gmsh: ModuleType) -> TriangleMesh:
    """Nodes, triangles and groups, numbered from zero; nothing goes through a file."""
    tags, coordinates, _ = gmsh.model.mesh.getNodes()
    number = np.zeros(int(tags.max()) + 1, dtype=np.int64)
    number[tags.astype(np.int64)] = np.arange(tags.size)
    triangles, material, lines = [], [], {}
    for dimension, group in gmsh.model.getPhysicalGroups():
        if dimension == 1:
            nodes, _ = gmsh.model.mesh.getNodesForPhysicalGroup(dimension, group)
            name = gmsh.model.getPhysicalName(dimension, group)
            lines[name] = np.unique(number[nodes.astype(np.int64)])
            continue
        for surface in gmsh.model.getEntitiesForPhysicalGroup(dimension, group):
            _, nodes = gmsh.model.mesh.getElementsByType(_SIX_NODE_TRIANGLE, surface)
            triangles.append(number[nodes.astype(np.int64)].reshape(-1, 6).T)
            material.append(np.full(triangles[-1].shape[1], group))
    points = coordinates.reshape(-1, 3)[:, :2].T
    return TriangleMesh(points, np.hstack(triangles), np.concatenate(material), lines)
