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
    Subpackages on the way to a module count, as they are loaded with it; the package's own root
    does not, since it only passes names on.

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
    ['errors.py', 'replacing.py', 'sealed_files.py', 'storage.py']
    """
    return _closure(_path(name) for module in modules for name in _with_parents(module))


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
    names = [name for module in _imported_modules(tree) for name in _with_parents(module)]
    return tuple(path for path in dict.fromkeys(map(_path, names)) if path.is_file())


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


def _with_parents(module: str) -> Iterator[str]:
    """A module and the subpackages it lies in."""
    names = module.split(".")
    yield from (".".join(names[:end]) for end in range(2, len(names) + 1))
