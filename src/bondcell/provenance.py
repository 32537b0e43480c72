"""Where a result comes from: parameters, versions, source revision, machine, as attributes."""

from __future__ import annotations

import json
import os
import platform
import subprocess
from functools import cache
from importlib.metadata import PackageNotFoundError, metadata, version
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from bondcell.scenes.scene import Scene

PACKAGES = ("bondcell", "numpy", "scipy", "xarray", "netCDF4", "scikit-fem", "gmsh")
"""Distributions whose versions matter to a result."""

UNKNOWN = "unknown"

REFERENCES = (
    "Kacianauskas et al., Interaction of particles via solid interface: model and analysis, "
    "PARTICLES 2013 (the bond cell and the model fsi); the documentation of bondcell "
    "(the models film, bounds, surrogate and the finite element reference)."
)
"""What a result file asks to be read, the attribute ``references`` of CF."""


def collect(scene: Scene) -> dict[str, str]:
    """Global attributes of a result file.

    No time of day is among them: same parameters, versions and machine, same attributes.

    Parameters
    ----------
    scene
        The scene that was computed.
    """
    return {
        "title": scene.title,
        "summary": scene.question or scene.title,
        "scene": scene.name,
        "parameters": scene.given_json,
        **({"design": json.dumps(scene.design.about())} if scene.design else {}),
        "license": _license(),
        "references": REFERENCES,
        "citation": f"bondcell developers: bondcell {_version('bondcell')}, scene {scene.name!r}, "
        f"sources {source_revision()}. See CITATION.cff.",
        **software(),
        **machine(),
    }


def software() -> dict[str, str]:
    """Versions of what computed, and the revision of the sources."""
    return {
        "source": f"bondcell {_version('bondcell')}",
        "source_revision": source_revision(),
        "versions": json.dumps(
            {"python": platform.python_version()} | {name: _version(name) for name in PACKAGES}
        ),
    }


def machine() -> dict[str, str]:
    """The computer, as timings need it: processor, cores that may be used, platform."""
    return {
        "machine": processor(),
        "cores": str(usable_cores()),
        "platform": platform.platform(),
    }


def measuring() -> dict[str, str]:
    """What a timed run should tell beside its machine: threads, and what else was running.

    Asked before the run begins: a load average well above zero means that others had the machine.
    """
    load = f"{os.getloadavg()[0]:.2f}" if hasattr(os, "getloadavg") else UNKNOWN
    return {"threads": os.environ.get("OMP_NUM_THREADS", UNKNOWN), "load_average_before": load}


def usable_cores() -> int:
    """Cores this process may run on."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


@cache
def processor() -> str:
    """Model name of the processor."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8", errors="replace").splitlines()
    except OSError:
        lines = []
    names = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    return names[0] if names else platform.processor() or platform.machine() or UNKNOWN


@cache
def source_revision() -> str:
    """Git revision of the sources, with ``-dirty`` after an edit; ``unknown`` outside git.

    A package that merely lies inside somebody else's repository (in a virtual environment, say) is
    not part of its revision.
    """
    here = Path(__file__)
    if not _git(here.parent, "ls-files", "--error-unmatch", here.name):
        return UNKNOWN
    return _git(here.parent, "describe", "--always", "--dirty", "--exclude=*") or UNKNOWN


def _git(folder: Path, *arguments: str) -> str:
    command = ["git", "-C", str(folder), *arguments]
    try:
        answer = subprocess.run(command, capture_output=True, text=True, check=True, timeout=20)
    except (OSError, subprocess.SubprocessError):
        return ""
    return answer.stdout.strip()


def _version(distribution: str) -> str:
    try:
        return version(distribution)
    except PackageNotFoundError:
        return UNKNOWN


def _license() -> str:
    """The package's own, which its results are under as well."""
    try:
        about = metadata("bondcell")
    except PackageNotFoundError:
        return UNKNOWN
    return str((about.json or {}).get("license_expression", UNKNOWN))
