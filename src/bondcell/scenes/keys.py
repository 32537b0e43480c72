"""Which keys may stand at a place of a parameter file: for hints on keys that do not exist."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, get_args

from bondcell.scenes.fields import Block

KeyPath = tuple[str | int, ...]
"""Keys and positions from the top of a file down to a value."""


def known_keys(root: type[Block], path: KeyPath) -> tuple[str, ...]:
    """Keys that the block at a path may have.

    Parameters
    ----------
    root
        The block that the whole file is.
    path
        Where the block stands; what names an entry of a mapping or a list is passed over.

    Examples
    --------
    >>> from bondcell.scenes.scene import Scene
    >>> known_keys(Scene, ("sweep", "gap"))
    ('start', 'stop', 'spacing', 'points')
    >>> known_keys(Scene, ("convergence", "cases", "base"))[:2]
    ('radius_i', 'radius_j')
    """
    block = root
    for part in path:
        fields = {field.alias or name: field for name, field in block.model_fields.items()}
        if part in fields:
            block = next(_blocks_in(fields[part].annotation), block)
    return tuple(field.alias or name for name, field in block.model_fields.items())


def _blocks_in(annotation: Any) -> Iterator[type[Block]]:
    """Blocks that a field of this type may hold: in a union, a mapping, a list."""
    if isinstance(annotation, type) and issubclass(annotation, Block):
        yield annotation
    for part in get_args(annotation):
        yield from _blocks_in(part)
