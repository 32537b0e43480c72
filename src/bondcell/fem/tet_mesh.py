"""Second-order tetrahedra of a quarter of the bond cell, made by gmsh.

The quarter is ``x >= 0, y >= 0``: every load is symmetric or antisymmetric in both planes. The unit
of length is the cylinder radius.
"""

from __future__ import annotations

from dataclasses import dataclass
from types import ModuleType

import numpy as np
from numpy.typing import NDArray
from skfem import MeshTet2

from bondcell.cell import FloatArray
from bondcell.errors import BondcellError
from bondcell.fem.gmsh_session import gmsh_model

MATRIX, PARTICLE_I, PARTICLE_J = 0, 1, 2

FILM = 2.0
"""Elements of ``size = 1`` are at most this many film thicknesses long."""

RIM = 0.2
"""Elements of ``size = 1`` at the rims of the end planes, where stress is singular if held."""

_TEN_NODE_TETRAHEDRON = 11
_SCIKIT_FEM_ORDER = [0, 1, 2, 3, 4, 5, 6, 7, 9, 8]
_OPTIONS = {"Mesh.SecondOrderLinear": 0, "Mesh.OptimizeThreshold": 0.6}


@dataclass(frozen=True)
class Body:
    """The cell's dimensions in units of the cylinder radius; both spheres are smaller than it.

    Parameters
    ----------
    radius_i, radius_j, gap
        As in `bondcell.cell.Cell`.
    """

    radius_i: float
    radius_j: float
    gap: float

    @property
    def length(self) -> float:
        """``L = R_i + R_j + L_g``."""
        return self.radius_i + self.radius_j + self.gap

    @property
    def spheres(self) -> tuple[tuple[int, float, float], ...]:
        """Material, height of the centre and radius of both spheres."""
        return (PARTICLE_I, 0.0, self.radius_i), (PARTICLE_J, self.length, self.radius_j)


@dataclass(frozen=True)
class TetMesh:
    """Second-order tetrahedra.

    Parameters
    ----------
    grid
        Nodes and elements; mid-nodes of the spheres' elements lie on the spheres.
    material
        `MATRIX`, `PARTICLE_I` or `PARTICLE_J` of each element, shape (elements,).
    """

    grid: MeshTet2
    material: NDArray[np.int64]

    @property
    def points(self) -> FloatArray:
        """Coordinates of all nodes, shape (3, nodes)."""
        return np.asarray(self.grid.doflocs)

    def scaled(self, unit: float) -> TetMesh:
        """The same mesh with ``unit`` as its unit of length."""
        return TetMesh(self.grid.scaled(unit), self.material)

    def nodes_of(self, material: int) -> NDArray[np.int64]:
        """Nodes of the closed region of one material."""
        return np.unique(self.grid.dofs.element_dofs[:, self.material == material])


def tet_mesh(body: Body, size: float) -> TetMesh:
    """Mesh a quarter of the cell.

    Parameters
    ----------
    body
        The geometry.
    size
        Largest element relative to the larger sphere. Elements are shorter where the matrix is
        thin: at most `FILM` times the size times its thickness.

    Raises
    ------
    MissingLibrary
        gmsh or a system library of it is absent.
    BondcellError
        gmsh could not mesh the body, or an element came out inverted.
    """
    with gmsh_model("bondcell quarter", _OPTIONS) as gmsh:
        try:
            volumes = _draw(gmsh, body)
            _set_size(gmsh, body, size)
            gmsh.model.mesh.generate(3)
            gmsh.model.mesh.setOrder(2)
            mesh = _read(gmsh, volumes)
        except Exception as error:  # gmsh raises nothing more specific
            raise BondcellError(f"gmsh could not mesh {body} at size {size}: {error}") from error
    if _smallest_jacobian(mesh) <= 0:
        raise BondcellError(f"a tetrahedron of {body} at size {size} is inverted: reduce the size")
    return mesh


