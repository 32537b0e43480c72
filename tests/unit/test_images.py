"""The definitions of images name files that exist, and `.dockerignore` lets them through."""

import re
from pathlib import Path

ROOT = Path(__file__).parents[2]


def copied():
    """What the Dockerfile copies from the project."""
    lines = re.findall(r"^COPY (.+)$", (ROOT / "Dockerfile").read_text(), re.MULTILINE)
    return {name.rstrip("/") for line in lines for name in line.split()[:-1]}


def packed():
    """What the definition for Apptainer takes from the project."""
    text = (ROOT / "bondcell.def").read_text()
    section = text.split("%files\n")[1].split("%post")[0]
    return {line.split()[0] for line in section.strip().splitlines()}


def let_through():
    """What `.dockerignore`, which hides everything else, names as an exception."""
    lines = (ROOT / ".dockerignore").read_text().split()
    assert lines[0] == "*"
    return {line[1:] for line in lines if line.startswith("!")}


def test_copied_files_exist_and_are_not_hidden():
    names = copied() - {"scripts"} | {"scripts/system_deps.sh"}
    assert names <= let_through()
    for name in names | packed():
        assert (ROOT / name).exists(), name


def test_images_install_the_lock_file_with_hashes():
    for name in ("Dockerfile", "bondcell.def"):
        text = (ROOT / name).read_text()
        assert "--require-hashes -r requirements.lock" in text
        assert "system_deps.sh --list" in text


def test_image_holds_what_a_run_needs():
    """All folders that the workflow reads; the documentation and the tests stay outside."""
    snakefile = (ROOT / "Snakefile").read_text()
    assert {"Snakefile", "workflow", "params", "src"} <= copied()
    included = re.findall(r'include: "(\w+)/', snakefile)
    assert set(included) <= copied()
