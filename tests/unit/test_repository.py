"""The repository itself: lock file, make targets, tracked files."""

import re
import subprocess
import tomllib
from pathlib import Path

import pytest
import yaml

ROOT = Path(__file__).parents[2]
LARGEST = 1_000_000
"""Bytes a tracked file may have."""


def read(name: str) -> str:
    return (ROOT / name).read_text(encoding="utf-8")


def normalised(name: str) -> str:
    return re.sub(r"[-_.]+", "-", name).lower()


@pytest.fixture(scope="module")
def pins() -> dict[str, list[str]]:
    """Lock file: every requirement line with the hashes that follow it."""
    found: dict[str, list[str]] = {}
    for entry in re.split(r"\n(?=\S)", read("requirements.lock")):
        lines = [line.strip() for line in entry.splitlines() if not line.strip().startswith("#")]
        if lines:
            found[lines[0].rstrip(" \\")] = re.findall(r"--hash=(\S+)", entry)
    return found


def test_every_pin_is_exact_and_hashed(pins):
    assert len(pins) > 50
    for requirement, hashes in pins.items():
        assert re.fullmatch(r"[\w.\[\]-]+==[\w.+!]+( ; .+)?", requirement), requirement
        assert hashes, requirement
        assert all(re.fullmatch(r"sha256:[0-9a-f]{64}", value) for value in hashes), requirement


def test_lock_names_no_address():
    text = read("requirements.lock")
    assert "://" not in text
    assert "index" not in "".join(line for line in text.splitlines() if line.startswith("-"))


def test_lock_covers_what_the_project_asks_for(pins):
    project = tomllib.loads(read("pyproject.toml"))
    wanted = [*project["build-system"]["requires"], *project["project"]["dependencies"]]
    for extra in ("workflow", "dev"):
        wanted += project["project"]["optional-dependencies"][extra]
    names = {normalised(re.match(r"[\w.-]+", item)[0]) for item in wanted} - {"bondcell"}
    assert names <= {normalised(re.match(r"[\w.-]+", pin)[0]) for pin in pins}


def test_readme_names_targets_that_exist():
    targets = set(re.findall(r"^([a-z][\w-]*):", read("Makefile"), flags=re.MULTILINE))
    named = set(re.findall(r"\bmake ([a-z][\w-]*)", read("README.md") + read("CONTRIBUTING.md")))
    assert {"study", "test"} <= named
    assert named <= targets


def test_readme_starts_with_the_two_commands():
    lines = read("README.md").splitlines()
    commands = [
        line.split("#")[0].strip() for line in lines if re.match(r"(make|pip|pytest) ", line)
    ]
    assert commands[:2] == ["make study", "make test"]


def test_citation_is_valid_and_current():
    """The keys that the format 1.2.0 requires, and the version of the package."""
    cited = yaml.safe_load(read("CITATION.cff"))
    assert {"cff-version", "message", "title", "authors"} <= set(cited)
    assert (cited["cff-version"], cited["type"]) == ("1.2.0", "software")
    project = tomllib.loads(read("pyproject.toml"))["project"]
    assert (cited["version"], cited["license"]) == (project["version"], project["license"])
    for work in (cited, *cited["references"]):
        assert work["title"]
        for author in work["authors"]:
            assert set(author) <= {"name", "family-names", "given-names"}


def test_changelog_has_the_version_or_what_comes():
    heads = re.findall(r"^## \[(.+?)\]", read("CHANGELOG.md"), flags=re.MULTILINE)
    assert heads[0] == "Unreleased"


def tracked_files() -> list[Path]:
    """What git tracks, or nothing where this is no git checkout (a source archive)."""
    if not (ROOT / ".git").exists():
        return []
    done = subprocess.run(
        ["git", "-c", f"safe.directory={ROOT}", "ls-files", "-z"],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=True,
    )
    return [ROOT / name for name in done.stdout.split("\0") if name]


def test_no_large_file_is_tracked():
    sizes = {path: path.stat().st_size for path in tracked_files() if path.is_file()}
    assert not [path for path, size in sizes.items() if size > LARGEST]


def test_scripts_are_executable():
    scripts = [f"scripts/{name}.sh" for name in ("setup_venv", "system_deps", "browser", "lock")]
    for name in (".ci/run", *scripts):
        assert (ROOT / name).stat().st_mode & 0o100, name
        assert read(name).startswith("#!")


def test_script_and_message_name_the_same_system_packages():
    from bondcell.fem.gmsh_session import SYSTEM_PACKAGES

    done = subprocess.run(
        ["sh", ROOT / "scripts" / "system_deps.sh", "--list"],
        capture_output=True,
        text=True,
        check=True,
    )
    assert done.stdout.split() == SYSTEM_PACKAGES.split()


def test_a_missing_browser_is_said_and_fails_nothing(tmp_path):
    done = subprocess.run(
        ["/bin/sh", ROOT / "scripts" / "browser.sh"],
        env={"PATH": str(tmp_path), "HOME": str(tmp_path)},
        capture_output=True,
        text=True,
        check=True,
    )
    assert "will not be tried in a browser" in done.stderr
    assert len(done.stderr.splitlines()) == 1


def test_images_install_the_lock_file_and_copy_what_exists():
    for name in ("Dockerfile", "bondcell.def"):
        text = read(name)
        assert "--require-hashes -r requirements.lock" in text
        assert "system_deps.sh --list" in text
    copied = re.findall(r"^COPY (.+) \S+$", read("Dockerfile"), flags=re.MULTILINE)
    copied += re.findall(r"^    (\S+) /opt/bondcell/", read("bondcell.def"), flags=re.MULTILINE)
    names = {name for group in copied for name in group.split()}
    assert len(names) > 8
    for name in names:
        assert (ROOT / name).exists(), name
        assert f"!{name}" in read(".dockerignore").splitlines(), name
