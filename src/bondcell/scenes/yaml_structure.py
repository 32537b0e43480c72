"""What is wrong with a parsed YAML file whatever it is about: keys, tags, size, depth."""

from __future__ import annotations

import yaml

from bondcell.errors import Violation

MOST_NODES = 100_000
"""Most values a file may hold once its aliases are written out."""

MOST_LEVELS = 20
"""Deepest nesting of a file once its aliases are written out."""

CORE = "tag:yaml.org,2002:"
"""What the tags of YAML's own types begin with."""

DECIMALS = "decimals with a point, as in 7.5 mm: in braces a comma ends a value"

TYPES = "mappings, lists, text, numbers, true and false"

_KNOWN = {CORE + name for name in ("null", "bool", "int", "float", "str", "seq", "map")}


class Unreadable(Exception):
    """A file holds nothing that could be looked at key by key.

    Parameters
    ----------
    found
        What it is instead.
    allowed
        What would have been accepted, in words.
    """

    def __init__(self, found: str, allowed: str) -> None:
        self.found = found
        self.allowed = allowed
        super().__init__(found)


TOO_DEEP = "nested too deeply", f"at most {MOST_LEVELS} levels"
TOO_MANY = "too many values", f"at most {MOST_NODES} values, aliases written out"


def structure_violations(root: yaml.Node) -> list[Violation]:
    """Repeated keys, keys that are no words, tags, in the order of the file.

    Raises
    ------
    Unreadable
        The file blows up or nests too deeply once its aliases are written out.
    """
    walk = _Walk()
    size, height = walk.visit(root, "")
    if size > MOST_NODES:
        raise Unreadable(*TOO_MANY)
    if height > MOST_LEVELS:
        raise Unreadable(*TOO_DEEP)
    return walk.violations


class _Walk:
    """A walk over all nodes, each looked at once: one met again is an alias.

    An anchor stands before its aliases, so recursion is no deeper than the text itself is nested,
    which the loader bounds.
    """

    def __init__(self) -> None:
        self.violations: list[Violation] = []
        self._known: dict[int, tuple[int, int]] = {}

    def visit(self, node: yaml.Node, path: str) -> tuple[int, int]:
        """Number of values and of levels from a node on, aliases written out."""
        if id(node) in self._known:
            return self._known[id(node)]
        self._known[id(node)] = MOST_NODES + 1, 0  # while it is open: an alias into itself
        if node.tag not in _KNOWN:
            tag = node.tag.removeprefix(CORE)
            self.violations.append(Violation(path, tag, f"{TYPES}, no tag"))
        below = [self.visit(child, place) for place, child in self._children(node, path)]
        size = 1 + sum(size for size, _ in below)
        height = 1 + max((height for _, height in below), default=-1)
        self._known[id(node)] = size, height
        return size, height

    def _children(self, node: yaml.Node, path: str) -> list[tuple[str, yaml.Node]]:
        head = f"{path}." if path else ""
        if isinstance(node, yaml.MappingNode):
            seen: set[str] = set()
            return [(head + self._key(key, value, head, seen), value) for key, value in node.value]
        if isinstance(node, yaml.SequenceNode):
            return [(f"{head}{i}", item) for i, item in enumerate(node.value)]
        return []

    def _key(self, key: yaml.Node, value: yaml.Node, head: str, seen: set[str]) -> str:
        name = str(key.value) if isinstance(key, yaml.ScalarNode) else kind_of(key)
        line = f"line {key.start_mark.line + 1}"
        if name[:1].isdigit() and value.tag == CORE + "null":
            # {radius_i: 7,5 mm} is to YAML a radius of 7 and a key "5 mm".
            self._complain(head + name, name, f"{DECIMALS} ({line})")
        elif not isinstance(key, yaml.ScalarNode) or key.tag != CORE + "str":
            self._complain(head + name, name, f"a key that is a word ({line})")
        elif name in seen:
            self._complain(head + name, name, f"each key once; it stands again in {line}")
        seen.add(name)
        return name

    def _complain(self, field: str, name: str, allowed: str) -> None:
        self.violations.append(Violation(field, name, allowed))


def kind_of(node: yaml.Node) -> str:
    """What a node is, in a word."""
    if isinstance(node, yaml.SequenceNode):
        return "list"
    return "mapping" if isinstance(node, yaml.MappingNode) else "value"
