"""From the validation library's error records to violations that name key, value and range."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from dataclasses import replace
from difflib import get_close_matches
from typing import Any

from pydantic import ValidationError

from bondcell.errors import Violation
from bondcell.scenes.fields import Block
from bondcell.scenes.keys import KeyPath, known_keys
from bondcell.scenes.quantities import NotAllowed

_PLAIN = {
    "model_type": "a mapping of keys to values",
    "model_attributes_type": "a mapping of keys to values",
    "dict_type": "a mapping of keys to values",
    "tuple_type": "a list",
    "union_tag_not_found": "a list of values, or {start, stop, points, spacing}",
    "missing": "a value: the key is required",
}

_BLOCK = ("model_type", "model_attributes_type")
"""What the library calls something else in the place of a block."""

_TAGS = ("list", "range", "[key]")
"""Marks that the library puts into a path besides the keys of the file."""


def found_violations(
    error: ValidationError, root: type[Block]
) -> Iterator[tuple[KeyPath, Violation]]:
    """KeyPath and violation of everything the library complains about.

    Parameters
    ----------
    error
        The library's exception.
    root
        The block that the whole file should be.
    """
    for record in error.errors(include_url=False):
        path = _plain_path(record["loc"])
        value = None if record["type"] == "missing" else record["input"]
        allowed = _allowed(record, path, root)
        yield path, Violation(dotted(path), value, allowed)


def dotted(path: KeyPath) -> str:
    """Write a path with dots; the file itself is ``scene``, a key with a dot is quoted.

    Examples
    --------
    >>> dotted(("sweep", "gap", 2)), dotted(("cell.gap",))
    ('sweep.gap.2', "'cell.gap'")
    """
    words = (str(part) for part in path)
    return ".".join(repr(word) if "." in word else word for word in words) or "scene"


def null_violations(data: Any, path: KeyPath = ()) -> Iterator[tuple[KeyPath, Violation]]:
    """Keys without a value, as a half-written file has them."""
    if not isinstance(data, Mapping):
        return
    for key, value in data.items():
        here = (*path, key)
        if value is None:
            allowed = "a value; leave the key out for its default"
            yield here, Violation(dotted(here), None, allowed)
        yield from null_violations(value, here)


def without(data: Any, paths: Collection[KeyPath], path: KeyPath = ()) -> Any:
    """Copy of nested mappings that lacks what stands at the paths."""
    if not isinstance(data, Mapping):
        return data
    return {
        key: without(value, paths, (*path, key))
        for key, value in data.items()
        if (*path, key) not in paths
    }


def as_given(violation: Violation, data: Any) -> Violation:
    """Show a quantity as it was written, ``0 mm`` instead of 0.0."""
    raw = data
    for key in violation.field.split("."):
        raw = raw.get(key) if isinstance(raw, Mapping) else None
    return replace(violation, value=raw) if isinstance(raw, str) else violation


def _plain_path(location: KeyPath) -> KeyPath:
    tagged = location[0] == "sweep" if location else False
    return tuple(
        part
        for i, part in enumerate(location)
        if not (part == "[key]" or (tagged and i == 2 and part in _TAGS))
    )


def _allowed(record: Mapping[str, Any], path: KeyPath, root: type[Block]) -> str:
    kind = record["type"]
    context = record.get("ctx", {})
    if isinstance(context.get("error"), NotAllowed):
        return str(context["error"].allowed)
    if kind == "extra_forbidden":
        keys = known_keys(root, path[:-1])
        close = get_close_matches(str(path[-1]), keys, 1)
        hint = f"; did you mean {close[0]}?" if close else ""
        return f"one of the keys {', '.join(keys)}{hint}"
    if kind in _BLOCK and not isinstance(record["input"], Mapping):
        return f"{_PLAIN[kind]}: {', '.join(known_keys(root, path))}"
    if kind == "literal_error":
        return str(context["expected"])
    return _PLAIN.get(kind, str(record["msg"]))
