"""The points of a scene as plain arrays: inputs on axes that broadcast against each other."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from bondcell.cell import Cell, FloatArray
from bondcell.scenes.sweep import resolve_inputs

if TYPE_CHECKING:
    from bondcell.scenes.scene import Scene


def scene_cell(scene: Scene) -> Cell:
    """Inputs at every point of a scene, not broadcast; raveled in the order of the study.

    Parameters
    ----------
    scene
        A checked scene.
    """
    on_axes = shaped(scene.axes, scene.samples)
    return Cell.from_values(**resolve_inputs(scene.cell.given(), on_axes))


def shaped(
    axes: Mapping[str, FloatArray], samples: Mapping[str, FloatArray] | None = None
) -> dict[str, FloatArray]:
    """Axes that broadcast against each other, the first one slowest, those of samples together.

    Parameters
    ----------
    axes
        Name -> values, each an axis of its own.
    samples
        Name -> values at the same points, which are the last axis.

    Examples
    --------
    >>> import numpy as np
    >>> {name: axis.shape for name, axis in shaped({"a": np.ones(2), "b": np.ones(3)}).items()}
    {'a': (2, 1), 'b': (1, 3)}
    >>> {
    ...     name: axis.shape
    ...     for name, axis in shaped({"a": np.ones(2)}, {"b": np.ones(3)}).items()
    ... }
    {'a': (2, 1), 'b': (1, 3)}
    """
    places = [*axes, *([_SAMPLES] if samples else [])]

    def along(place: str, values: FloatArray) -> FloatArray:
        return values.reshape([-1 if other == place else 1 for other in places])

    on_axes = {name: along(name, values) for name, values in axes.items()}
    return on_axes | {name: along(_SAMPLES, values) for name, values in (samples or {}).items()}


_SAMPLES = "their common axis"