def _draw(gmsh: ModuleType, body: Body) -> dict[int, int]:
    """Draw the quarter cylinder with the spheres in it; volume of each material."""
    occ, quarter = gmsh.model.occ, np.pi / 2
    cylinder = occ.addCylinder(0, 0, 0, 0, 0, body.length, 1.0, angle=quarter)
    spans = ((0.0, quarter), (-quarter, 0.0))
    balls = [
        (3, occ.addSphere(0, 0, height, radius, -1, *span, quarter))
        for (_, height, radius), span in zip(body.spheres, spans, strict=True)
    ]
    _, pieces = occ.fragment([(3, cylinder)], balls)
    occ.synchronize()
    (_, i), (_, j) = pieces[1][0], pieces[2][0]
    (matrix,) = [tag for _, tag in pieces[0] if tag not in (i, j)]
    return {MATRIX: matrix, PARTICLE_I: i, PARTICLE_J: j}


def _set_size(gmsh: ModuleType, body: Body, size: float) -> None:
    """Set the local element size.

    h = size min(R, R_i + |d_i|, R_j + |d_j|, FILM (|d_i| + |d_j|), FILM (|d_i| + d_c),
    FILM (|d_j| + d_c), RIM + a_i, RIM + a_j)

    with R the larger radius and d the distances to the spheres and to the cylinder's side: in a
    film between two of these surfaces the sum of their distances is its thickness. Last, a is the
    distance to the rim of an end plane.
    """
    field = gmsh.model.mesh.field
    walls = ["Fabs(1-Sqrt(x^2+y^2))"]
    walls += [f"Fabs(Sqrt(x^2+y^2+(z-{h!r})^2)-{radius!r})" for _, h, radius in body.spheres]
    formulas = [repr(size * max(body.radius_i, body.radius_j))]
    formulas += [
        f"{size!r}*({radius!r}+{wall})"
        for wall, (_, _, radius) in zip(walls[1:], body.spheres, strict=True)
    ]
    formulas += [
        f"{size!r}*({RIM!r}+Sqrt((1-Sqrt(x^2+y^2))^2+(z-{height!r})^2))"
        for _, height, _ in body.spheres
    ]
    for k, wall in enumerate(walls):
        formulas += [f"{size * FILM!r}*({wall}+{other})" for other in walls[:k]]
    terms = [field.add("MathEval") for _ in formulas]
    for term, formula in zip(terms, formulas, strict=True):
        field.setString(term, "F", formula)
    smallest = field.add("Min")
    field.setNumbers(smallest, "FieldsList", terms)
    field.setAsBackgroundMesh(smallest)


def _read(gmsh: ModuleType, volumes: dict[int, int]) -> TetMesh:
    """Nodes and elements; nothing goes through a file."""
    tags, coordinates, _ = gmsh.model.mesh.getNodes()
    number = np.zeros(int(tags.max()) + 1, dtype=np.int64)
    number[tags.astype(np.int64)] = np.arange(tags.size)
    elements, material = [], []
    for name, volume in volumes.items():
        _, nodes = gmsh.model.mesh.getElementsByType(_TEN_NODE_TETRAHEDRON, volume)
        elements.append(number[nodes.astype(np.int64)].reshape(-1, 10).T[_SCIKIT_FEM_ORDER])
        material.append(np.full(elements[-1].shape[1], name))
    points = np.ascontiguousarray(coordinates.reshape(-1, 3).T)
    grid = MeshTet2(points, np.hstack(elements))
    return TetMesh(grid, np.concatenate(material))


def _smallest_jacobian(mesh: TetMesh) -> float:
    """Smallest Jacobian determinant at a node, over the straight tetrahedron's."""
    mapping = mesh.grid.mapping()
    curved = mapping.detDF(np.asarray(mesh.grid.elem.doflocs).T)
    corners = mesh.points[:, mesh.grid.t]
    straight = np.linalg.det((corners[:, 1:] - corners[:, :1]).transpose(2, 0, 1))
    return float((curved / straight[:, np.newaxis]).min())
