"""Provenance: says what, with what and where; the same every time."""

import json
import shutil
import subprocess
import sys
from pathlib import Path

import bondcell
from bondcell import provenance
from bondcell.scenes.parsing import parse_scene

GIVEN = {
    "title": "One cell",
    "models": ["fsi"],
    "cell": {
        "radius_i": "7.5 mm",
        "gap": "0.5 mm",
        "young_i": "30 GPa",
        "young_m": "1.4 MPa",
        "poisson_i": 0.25,
        "poisson_m": 0.46,
    },
}


def test_attributes_of_a_scene():
    scene = parse_scene(GIVEN, name="cell")
    found = provenance.collect(scene)
    assert found["title"] == "One cell"
    assert found["scene"] == "cell"
    assert found["summary"] == "One cell"
    assert found["license"] == "BSD-3-Clause"
    assert "PARTICLES 2013" in found["references"]
    assert bondcell.__version__ in found["citation"]
    assert "scene 'cell'" in found["citation"]
    assert json.loads(found["parameters"]) == GIVEN
    versions = json.loads(found["versions"])
    assert {"python", "numpy", "scikit-fem", "gmsh"} <= set(versions)
    assert found["source"] == f"bondcell {bondcell.__version__}"
    assert int(found["cores"]) >= 1
    assert all(isinstance(value, str) and value for value in found.values())
    assert provenance.collect(scene) == found


def revision_of(package: Path) -> str:
    """Revision that the package of a folder names."""
    code = "from bondcell.provenance import source_revision; print(source_revision())"
    done = subprocess.run(
        [sys.executable, "-c", code],
        cwd=package,
        env={"PYTHONPATH": str(package), "PATH": "/usr/bin:/bin"},
        capture_output=True,
        text=True,
        check=True,
    )
    return done.stdout.strip()


def git(folder: Path, *arguments: str) -> str:
    identity = ["-c", "user.name=a", "-c", "user.email=a@b.c"]
    done = subprocess.run(
        ["git", "-C", str(folder), *identity, *arguments],
        capture_output=True,
        text=True,
        check=True,
    )
    return done.stdout.strip()


def test_revision_names_the_commit_of_the_sources_only(tmp_path):
    source = Path(provenance.__file__).parent
    package = tmp_path / "bondcell"
    package.mkdir()
    for name in ("__init__.py", "provenance.py"):
        shutil.copy(source / name, package)
    assert revision_of(tmp_path) == "unknown"
    git(tmp_path, "init", "--quiet")
    (tmp_path / "thesis.tex").write_text("somebody else's repository")
    git(tmp_path, "add", "thesis.tex")
    git(tmp_path, "commit", "--quiet", "--message", "one")
    assert revision_of(tmp_path) == "unknown"
    git(tmp_path, "add", "bondcell")
    git(tmp_path, "commit", "--quiet", "--message", "two")
    commit = git(tmp_path, "rev-parse", "--short", "HEAD")
    assert revision_of(tmp_path) == commit
    (package / "provenance.py").write_text((package / "provenance.py").read_text() + "\n")
    assert revision_of(tmp_path) == f"{commit}-dirty"
