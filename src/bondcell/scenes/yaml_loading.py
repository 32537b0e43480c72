"""Parameter files: safe YAML with the plain types of YAML 1.2, every slip of the file reported."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import yaml

from bondcell.errors import InputError, Violation

LARGEST_FILE = 256_000
"""Largest file that is read, in bytes."""

MOST_NODES = 100_000
"""Most values a file may hold once its aliases are written out."""

MOST_LEVELS = 20
"""Deepest nesting of a file."""


def load_mapping(path: str | Path, error: type[InputError] = InputError) -> dict[str, Any]:
    """Read a YAML file whose top level is a mapping.

    Parameters
    ----------
    path
        The file.
    error
        Class of the exception to raise.

    Returns
    -------
    dict
        Text keys; values are mappings, lists, text, numbers, booleans and None.

    Raises
    ------
    InputError
        The file is absent, unreadable, not text, not YAML, empty, no mapping, repeats a key, or is
        out of all proportion.

    Notes
    -----
    Plain scalars follow the core schema of YAML 1.2, which editors check against: ``1e-3`` is a
    number, ``010`` is ten, ``1:30`` and ``yes`` are text.
    """
    try:
        node = _compose(_read(Path(path)))
        if not isinstance(node, yaml.MappingNode):
            kind = "empty" if node is None or node.tag == _NULL else f"one {_kind(node)}"
            raise _Unreadable(kind, "a mapping of keys to values")
        violations = _structure_violations(node)
        if not violations:
            return dict(_construct(node))
    except _Unreadable as unreadable:
        violations = [Violation("file", unreadable.found, unreadable.allowed)]
    raise error(violations, source=str(path))


class _Unreadable(Exception):
    def __init__(self, found: str, allowed: str) -> None:
        self.found = found
        self.allowed = allowed
        super().__init__(found)


class _CoreLoader(yaml.SafeLoader):
    """Safe loader that resolves plain scalars as YAML 1.2 does."""

    yaml_implicit_resolvers: dict[str, Any] = {}  # noqa: RUF012


_CORE = "tag:yaml.org,2002:"
_NULL, _BOOL, _INT, _FLOAT, _STR, _SEQ, _MAP = (
    _CORE + name for name in ("null", "bool", "int", "float", "str", "seq", "map")
)
_TYPES = "mappings, lists, text, numbers, true and false"

_SCALARS = (
    (_NULL, r"~|null|Null|NULL|", ["~", "n", "N", ""]),
    (_BOOL, r"true|True|TRUE|false|False|FALSE", list("tTfF")),
    (_INT, r"[-+]?[0-9]+", list("-+0123456789")),
    (
        _FLOAT,
        r"[-+]?(?:\.[0-9]+|[0-9]+(?:\.[0-9]*)?)(?:[eE][-+]?[0-9]+)?"
        r"|[-+]?\.(?:inf|Inf|INF)|\.(?:nan|NaN|NAN)",
        list("-+.0123456789"),
    ),
)
for _tag, _pattern, _first in _SCALARS:
    _CoreLoader.add_implicit_resolver(_tag, re.compile(rf"(?:{_pattern})\Z"), _first)


def _construct_int(loader: yaml.SafeLoader, node: yaml.ScalarNode) -> int | float:
    text = loader.construct_scalar(node)
    # A long run of digits is no count: as a float it needs no big-integer arithmetic.
    return int(text, 10) if len(text) < 20 else float(text)


_CoreLoader.add_constructor(_INT, _construct_int)


def _read(path: Path) -> bytes:
    try:
        with path.open("rb") as file:
            content = file.read(LARGEST_FILE + 1)
    except FileNotFoundError:
        raise _Unreadable("absent", "an existing file") from None
    except OSError as error:
        raise _Unreadable(error.strerror or str(error), "a readable file") from None
    if len(content) > LARGEST_FILE:
        raise _Unreadable("too large", f"at most {LARGEST_FILE} bytes")
    return content


def _compose(content: bytes) -> yaml.Node | None:
    loader = None
    try:
        loader = _CoreLoader(content)
        return loader.get_single_node()
    except yaml.reader.ReaderError as error:
        problem = f"byte {error.position}: {error.reason}"
        raise _Unreadable("not text", f"UTF-8 text ({problem})") from None
    except yaml.MarkedYAMLError as error:
        raise _Unreadable(_where(error), "valid YAML; is the file complete?") from None
    except RecursionError:
        raise _Unreadable("nested too deeply", f"at most {MOST_LEVELS} levels") from None
    finally:
        if loader is not None:
            loader.dispose()


def _where(error: yaml.MarkedYAMLError) -> str:
    mark = error.problem_mark or error.context_mark
    place = f"line {mark.line + 1}, column {mark.column + 1}: " if mark else ""
    return place + " ".join(text for text in (error.context, error.problem) if text)


def _construct(node: yaml.MappingNode) -> Any:
    loader = _CoreLoader("")
    try:
        return loader.construct_document(node)
    except yaml.MarkedYAMLError as error:
        raise _Unreadable(_where(error), _TYPES) from None
    except (ValueError, LookupError) as error:
        raise _Unreadable(f"a tag that does not fit its value ({error})", _TYPES) from None
    finally:
        loader.dispose()


def _structure_violations(root: yaml.Node) -> list[Violation]:
    """Repeated keys, keys that are no text, aliases that blow up."""
    violations: list[Violation] = []
    sizes: dict[int, int] = {}

    def visit(node: yaml.Node, path: str, level: int = 0) -> int:
        if level > MOST_LEVELS:
            raise _Unreadable("nested too deeply", f"at most {MOST_LEVELS} levels")
        # A node met again is an alias: counted as if written out, looked at once.
        if id(node) in sizes:
            return sizes[id(node)]
        sizes[id(node)] = MOST_NODES + 1  # stands while the node is open: an alias into itself
        if node.tag not in (_NULL, _BOOL, _INT, _FLOAT, _STR, _SEQ, _MAP):
            violations.append(Violation(path, node.tag.removeprefix(_CORE), f"{_TYPES}, no tag"))
        size = 1
        if isinstance(node, yaml.MappingNode):
            seen: set[str] = set()
            for key, value in node.value:
                name = _key(key, path, seen, violations)
                size += visit(value, f"{path}.{name}" if path else name, level + 1)
        elif isinstance(node, yaml.SequenceNode):
            items = enumerate(node.value)
            size += sum(visit(item, f"{path}.{i}", level + 1) for i, item in items)
        sizes[id(node)] = size
        return size

    if visit(root, "") > MOST_NODES:
        raise _Unreadable("too many values", f"at most {MOST_NODES} values, aliases written out")
    return violations


def _key(key: yaml.Node, path: str, seen: set[str], violations: list[Violation]) -> str:
    name = str(key.value) if isinstance(key, yaml.ScalarNode) else _kind(key)
    if not name.isprintable():
        name = ascii(name)
    field = f"{path}.{name}" if path else name
    line = f"line {key.start_mark.line + 1}"
    if not isinstance(key, yaml.ScalarNode) or key.tag != _STR:
        violations.append(Violation(field, name, f"a key that is a word ({line})"))
    elif name in seen:
        violations.append(Violation(field, name, f"each key once; it stands again in {line}"))
    seen.add(name)
    return name


def _kind(node: yaml.Node) -> str:
    if isinstance(node, yaml.SequenceNode):
        return "list"
    return "mapping" if isinstance(node, yaml.MappingNode) else "value"
