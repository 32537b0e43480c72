"""Speed of the finite element reference against other codes; run by hand.

All codes take turns in one process on one thread; times are medians, so compare them as ratios of
one run. Every code solves the lower half of the symmetric cell on a mesh chosen for the case, mesh
included. NGSolve comes with the optional extra ``peers``, CalculiX is the command ``ccx``; what is
missing is left out.
"""

import os

os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
os.environ.setdefault("NGS_NUM_THREADS", "1")

import argparse
import gc
import importlib.util
import json
import resource
import statistics
import time
from collections.abc import Callable
from dataclasses import asdict, dataclass, field
from pathlib import Path

import numpy as np
import xarray as xr
from peers import calculix_cell

import bondcell
from bondcell.cell import Cell, FloatArray
from bondcell.fem import reference
from bondcell.fem.cell_mesh import Grading
from bondcell.fem.materials import Materials
from bondcell.fem.particle_lag import particle_lag
from bondcell.fem.structured import find_load, geometry_of, solve_level

BASE = {
    "radius_i": 7.5e-3,
    "gap": 5e-4,
    "young_i": 3e10,
    "young_m": 1.4e6,
    "poisson_i": 0.25,
    "poisson_m": 0.46,
}
GAP = BASE["gap"] / BASE["radius_i"]
SMOOTH = Grading(foot=0.08)
"""The base case needs no refinement of the cusp at the foot."""

BASE_STIFFNESS = 162460.76723
"""Of the base case [N/m], orders 12 and 14 on two meshes; another code's is 162460.7672."""

NGSOLVE_SIZES = {"NGSolve p=6": 0.3, "NGSolve p=6, finer": 0.25}
TRIANGLE_SIZE = 0.5


@dataclass
class Row:
    """One code's medians on one task."""

    task: str
    method: str
    points: int
    dof: int
    error: float
    wall: float = 0.0
    cpu: float = 0.0
    runs: list[float] = field(default_factory=list)


Solver = Callable[[], tuple[FloatArray, int]]
"""Stiffnesses [N/m] and unknowns."""


def cpu_seconds() -> float:
    """Processor time of this process and of the commands it ran."""
    usages = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return sum(usage.ru_utime + usage.ru_stime for usage in usages)


def take_turns(task: str, solvers: dict[str, Solver], truth: FloatArray, repeats: int) -> list[Row]:
    """Run all solvers in turn, ``repeats`` times after a first round that does not count."""
    walls: dict[str, list[float]] = {name: [] for name in solvers}
    cpus: dict[str, list[float]] = {name: [] for name in solvers}
    answers = {}
    for _ in range(repeats + 1):
        for name, solver in solvers.items():
            gc.collect()
            wall, cpu = time.perf_counter(), cpu_seconds()
            answers[name] = solver()
            walls[name].append(time.perf_counter() - wall)
            cpus[name].append(cpu_seconds() - cpu)
    rows = []
    for name, (stiffness, dof) in answers.items():
        error = float(np.abs(np.ravel(stiffness) / np.ravel(truth) - 1).max())
        runs = walls[name][1:]
        wall, cpu = statistics.median(runs), statistics.median(cpus[name][1:])
        rows.append(Row(task, name, np.size(truth), dof, error, wall, cpu, runs))
    return rows


def sweep_cells(ratios: FloatArray, poissons: FloatArray) -> Cell:
    """One gap, all pairs of modulus ratio and matrix Poisson's ratio."""
    ratio, poisson = (grid.ravel() for grid in np.meshgrid(ratios, poissons, indexing="ij"))
    values = {"young_m": BASE["young_i"] / ratio, "poisson_m": poisson}
    return Cell.from_values(**BASE | values).ravel()


def exact(cells: Cell) -> FloatArray:
    """Two orders beyond any run here, each point by itself."""
    return np.array(
        [solve_level(cells.take(slice(k, k + 1)), 13).stiffness for k in range(cells.shape[0])]
    )


def structured_point(order: int, grading: Grading | None) -> Solver:
    """Bondcell, one point at one order, without an estimate; particles lag as in the reference."""
    cell = Cell.from_values(**BASE).ravel()

    def solve() -> tuple[FloatArray, int]:
        lag = particle_lag(geometry_of(cell), Materials.of(cell), find_load("normal", "roller"))
        level = solve_level(cell, order, grading=grading, lag=lag)
        return np.array([level.stiffness]), level.dof

    return solve


