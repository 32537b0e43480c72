"""The relaxation batches of a scene on the dimensions of its sweep."""

from __future__ import annotations

from collections.abc import Hashable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from bondcell.errors import DataError, Violation
from bondcell.inputs import cell_from_study
from bondcell.jobs.batch_files import read_batch, read_point_batch
from bondcell.jobs.merge import Places
from bondcell.jobs.rows import REFERENCE, relaxation_rows
from bondcell.results.names import reference_variants, result_names
from bondcell.results.relaxation_names import (
    METHODS,
    VARIABLES,
    attributes,
    with_equal_terms,
)
from bondcell.status import Status

if TYPE_CHECKING:
    from bondcell.scenes.scene import Scene

_BLANK: dict[str, Any] = {
    "relaxation_status": int(Status.not_computed),
    "series_status": int(Status.not_computed),
    "series_terms": 0,
}


def collect_relaxation(
    scene: Scene, study: xr.Dataset, files: Sequence[Path], load: str
) -> xr.Dataset:
    """Relaxation under one load, every variable on ``(model, convention, series, axes..., ...)``.

    Parameters
    ----------
    scene
        A scene with a prony block.
    study
        Its inputs.
    files
        Files of its relaxation batches, of any load.
    load
        The load.

    Raises
    ------
    DataError
        A file is damaged or was computed for other parameters, or points are missing.
    """
    # As many terms under every load: the groups of a file share their dimensions.
    found = with_equal_terms([read_point_batch(path) for path in files])
    parts = [batch for batch in found if batch.attrs["load"] == load]
    cell, dims = cell_from_study(study)
    places = Places(cell)
    names = result_names(scene)
    known = {name: names.index(name) for name in scene.models}
    for name, variant in reference_variants(scene, load).items():
        known[f"{REFERENCE}_{variant}"] = names.index(name)
    sizes = {**parts[0].sizes, "model": len(names), "point": places.points}
    values, seen = _filled(parts, known, places, sizes)
    asked: Any = [known[row.model] for row in relaxation_rows(scene, load)]
    lost = np.count_nonzero(~seen[np.ix_(asked, places.first)].all(axis=0))
    if lost:
        missing = f"{lost} of {places.first.size} points missing"
        raise DataError([Violation(f"relaxation under {load}", missing, "each point")])
    variables = {
        name: _on_axes(found, VARIABLES[name], dims, cell.shape, attributes(name, load))
        for name, found in values.items()
    }
    coords = {name: coord for name, coord in parts[0].coords.items() if name != "model"}
    return xr.Dataset(variables, coords)


def _filled(
    parts: Sequence[xr.Dataset],
    known: Mapping[str, int],
    places: Places,
    sizes: Mapping[Hashable, int],
) -> tuple[dict[str, NDArray[Any]], NDArray[np.bool_]]:
    """Every variable at every point, and which points of which models some part has."""
    values = {
        name: np.full([sizes[dim] for dim in dims], _BLANK.get(name, np.nan), parts[0][name].dtype)
        for name, dims in VARIABLES.items()
        if name in parts[0]
    }
    seen = np.zeros((sizes["model"], sizes["point"]), dtype=bool)
    for part in parts:
        labels = [str(name) for name in part["model"].values]
        ours = [i for i, label in enumerate(labels) if label in known]
        inside, where = places.of(part)
        kept = {"model": ours, "point": np.flatnonzero(inside)}
        target: dict[str, Any] = {"model": [known[labels[i]] for i in ours], "point": where}
        seen[np.ix_(target["model"], where)] = True
        for name, whole in values.items():
            taken = part[name].isel({d: i for d, i in kept.items() if d in VARIABLES[name]})
            at: list[Any] = [target.get(dim, np.arange(sizes[dim])) for dim in VARIABLES[name]]
            whole[np.ix_(*at)] = taken.values
    if places.same is not None:
        for name in [name for name in values if "point" in VARIABLES[name]]:
            along = VARIABLES[name].index("point")
            values[name] = np.take(values[name], places.same, axis=along)
    return values, seen


def _on_axes(
    values: Any, dims: tuple[str, ...], axes: tuple[str, ...], shape: tuple[int, ...], attrs: Any
) -> tuple[Any, ...]:
    if "point" not in dims:
        return dims, values, attrs
    at = dims.index("point")
    unfolded = values.reshape(*values.shape[:at], *shape, *values.shape[at + 1 :])
    return (*dims[:at], *axes, *dims[at + 1 :]), unfolded, attrs


def collect_methods(scene: Scene, files: Sequence[Path]) -> dict[str, xr.Dataset]:
    """The group of the comparison of methods in time, none if the scene asks for none."""
    groups = {}
    for path in files:
        groups[METHODS] = read_batch(path, scene.methods_digest)
    return groups
