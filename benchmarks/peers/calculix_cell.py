"""The base cell in CalculiX: six-node axisymmetric triangles (CAX6) on bondcell's own gmsh mesh."""

import shutil
import subprocess
import tempfile
from pathlib import Path

import numpy as np

from bondcell.fem.gmsh_mesh import Section, triangle_mesh
from bondcell.fem.section_mesh import MATRIX, PARTICLE_I, TriangleMesh

SECTOR = 2.0
"""CalculiX turns the section into a wedge of so many degrees; reactions are the wedge's."""


def is_there() -> bool:
    """Whether the command is installed."""
    return shutil.which("ccx") is not None


def solve(
    gap: float, size: float, ratio: float, poisson_particle: float, poisson_matrix: float
) -> tuple[float, int]:
    """Mesh, write, run and read: stiffness in units of ``E_m R`` and unknowns of the half."""
    mesh = triangle_mesh(Section(1.0, 1.0, gap, half=True), size)
    with tempfile.TemporaryDirectory() as folder:
        deck = _deck(mesh, ratio, poisson_particle, poisson_matrix)
        Path(folder, "cell.inp").write_text(deck)
        subprocess.run(["ccx", "-i", "cell"], cwd=folder, check=True, capture_output=True)
        lines = Path(folder, "cell.dat").read_text().splitlines()
    numbers = [line.split() for line in lines if line.strip()]
    reaction = float(numbers[-1][1])
    return reaction * 360 / SECTOR / 2, 2 * mesh.points.shape[1]


def _deck(mesh: TriangleMesh, ratio: float, poisson_particle: float, poisson_matrix: float) -> str:
    nodes = [f"{k + 1}, {r:.16g}, {z:.16g}, 0" for k, (r, z) in enumerate(mesh.points.T)]
    deck = ["*NODE, NSET=ALL", *nodes]
    materials = {
        "PARTICLE": (PARTICLE_I, ratio, poisson_particle),
        "BOND": (MATRIX, 1.0, poisson_matrix),
    }
    for name, (number, young, poisson) in materials.items():
        chosen = np.flatnonzero(mesh.material == number)
        deck += [f"*ELEMENT, TYPE=CAX6, ELSET={name}"]
        deck += [
            f"{element + 1}, " + ", ".join(str(node + 1) for node in mesh.triangles[:, element])
            for element in chosen
        ]
        deck += [f"*MATERIAL, NAME={name}", "*ELASTIC", f"{young:.16g}, {poisson:.16g}"]
        deck += [f"*SOLID SECTION, ELSET={name}, MATERIAL={name}"]
    for name in ("axis", "bottom", "top"):
        deck += [f"*NSET, NSET={name.upper()}", *(f"{node + 1}," for node in mesh.lines[name])]
    deck += ["*STEP", "*STATIC", "*BOUNDARY", "AXIS, 1, 1", "BOTTOM, 2, 2", "TOP, 2, 2, 1.0"]
    deck += ["*NODE PRINT, NSET=TOP, TOTALS=ONLY", "RF", "*END STEP", ""]
    return "\n".join(deck)