def structured_sweep(cells: Cell, tolerance: float) -> Solver:
    """Bondcell, many points of one geometry."""

    def solve() -> tuple[FloatArray, int]:
        answer = reference.solve(cells, tolerance=tolerance)
        return answer.stiffness, int(answer.dof.max())

    return solve


def structured_plane(ratios: FloatArray, poissons: FloatArray, tolerance: float) -> Solver:
    """Bondcell through its public function."""
    inputs = {name: BASE[name] for name in ("radius_i", "gap", "young_i", "poisson_i")}
    young = ("ratio", BASE["young_i"] / ratios)
    study = xr.Dataset(inputs, coords={"young_m": young, "poisson_m": poissons})

    def solve() -> tuple[FloatArray, int]:
        out = bondcell.evaluate(study, model="fe", tolerance=tolerance)
        return out.stiffness.values, int(out.dof.max())

    return solve


def ngsolve_points(cells: Cell, order: int, size: float) -> Solver:
    """NGSolve: one mesh, assembled again for each point."""
    from peers import netgen_cell

    def solve() -> tuple[FloatArray, int]:
        mesh = netgen_cell.make_mesh(GAP, order, size, tip=0.2)
        model = netgen_cell.NGSolveCell(mesh, order)
        dof, stiffness = 0, []
        fields = (cells.young_i / cells.young_m, cells.poisson_i, cells.poisson_m)
        points = np.broadcast_arrays(*(np.atleast_1d(value) for value in fields))
        for ratio, nu_i, nu_m in zip(*points, strict=True):
            answer = model.solve(float(ratio), float(nu_i), float(nu_m))
            stiffness.append(answer.stiffness)
            dof = answer.dof
        return np.array(stiffness) * cells.young_m * BASE["radius_i"], dof

    return solve


def calculix_point() -> Solver:
    """CalculiX, one point."""

    def solve() -> tuple[FloatArray, int]:
        ratio = BASE["young_i"] / BASE["young_m"]
        stiffness, dof = calculix_cell.solve(
            GAP, TRIANGLE_SIZE, ratio, BASE["poisson_i"], BASE["poisson_m"]
        )
        return np.array([stiffness * BASE["young_m"] * BASE["radius_i"]]), dof

    return solve


def has_ngsolve() -> bool:
    """Whether the extra ``peers`` is installed."""
    return importlib.util.find_spec("ngsolve") is not None


def base_point(repeats: int) -> list[Row]:
    """One base point."""
    cell = Cell.from_values(**BASE)
    solvers = {
        "bondcell p=8": structured_point(8, SMOOTH),
        "bondcell estimate": structured_sweep(cell, 1e-6),
    }
    if has_ngsolve():
        for name, size in NGSOLVE_SIZES.items():
            solvers[name] = ngsolve_points(cell, 6, size)
    if calculix_cell.is_there():
        solvers["CalculiX CAX6"] = calculix_point()
    return take_turns("base point", solvers, np.array([BASE_STIFFNESS]), repeats)


def fifty_points(repeats: int) -> list[Row]:
    """Five ratios by ten Poisson's ratios."""
    cells = sweep_cells(np.geomspace(1e2, 1e6, 5), np.linspace(0, 0.46, 10))
    solvers = {"bondcell": structured_sweep(cells, 1e-6)}
    if has_ngsolve():
        solvers["NGSolve p=6"] = ngsolve_points(cells, 6, NGSOLVE_SIZES["NGSolve p=6"])
    return take_turns("50 points", solvers, exact(cells), repeats)


def plane(repeats: int) -> list[Row]:
    """A hundred ratios by a hundred Poisson's ratios; the error on a sample."""
    ratios, poissons = np.geomspace(1e2, 1e6, 100), np.linspace(0, 0.49, 100)
    solver = structured_plane(ratios, poissons, 1e-6)
    sample = np.ix_(range(0, 100, 24), range(3, 100, 24))
    cells = sweep_cells(ratios[sample[0].ravel()], poissons[sample[1].ravel()])

    def sampled() -> tuple[FloatArray, int]:
        stiffness, dof = solver()
        return stiffness[sample], dof

    rows = take_turns("plane", {"bondcell": sampled}, exact(cells), repeats)
    rows[0].points = ratios.size * poissons.size
    return rows


