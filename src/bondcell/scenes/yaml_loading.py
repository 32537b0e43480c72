"""Parameter files: safe YAML with the plain types of YAML 1.2, every slip of the file reported."""

from __future__ import annotations

import math
import re
from pathlib import Path
from typing import Any

import yaml

from bondcell.errors import InputError, Violation
from bondcell.scenes.yaml_structure import (
    CORE,
    MOST_LEVELS,
    TOO_DEEP,
    TYPES,
    Unreadable,
    kind_of,
    structure_violations,
)

LARGEST_FILE = 256_000
"""Largest file that is read, in bytes."""


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
    number, ``010`` is ten, ``1:30`` and ``yes`` are text. So is ``1e500``, which no double holds.
    """
    try:
        node = _compose(_read(Path(path)))
        if not isinstance(node, yaml.MappingNode):
            kind = "empty" if node is None or node.tag == _NULL else f"one {kind_of(node)}"
            raise Unreadable(kind, "a mapping of keys to values")
        violations = structure_violations(node)
        if not violations:
            return dict(_construct(node))
    except Unreadable as unreadable:
        violations = [Violation("file", unreadable.found, unreadable.allowed)]
    raise error(violations, source=str(path))


class _CoreLoader(yaml.SafeLoader):
    """Safe loader that resolves plain scalars as YAML 1.2 does and nests only so deep."""

    yaml_implicit_resolvers: dict[str, Any] = {}  # noqa: RUF012
    level = 0

    def compose_node(self, parent: yaml.Node | None, index: Any) -> yaml.Node | None:
        """Compose a node and all that is in it."""
        if self.level > MOST_LEVELS:
            raise Unreadable(*TOO_DEEP)
        self.level += 1
        node = super().compose_node(parent, index)
        self.level -= 1
        return node


_NULL, _BOOL, _INT, _FLOAT = (CORE + name for name in ("null", "bool", "int", "float"))

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


def _construct_int(loader: yaml.SafeLoader, node: yaml.ScalarNode) -> int | float | str:
    text = loader.construct_scalar(node)
    # A long run of digits is no count: as a float it needs no big-integer arithmetic.
    return int(text, 10) if len(text) < 20 else _finite(text, float(text))


def _construct_float(loader: yaml.SafeLoader, node: yaml.ScalarNode) -> float | str:
    text = loader.construct_scalar(node)
    return _finite(text, loader.construct_yaml_float(node))


def _finite(text: str, number: float) -> float | str:
    """The number, or its text if only rounding makes it infinite: 1e500 is not rigid."""
    return text if math.isinf(number) and "inf" not in text.lower() else number


_CoreLoader.add_constructor(_INT, _construct_int)
_CoreLoader.add_constructor(_FLOAT, _construct_float)


def _read(path: Path) -> bytes:
    try:
        with path.open("rb") as file:
            content = file.read(LARGEST_FILE + 1)
    except FileNotFoundError:
        raise Unreadable("absent", "an existing file") from None
    except OSError as error:
        raise Unreadable(error.strerror or str(error), "a readable file") from None
    if len(content) > LARGEST_FILE:
        raise Unreadable("too large", f"at most {LARGEST_FILE} bytes")
    return content


def _compose(content: bytes) -> yaml.Node | None:
    loader = None
    try:
        loader = _CoreLoader(content)
        return loader.get_single_node()
    except yaml.reader.ReaderError as error:
        problem = f"byte {error.position}: {error.reason}"
        raise Unreadable("not text", f"UTF-8 text ({problem})") from None
    except yaml.MarkedYAMLError as error:
        raise Unreadable(_where(error), "valid YAML; is the file complete?") from None
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
        raise Unreadable(_where(error), TYPES) from None
    except (ValueError, LookupError) as error:
        raise Unreadable(f"a tag that does not fit its value ({error})", TYPES) from None
    finally:
        loader.dispose()
