"""Share of a run of the default study that is not the jobs' own work; by hand, machine quiet.

Own work is what each job says it took, imports excluded, once it had started. `python
benchmarks/overhead.py` runs the study in a temporary folder; with a file of a run's output, its
wall time and cores it only counts: `python benchmarks/overhead.py out.log 165 2`. On a machine that
others use, compare processor times, which the run in a folder of its own prints as well.
"""

import os
import re
import resource
import subprocess
import sys
import tempfile
import time
from collections import defaultdict
from pathlib import Path

ROOT = Path(__file__).parents[1]
LINE = re.compile(r"^\w+: (?P<what>[\w. ,]+): .*?(?P<seconds>[0-9.]+) s$", re.MULTILINE)
ALONE = (
    "convergence study",
    "methods in time",
    "lattices",
    "fe_rigid",
    "fe_elastic",
    "finite_strain",
    "relaxation",
)
"""Work that is timed and has the machine for itself: the other cores stand still meanwhile."""


def run() -> tuple[str, float, int]:
    """Output, wall time and cores of a run in a folder of its own."""
    cores = len(os.sched_getaffinity(0))
    with tempfile.TemporaryDirectory() as folder:
        for name in ("Snakefile", "params", "workflow"):
            (Path(folder) / name).symlink_to(ROOT / name)
        (Path(folder) / "profiles").symlink_to("workflow/profiles")
        log = Path(folder) / "jobs.log"
        environment = os.environ | {
            "PYTHONPATH": str(ROOT / "src"),
            "OMP_NUM_THREADS": "1",
            "OPENBLAS_NUM_THREADS": "1",
            "BONDCELL_JOB_LINES": str(log),
        }
        start = time.perf_counter()
        done = subprocess.run(
            [sys.executable, "-m", "snakemake", "--cores", str(cores)],
            cwd=folder,
            env=environment,
            capture_output=True,
            text=True,
            check=True,
        )
        wall = time.perf_counter() - start
        used = resource.getrusage(resource.RUSAGE_CHILDREN)
        print(f"{used.ru_utime + used.ru_stime:.0f} s of processor time, all processes")
        lines = log.read_text() if log.is_file() else ""
        return lines + done.stdout + done.stderr, wall, cores


def count(output: str, wall: float, cores: int) -> None:
    """Print where the core-seconds of a run went."""
    kinds: defaultdict[str, list[float]] = defaultdict(list)
    for line in LINE.finditer(output):
        kind = "timed alone" if line["what"] in ALONE else "other"
        kinds[kind].append(float(line["seconds"]))
    own = sum(map(sum, kinds.values()))
    still = sum(kinds["timed alone"]) * (cores - 1)
    whole = wall * cores
    jobs = sum(map(len, kinds.values()))
    print(f"{jobs} jobs, {wall:.0f} s on {cores} cores")
    print(f"own work of the jobs            {own:7.1f} s  {own / whole:6.1%}")
    print(f"cores still beside timed work   {still:7.1f} s  {still / whole:6.1%}")
    rest = whole - own - still
    print(f"planning, starts, imports, gaps {rest:7.1f} s  {rest / whole:6.1%}")


if __name__ == "__main__":
    if len(sys.argv) > 1:
        count(Path(sys.argv[1]).read_text(), float(sys.argv[2]), int(sys.argv[3]))
    else:
        count(*run())
