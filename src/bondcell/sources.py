"""Which source files of this package a module rests on: what has to be redone after an edit."""

from __future__ import annotations

import ast
from collections.abc import Iterable, Iterator
from functools import cache
from pathlib import Path

PACKAGE = Path(__file__).parent


def source_files(*modules: str) -> list[Path]:
    """Source files of the package that are loaded with the modules, their own included.

    Read from the import statements at module level, so nothing is imported to find out. What a
    function imports when it is called is not followed: name that module too if the work calls it.
    The file of a parent package counts only where it is itself imported from.

    Parameters
    ----------
    *modules
        Dotted names, ``"bondcell.storage"``.

    Returns
    -------
    list of pathlib.Path
        Sorted.

    Examples
    --------
    >>> [path.name for path in source_files("bondcell.storage")]
    ['errors.py', 'storage.py']
    """
    return _closure(_path(module) for module in modules)


def script_sources(script: str | Path) -> list[Path]:
    """Source files of the package that a script outside it rests on, sorted.

    Parameters
    ----------
    script
        A Python file; it is read, not run. Modules that the package imports only when a function
        is called have to be imported by the script itself to be counted.
    """
    return _closure(_imported(Path(script)))


def _closure(paths: Iterable[Path]) -> list[Path]:
    found: set[Path] = set()
    waiting = list(paths)
    while waiting:
        path = waiting.pop()
        if path not in found:
            found.add(path)
            waiting.extend(_imported(path))
    return sorted(found)


def _path(module: str) -> Path:
    place = PACKAGE.joinpath(*module.split(".")[1:])
    return place / "__init__.py" if place.is_dir() else place.with_suffix(".py")


@cache
def _imported(path: Path) -> tuple[Path, ...]:
    tree = ast.parse(path.read_bytes(), filename=str(path))
    return tuple(_path(name) for name in _imported_modules(tree) if _path(name).is_file())


def _imported_modules(tree: ast.Module) -> Iterator[str]:
    root = PACKAGE.name
    for statement in tree.body:
        if isinstance(statement, ast.Import):
            yield from (a.name for a in statement.names if a.name.split(".")[0] == root)
        elif isinstance(statement, ast.ImportFrom):
            parent = statement.module or ""
            if parent.split(".")[0] != root:
                continue
            names = [f"{parent}.{alias.name}" for alias in statement.names]
            submodules = [name for name in names if _path(name).is_file()]
            yield from submodules
            if len(submodules) < len(names):
                yield parent
