"""The specimen at the paper's size: time and peak memory by unknowns; run by hand.

``python benchmarks/specimen.py`` solves with elastic particles at one mesh (default: 1.2 million
unknowns in the half model; ``--per-gap 1 --order 3`` is as near to the limit); ``--ladder`` gives
the table of meshes of the rigid path, ``--spheres 100000`` a lattice of that many random spheres.
One thread; times are of the processor, so that others on the machine disturb them less.
"""

import os

os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import argparse
import json
import resource
import time

import numpy as np

from bondcell.lattice.bonds import bonds
from bondcell.lattice.lattice import lattice
from bondcell.lattice.packing import packing
from bondcell.lattice.solve import solve
from bondcell.lattice.specimen_geometry import DISPLACEMENT, LOADED
from bondcell.solid.elastic import solve_elastic
from bondcell.solid.rigid import condense
from bondcell.specimen.bonds import Material
from bondcell.specimen.solid_half import (
    extrapolate,
    half_specimen,
    materials,
    specimen_mesh,
    supports,
)

PAPER_SIZE = 0.28
"""Element size per gap at 1.2 million unknowns."""

LADDER = (1.0, 0.5, 0.33, 0.25)


def peak() -> float:
    """Peak memory so far [GB]."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6


def timed(call, *arguments, **more):
    started = time.process_time()
    return call(*arguments, **more), time.process_time() - started


def report(**values) -> None:
    print(json.dumps({k: float(v) if isinstance(v, np.floating) else v for k, v in values.items()}))


def elastic(per_gap: float, order: int) -> None:
    mesh, meshing = timed(specimen_mesh, per_gap, order)
    report(task="mesh", elements=len(mesh.nodes), unknowns=3 * len(mesh.points), cpu=meshing)
    held, loaded = supports(mesh, "free"), np.array(LOADED)
    way = np.array([[DISPLACEMENT, 0.0]])
    own = materials(Material())
    found, seconds = timed(solve_elastic, mesh, half_specimen(), *own, held, loaded, way)
    report(
        task="elastic, horizontal",
        order=order,
        dof=found.dof,
        iterations=found.iterations,
        cpu=seconds,
        peak_gb=peak(),
        energy=2 * found.energy[0],
        norm=np.sqrt((found.motion[:, :2] ** 2).sum()),
    )


def ladder(sizes: list[float]) -> None:
    energies = []
    for size in sizes:
        mesh, meshing = timed(specimen_mesh, size)
        held = supports(mesh, "free")
        own = materials(Material())[0]
        found, seconds = timed(condense, mesh, half_specimen(), own, held)
        ways = DISPLACEMENT * np.eye(2)
        energies.append([2 * found.solve(np.array(LOADED), way)[2] for way in ways])
        report(
            task="rigid",
            per_gap=size,
            dof=found.dof,
            iterations=found.iterations,
            cpu_mesh=meshing,
            cpu=seconds,
            peak_gb=peak(),
            energy_x=energies[-1][0],
            energy_y=energies[-1][1],
        )
    limit, error = extrapolate(sizes, np.array(energies))
    report(task="limit", energy=limit.tolist(), relative_error_of_finest=error.tolist())


def spheres(count: int) -> None:
    """A disordered grid of spheres of several sizes, pulled between two opposite sides."""
    side = round(count ** (1 / 3))
    rng = np.random.default_rng(1)
    centres = np.stack(np.meshgrid(*[np.arange(side)] * 3, indexing="ij"), -1).reshape(-1, 3)
    centres = centres + rng.uniform(-0.12, 0.12, centres.shape)
    radii = rng.uniform(0.30, 0.37, len(centres))

    def build():
        packed = packing(centres, radii)
        pairs = packed.neighbours(0.55)
        gaps = packed.gaps(pairs)
        i, j = radii[pairs].T
        mean = 2 * i * j / (i + j)
        normal = 1e6 * mean * np.log1p(mean / gaps)
        turning = 0.1 * normal * mean**2
        pivot = (i + gaps / 2) / (i + j + gaps)
        return lattice(centres, bonds(pairs, normal, 0.2 * normal, turning, turning, pivot))

    own, building = timed(build)
    held, values = np.zeros((2, own.count, 6))
    bottom, top = centres[:, 2] < 0.5, centres[:, 2] > side - 1.5
    held[bottom | top], values[top, 2] = 1, 0.01
    found, seconds = timed(solve, own, held, values)
    report(
        task="spheres",
        spheres=own.count,
        bonds=own.bonds.count,
        dof=found.dof,
        iterations=found.iterations,
        cpu=building + seconds,
        peak_gb=peak(),
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--per-gap", type=float, default=PAPER_SIZE)
    parser.add_argument("--order", type=int, default=2)
    parser.add_argument("--ladder", type=float, nargs="*")
    parser.add_argument("--spheres", type=int)
    options = parser.parse_args()
    if options.spheres:
        spheres(options.spheres)
    elif options.ladder is not None:
        ladder(options.ladder or list(LADDER))
    else:
        elastic(options.per_gap, options.order)


if __name__ == "__main__":
    main()
