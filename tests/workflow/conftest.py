"""A copy of the workflow and the package in a temporary folder, with small scenes, free to edit."""

import json
import os
import re
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from bondcell.sources import script_sources

ROOT = Path(__file__).parents[2]

PLAIN = """\
title: Models alone
cell: {radius_i: 7.5 mm, young_i: 30 GPa, poisson_i: 0.25, poisson_m: 0.3}
sweep: {gap: [0.5 mm, 2 mm], modulus_ratio: [10, 1e4]}
models: [fsi, generatrix]
contributions: true
"""

FULL = """\
title: All there is
cell: {radius_i: 7.5 mm, young_i: 30 GPa, poisson_i: 0.25, poisson_m: 0.3}
sweep: {gap: [0.5 mm, 2 mm], modulus_ratio: [10, 1e4]}
models: [fsi, generatrix]
reference: {bc: [roller, confined], tolerance: 1e-2}
load: [normal, torsion]
stability: true
convergence:
  cases: {base: {gap: 1 mm, young_m: 1 MPa}}
  orders: [3, 4]
  repeats: 1
"""

# Every process that ends well leaves the names of its modules behind, a job's under its scene.
SITECUSTOMIZE = """\
import atexit, json, os, sys
def leave():
    name = os.path.basename(sys.argv[0] if sys.argv else "")
    job = getattr(sys.modules["__main__"], "snakemake", None)
    scene = getattr(getattr(job, "wildcards", None), "scene", "")
    path = os.path.join(os.environ["MODULES_FOLDER"], f"{name}.{scene}.{os.getpid()}.json")
    with open(path, "w") as file:
        json.dump(sorted(sys.modules), file)
if "MODULES_FOLDER" in os.environ:
    atexit.register(leave)
"""


class Workspace:
    """The folder, and what can be done in it."""

    def __init__(self, folder: Path, **scenes: str) -> None:
        self.folder = folder
        ignored = shutil.ignore_patterns("__pycache__")
        shutil.copytree(ROOT / "src", folder / "src", ignore=ignored)
        shutil.copytree(ROOT / "workflow", folder / "workflow", ignore=ignored)
        shutil.copy(ROOT / "Snakefile", folder)
        (folder / "profiles").symlink_to("workflow/profiles")
        (folder / "src" / "sitecustomize.py").write_text(SITECUSTOMIZE)
        self.modules_folder = folder / "modules"
        self.modules_folder.mkdir()
        (folder / "params").mkdir()
        for name, text in scenes.items():
            self.write(f"params/{name}.yaml", text)
        self.write("params/study.yaml", f"scenes: [{', '.join(scenes)}]\n")
        self.environment = os.environ | {
            "PYTHONPATH": str(folder / "src"),
            "MODULES_FOLDER": str(self.modules_folder),
        }

    def __truediv__(self, name: str) -> Path:
        return self.folder / name

    def write(self, name: str, text: str) -> None:
        (self.folder / name).write_text(text)

    def append(self, name: str, text: str) -> None:
        self.write(name, (self.folder / name).read_text() + text)

    def snakemake(
        self, *arguments: str, preexec_fn: Callable[[], None] | None = None
    ) -> subprocess.CompletedProcess[str]:
        """Run Snakemake on two cores; standard output and error come together."""
        for file in self.modules_folder.iterdir():
            file.unlink()
        return subprocess.run(
            [sys.executable, "-m", "snakemake", "--cores", "2", *arguments],
            cwd=self.folder,
            env=self.environment,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            check=False,
            preexec_fn=preexec_fn,
        )

    def modules(self) -> dict[str, set[str]]:
        """Script -> modules that its processes of the last run had loaded."""
        loaded: dict[str, set[str]] = {}
        for file in self.modules_folder.iterdir():
            is_script = file.name.startswith("tmp")  # tmp<something>.<script>.py.<scene>.<...>
            script = file.name.split(".")[1] if is_script else "snakemake"
            loaded.setdefault(script, set()).update(json.loads(file.read_text()))
        return loaded

    def modules_of_scenes(self) -> dict[tuple[str, str], set[str]]:
        """(scene, script) -> modules that the jobs of the last run had loaded."""
        loaded: dict[tuple[str, str], set[str]] = {}
        for file in self.modules_folder.glob("tmp*"):  # tmp<something>.<script>.py.<scene>.<...>
            _, script, _, scene, *_ = file.name.split(".")
            loaded.setdefault((scene, script), set()).update(json.loads(file.read_text()))
        return loaded

    def scripts(self) -> list[Path]:
        """The workflow's scripts."""
        return sorted((self.folder / "workflow/scripts").glob("*.py"))

    def undeclared(self, script: Path, modules: dict[str, set[str]]) -> set[tuple[str, ...]]:
        """Files of the package that a script's jobs loaded, but the models, and it does not say."""
        package = self.folder / "src/bondcell"
        declared = {
            path.parts[path.parts.index("bondcell") + 1 :] for path in script_sources(script)
        }
        names = {name for name in modules[script.stem] if name.startswith("bondcell.")}
        paths = {package.joinpath(*name.split(".")[1:]) for name in names}
        files = {
            path / "__init__.py" if path.is_dir() else path.with_suffix(".py") for path in paths
        }
        loaded = {file.relative_to(package).parts for file in files}
        return {parts for parts in loaded - declared if parts[0] != "models"}

    def plans(self, edits: dict[str, tuple[str, str, str]]) -> dict[str, dict[str, int]]:
        """Name of an edit -> rules that it would make run, and how often."""
        outputs = self._planned(edits)
        return {name: planned_rules(text) for name, text in outputs.items()}

    def dry_runs(self, targets: list[str]) -> dict[str, str]:
        """Target -> what a dry run prints, its exit status at the end."""
        return self._planned(targets)

    def _planned(self, asked: Any) -> dict[str, str]:
        done = subprocess.run(
            [sys.executable, Path(__file__).with_name("plans.py")],
            cwd=self.folder,
            env=self.environment,
            input=json.dumps(asked),
            capture_output=True,
            text=True,
            check=False,
        )
        assert done.returncode == 0, done.stderr
        return json.loads(done.stdout)


def planned_rules(output: str) -> dict[str, int]:
    """Rules in the output of a dry run, and how often each would run."""
    assert "exit status 0" in output, output
    if "Nothing to be done" in output:
        return {}
    stats = output.rpartition("Job stats:")[2].partition("total")[0]
    found = re.findall(r"^(\w+) +(\d+)$", stats, re.MULTILINE)
    return {rule: int(count) for rule, count in found if rule != "all"}


@pytest.fixture(scope="session")
def make_workspace():
    return Workspace


@pytest.fixture(scope="session")
def plain_run(tmp_path_factory):
    """A fresh workspace in which the scene without a reference was computed.

    Gives the workspace, the finished run and the modules by script.
    """
    workspace = Workspace(tmp_path_factory.mktemp("study"), full=FULL, plain=PLAIN)
    done = workspace.snakemake("results/plain/study.nc", "results/plain/figures")
    return workspace, done, workspace.modules()


@pytest.fixture(scope="session")
def full_run(plain_run):
    """The same workspace after the whole study."""
    workspace, _, _ = plain_run
    done = workspace.snakemake()
    return workspace, done, workspace.modules()


@pytest.fixture(scope="session")
def workspace(full_run):
    """The workspace in which everything is computed."""
    workspace, done, _ = full_run
    assert done.returncode == 0, done.stdout
    return workspace
