"""Cost of a study against its number of points: planning, jobs, memory, reading; run by hand.

A Sobol' design over E_i/E_m and nu_m of one geometry, three analytic models and the finite element
reference at every point. `python benchmarks/scale.py 1e2 1e4 -o scale.svg`; without numbers from
1e2 to 1e6, which takes minutes. CPU seconds count all processes; wall times depend on what else
the machine does.
"""

import argparse
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

import matplotlib.pyplot as plt
import xarray as xr

ROOT = Path(__file__).parents[1]
POINTS = (1e2, 1e3, 1e4, 1e5, 1e6)
SCENE = """\
title: Many points
cell: {{radius_i: 7.5 mm, gap: 0.5 mm, young_i: 30 GPa, poisson_i: 0.25}}
design:
  kind: sobol
  points: {points}
  seed: 1
  ranges:
    modulus_ratio: {{start: 1, stop: 1e6, spacing: log}}
    poisson_m: {{start: 0, stop: 0.49}}
models: [fsi, generatrix, slices]
reference: {{tolerance: 1e-5}}
"""
STUDY = "results/many/study.nc"
WANTED = (STUDY, "results/many/accuracy.csv", "results/many/figures")


@dataclass(frozen=True)
class Cost:
    """What a command took: CPU of all its processes, wall time, peak memory of the largest."""

    cpu: float
    wall: float
    megabytes: float
    output: str


def run(folder: Path, *command: str) -> Cost:
    """Run Python in a folder."""
    environment = os.environ | {
        "PYTHONPATH": str(ROOT / "src"),
        "OMP_NUM_THREADS": "1",
        "OPENBLAS_NUM_THREADS": "1",
    }
    start = time.perf_counter()
    with (folder / "log").open("w") as log:
        process = subprocess.Popen(
            [sys.executable, *command], cwd=folder, env=environment, stdout=log, stderr=log
        )
        _, status, used = os.wait4(process.pid, 0)
    output = (folder / "log").read_text()
    if status:
        raise SystemExit(output)
    cpu = used.ru_utime + used.ru_stime
    return Cost(cpu, time.perf_counter() - start, used.ru_maxrss / 1e3, output)


def prepare(folder: Path, points: int) -> None:
    """A scene of so many points, with the workflow beside it."""
    (folder / "params").mkdir()
    (folder / "params/many.yaml").write_text(SCENE.format(points=points))
    (folder / "params/study.yaml").write_text("scenes: [many]\n")
    shutil.copy(ROOT / "Snakefile", folder)
    (folder / "workflow").symlink_to(ROOT / "workflow")
    (folder / "profiles").symlink_to("workflow/profiles")


def reading(path: Path) -> float:
    """Seconds to open a study and read one model at a thousand points in its middle."""
    start = time.perf_counter()
    with xr.open_dataset(path) as study:
        middle = study.sizes["sample"] // 2
        study["stiffness"].isel(model=0, sample=slice(middle, middle + 1000)).load()
    return time.perf_counter() - start


def measure(points: int) -> dict[str, float]:
    """Cost of planning, computing, planning again and reading a study of so many points."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        prepare(folder, points)
        snakemake = ("-m", "snakemake", "--cores", "2", *WANTED)
        plan = run(folder, *snakemake, "--dry-run")
        jobs = re.findall(r"^total +(\d+)$", plan.output, re.MULTILINE)[0]
        whole = run(folder, *snakemake)
        again = run(folder, *snakemake, "--dry-run")
        assert "Nothing to be done" in again.output, again.output
        return {
            "points": points,
            "jobs": int(jobs),
            "plan_cpu": plan.cpu,
            "plan_wall": plan.wall,
            "plan_MB": plan.megabytes,
            "run_cpu": whole.cpu,
            "run_wall": whole.wall,
            "run_MB": whole.megabytes,
            "plan_again_cpu": again.cpu,
            "file_MB": (folder / STUDY).stat().st_size / 1e6,
            "read_s": reading(folder / STUDY),
        }


def draw(rows: list[dict[str, float]], path: str) -> None:
    """Seconds and memory over the number of points."""
    figure, (left, right) = plt.subplots(1, 2, figsize=(8.4, 3.6), layout="constrained")
    points = [row["points"] for row in rows]
    names = {
        "run_cpu": "all jobs, CPU",
        "plan_cpu": "planning, CPU",
        "plan_again_cpu": "planning a finished study, CPU",
        "read_s": "reading a thousand values, wall",
    }
    for (name, label), marker in zip(names.items(), "os^D", strict=True):
        left.loglog(points, [row[name] for row in rows], marker=marker, label=label)
    left.set(xlabel="points", ylabel="time [s]")
    for (name, label), marker in zip(
        {"run_MB": "largest job", "plan_MB": "planning", "file_MB": "study.nc"}.items(),
        "os^",
        strict=True,
    ):
        right.loglog(points, [row[name] for row in rows], marker=marker, label=label)
    right.set(xlabel="points", ylabel="memory, size [MB]")
    for axes in (left, right):
        axes.legend(fontsize=8)
        axes.grid(alpha=0.3)
    figure.savefig(path)


def main() -> None:
    """Measure, print a line for each number of points, draw if asked."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("points", nargs="*", type=float, default=POINTS)
    parser.add_argument("-o", "--output", help="file of the figure")
    arguments = parser.parse_args()
    rows = []
    for points in arguments.points:
        rows.append(measure(int(points)))
        if len(rows) == 1:
            print(" ".join(f"{name:>14}" for name in rows[0]))
        print(" ".join(f"{value:14.4g}" for value in rows[-1].values()), flush=True)
    if arguments.output:
        draw(rows, arguments.output)


if __name__ == "__main__":
    main()
