"""What an import costs, and that imports run down the floors only."""

import ast
import json
import subprocess
import sys
from pathlib import Path

import pytest

import bondcell

PACKAGE = Path(bondcell.__file__).parent
HEAVY = {
    "gmsh",
    "matplotlib",
    "pandas",
    "pint",
    "pydantic",
    "scipy",
    "skfem",
    "snakemake",
    "xarray",
}

GROUND = {
    "cell",
    "errors",
    "status",
    "models",
    "fem",
    "lattice",
    "prony",
    "relaxing_ranges",
    "solid",
}
TOP = {"__main__", "cli", "figures", "report"}


def modules_after(code: str) -> set[str]:
    """Top-level modules that a fresh interpreter has loaded after ``code``."""
    code += "\nimport json, sys\nprint(json.dumps(sorted({m.split('.')[0] for m in sys.modules})))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    return set(json.loads(done.stdout.splitlines()[-1]))


def test_import_loads_nothing_heavy():
    loaded = modules_after("import bondcell")
    assert "bondcell" in loaded
    assert not loaded & (HEAVY | {"numpy"})


def test_models_need_no_labels_no_finite_elements_and_no_solver():
    loaded = modules_after("from bondcell import MODELS; list(MODELS)")
    assert not loaded & HEAVY


def test_evaluate_needs_no_finite_elements():
    loaded = modules_after("from bondcell import evaluate")
    assert not loaded & {"gmsh", "matplotlib", "pint", "pydantic", "skfem", "snakemake"}


@pytest.mark.parametrize("name", bondcell.__all__)
def test_every_public_name_is_there(name):
    assert getattr(bondcell, name) is not None
    assert name in dir(bondcell)


def test_unknown_name():
    with pytest.raises(AttributeError, match="no attribute 'nothing'"):
        _ = bondcell.nothing


def test_submodule_does_not_hide_the_function():
    code = "import bondcell.evaluate, bondcell; assert callable(bondcell.evaluate)"
    subprocess.run([sys.executable, "-c", code], check=True)


def floor(module: str) -> int:
    """0 ground, 1 first, 2 top, by the first name below the package."""
    return 0 if module in GROUND else 2 if module in TOP else 1


def imported(path: Path) -> set[str]:
    """First names below ``bondcell``, and top-level names of others, that a source file imports."""
    names = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            names.update(alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.level == 0:
            if node.module == "bondcell":
                names.update(f"bondcell.{alias.name}" for alias in node.names)
            else:
                names.add(node.module)
    return names


SOURCES = sorted(path for path in PACKAGE.rglob("*.py") if path != PACKAGE / "__init__.py")


@pytest.mark.parametrize("path", SOURCES, ids=lambda path: str(path.relative_to(PACKAGE)))
def test_imports_run_down(path):
    own = floor(path.relative_to(PACKAGE).parts[0].removesuffix(".py"))
    names = imported(path)
    below = {name.split(".")[1] for name in names if name.startswith("bondcell.")}
    modules = {path.stem for path in PACKAGE.iterdir()}
    upward = {name for name in below & modules if floor(name) > own}
    assert not upward
    if own == 0:
        labels = {"netCDF4", "pandas", "pint", "pydantic", "snakemake", "xarray", "yaml"}
        assert not labels & {name.split(".")[0] for name in names}
    assert not {name for name in names if name.split(".")[0] == "snakemake"}
