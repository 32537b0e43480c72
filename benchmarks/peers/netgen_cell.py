"""The base cell in NGSolve: lower half of a symmetric pair, order p, axisymmetric, roller ends.

Lengths are in radii and moduli in the matrix's Young's modulus.
"""

import math
from dataclasses import dataclass

import ngsolve as ng
from netgen.occ import Axes, Glue, OCCGeometry, WorkPlane, X, Z


@dataclass(frozen=True)
class Answer:
    """Stiffness in units of ``E_m R``, of the whole cell, and unknowns of the half."""

    stiffness: float
    dof: int


def make_mesh(gap: float, order: int, size: float, tip: float) -> ng.Mesh:
    """Curved triangles; ``size`` is the largest one, ``tip`` the one at the sphere's tip."""
    height = 1 + gap / 2
    plane = Axes((0, 0, 0), Z, X)
    section = WorkPlane(plane).Rectangle(1, height).Face()
    particle = WorkPlane(plane).Circle(0, 0, 1).Face() * section
    matrix = section - particle
    particle.faces.name, matrix.faces.name = "particle", "matrix"
    for edge in [*particle.edges, *matrix.edges]:
        centre = edge.center
        if abs(centre.x) < 1e-9:
            edge.name = "axis"
        elif min(abs(centre.y), abs(centre.y - height)) < 1e-9:
            edge.name = "end" if centre.y < height / 2 else "middle"
    shape = Glue([particle, matrix])
    for vertex in shape.vertices:
        if math.hypot(vertex.p.x, vertex.p.y - 1) < 1e-6:
            vertex.maxh = tip
    mesh = ng.Mesh(OCCGeometry(shape, dim=2).GenerateMesh(maxh=size, grading=0.3))
    mesh.Curve(order)
    return mesh


class NGSolveCell:
    """Space and form of one mesh; the materials are parameters of the form.

    The inner unknowns of each element are condensed, the rest goes to NGSolve's sparse Cholesky
    factorisation, the quickest of its direct solvers at this size.
    """

    def __init__(self, mesh: ng.Mesh, order: int) -> None:
        radial = ng.H1(mesh, order=order, dirichlet="axis")
        axial = ng.H1(mesh, order=order, dirichlet="end|middle")
        self.space = radial * axial
        self.constants = {
            name: (ng.Parameter(1.0), ng.Parameter(1.0)) for name in ("particle", "matrix")
        }
        lame, shear = (
            mesh.MaterialCF({name: pair[k] for name, pair in self.constants.items()})
            for k in (0, 1)
        )
        (u, w), (u_, w_) = self.space.TnT()
        r = ng.x
        (u_r, u_z), (w_r, w_z) = ng.grad(u), ng.grad(w)
        (v_r, v_z), (t_r, t_z) = ng.grad(u_), ng.grad(w_)
        trace = (u_r + u / r + w_z) * (v_r + u_ / r + t_z)
        product = u_r * v_r + u * u_ / r**2 + w_z * t_z + (u_z + w_r) * (v_z + t_r) / 2
        self.form = ng.BilinearForm(self.space, symmetric=True, condense=True)
        self.form += 2 * math.pi * r * (lame * trace + 2 * shear * product) * ng.dx
        self.displacement = ng.GridFunction(self.space)
        self.boundary = mesh.Boundaries("middle")

    def solve(self, ratio: float, poisson_particle: float, poisson_matrix: float) -> Answer:
        """Assemble and solve for one set of materials."""
        values = {"particle": (ratio, poisson_particle), "matrix": (1.0, poisson_matrix)}
        for name, (young, nu) in values.items():
            lame, shear = self.constants[name]
            lame.Set(young * nu / ((1 + nu) * (1 - 2 * nu)))
            shear.Set(young / (2 * (1 + nu)))
        self.form.Assemble()
        matrix, vector = self.form.mat, self.displacement.vec
        vector[:] = 0
        self.displacement.components[1].Set(1, definedon=self.boundary)
        force = vector.CreateVector()
        force.data = -(matrix * vector)
        free = self.space.FreeDofs(coupling=True)
        vector.data += matrix.Inverse(free, inverse="sparsecholesky") * force
        # Condensed, the energy needs no inner unknowns. It is twice the cell's at half the motion.
        energy = ng.InnerProduct(matrix * vector, vector)
        return Answer(energy / 2, sum(self.space.FreeDofs()))
