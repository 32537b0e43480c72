"""What Slurm costs: the smoke study on a Slurm of one node, and without; needs root."""

import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
from datetime import datetime
from pathlib import Path

ROOT = Path(__file__).parents[1]
NODE = ROOT / "tests/workflow/slurm_node.sh"
TARGETS = ("results/smoke/study.nc", "results/smoke/accuracy.csv", "results/smoke/figures")
ON_SLURM = (
    *("--profile", "workflow/profiles/slurm"),
    *("--slurm-status-command", "squeue"),
    *("--slurm-init-seconds-before-status-checks", "4"),
)


def run(folder: Path, *options: str) -> float:
    """Wall time of the study in a copy of the project [s]."""
    for name in ("src", "workflow", "params"):
        shutil.copytree(ROOT / name, folder / name)
    shutil.copy(ROOT / "Snakefile", folder)
    (folder / "profiles").symlink_to("workflow/profiles")
    environment = os.environ | {"PYTHONPATH": str(folder / "src")}
    started = time.perf_counter()
    command = [sys.executable, "-m", "snakemake", *options, *TARGETS]
    done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True)
    if done.returncode:
        sys.exit(done.stdout + done.stderr)
    return time.perf_counter() - started


def seconds_of_jobs(log: str) -> list[float]:
    """Time that each job of Slurm ran [s]."""
    times = re.findall(r"StartTime=(\S+) EndTime=(\S+)", log)
    return [
        (datetime.fromisoformat(end) - datetime.fromisoformat(start)).total_seconds()
        for start, end in times
    ]


def main() -> None:
    """Print wall times, jobs and what is neither."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        started = subprocess.run([NODE, "start", folder / "slurm"], text=True, capture_output=True)
        if started.returncode:
            print(f"no Slurm here: {started.stderr.strip()}")
            return
        try:
            there = run(folder / "there", *ON_SLURM)
            log = (folder / "slurm/completed.log").read_text()
        finally:
            subprocess.run([NODE, "stop", folder / "slurm"], check=True)
        here = run(folder / "here", "--cores", "2")
    jobs = seconds_of_jobs(log)
    load = os.getloadavg()[0]
    print(f"load average {load:.1f}, {os.cpu_count()} cores")
    print(f"without Slurm  {here:6.1f} s")
    print(f"with Slurm     {there:6.1f} s: {len(jobs)} jobs, {sum(jobs):.0f} s in them", jobs)
    print(f"beside them    {there - sum(jobs):6.1f} s: queue, polling, planning, tables, figures")


if __name__ == "__main__":
    main()