def by_dof(repeats: int) -> list[Row]:
    """The base point at several orders."""
    truth = np.array([BASE_STIFFNESS])
    cell = Cell.from_values(**BASE)
    solvers = {f"bondcell p={p}": structured_point(p, None) for p in (4, 6, 8, 10, 12)}
    if has_ngsolve():
        solvers |= {f"NGSolve p={p}": ngsolve_points(cell, p, 0.3) for p in (2, 4, 6, 8)}
    return take_turns("dof", solvers, truth, repeats)


def by_points(repeats: int) -> list[Row]:
    """Sweeps of growing size."""
    rows = []
    for count in (1, 10, 100, 1000):
        ratios = np.geomspace(1e2, 1e6, max(1, count // 10))
        cells = sweep_cells(ratios, np.linspace(0, 0.46, min(count, 10)))
        solvers = {"bondcell": structured_sweep(cells, 1e-6)}
        if has_ngsolve() and count <= 100:
            solvers["NGSolve p=6"] = ngsolve_points(cells, 6, NGSOLVE_SIZES["NGSolve p=6"])
        rows += take_turns("number of points", solvers, np.full(cells.shape[0], np.nan), repeats)
    return rows


def print_table(rows: list[Row]) -> None:
    """Times, and as multiples of the first row of each task."""
    print(
        f"{'task':18}{'method':20}{'points':>8}{'dof':>7}{'error':>10}{'wall s':>10}{'cpu s':>10}"
    )
    first: dict[str, Row] = {}
    for row in rows:
        own = first.setdefault(f"{row.task} {row.points}", row)
        wall, cpu = row.wall / own.wall, row.cpu / own.cpu
        numbers = f"{row.points:8}{row.dof:7}{row.error:10.1e}{row.wall:10.4f}{row.cpu:10.4f}"
        print(f"{row.task:18}{row.method:20}{numbers}{wall:9.2f}{cpu:9.2f}")


def draw(rows: list[Row], path: Path) -> None:
    """Cost against the number of points and against the unknowns."""
    from matplotlib.figure import Figure
    from matplotlib.ticker import NullFormatter

    figure = Figure(figsize=(9, 4), layout="constrained")
    left, right = figure.subplots(1, 2)
    for axes, task, x in ((left, "number of points", "points"), (right, "dof", "dof")):
        for code in ("bondcell", "NGSolve"):
            chosen = [row for row in rows if row.task == task and row.method.startswith(code)]
            if chosen:
                values = [getattr(row, x) for row in chosen]
                axes.loglog(values, [row.cpu for row in chosen], "o-", label=code)
                if x == "dof":
                    for value, row in zip(values, chosen, strict=True):
                        axes.annotate(f"  {row.error:.0e}", (value, row.cpu), fontsize="small")
        for axis in (axes.xaxis, axes.yaxis):
            axis.set_minor_formatter(NullFormatter())
        axes.set(xlabel="points" if x == "points" else "unknowns", ylabel="processor time [s]")
        axes.grid(alpha=0.3, which="both")
    left.set_title("sweeps of one geometry")
    right.set_title("one point, by order, with its error")
    right.margins(x=0.2)
    left.legend()
    figure.savefig(path)


def main() -> None:
    """Run the tasks."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--repeats", type=int, default=5)
    parser.add_argument("--json", type=Path, help="write the numbers to this file")
    parser.add_argument("--figure", type=Path, help="draw cost against points and unknowns")
    arguments = parser.parse_args()
    if has_ngsolve():
        import ngsolve

        ngsolve.SetNumThreads(1)
    else:
        print("NGSolve is not installed: left out (pip install bondcell[peers])")
    if not calculix_cell.is_there():
        print("ccx is not installed: CalculiX left out")
    repeats = arguments.repeats
    rows = base_point(2 * repeats + 1) + fifty_points(min(repeats, 3)) + plane(min(repeats, 3))
    if arguments.figure or arguments.json:
        rows += by_dof(min(repeats, 3)) + by_points(min(repeats, 3))
    print_table(rows)
    if arguments.json:
        known = (asdict(row) | ({} if np.isfinite(row.error) else {"error": None}) for row in rows)
        arguments.json.write_text(json.dumps(list(known), indent=1))
    if arguments.figure:
        draw(rows, arguments.figure)


if __name__ == "__main__":
    main()
