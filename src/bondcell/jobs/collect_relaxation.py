"""The relaxation batches of a scene on the dimensions of its sweep."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

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
    shape = cell.shape
    names = result_names(scene)
    known = {name: names.index(name) for name in scene.models}
    for name, variant in reference_variants(scene, load).items():
        known[f"{REFERENCE}_{variant}"] = names.index(name)
    first = parts[0]
    sizes = {**first.sizes, "model": len(names), "point": int(np.prod(shape))}
    present = [name for name in VARIABLES if name in first]
    values = {
        name: np.full(
            [sizes[dim] for dim in VARIABLES[name]], _BLANK.get(name, np.nan), first[name].dtype
        )
        for name in present
    }
    seen = np.zeros((sizes["model"], sizes["point"]), dtype=bool)
    asked = [row.model for row in relaxation_rows(scene, load)]
    for part in parts:
        labels = [str(name) for name in part["model"].values]
        ours = [i for i, label in enumerate(labels) if label in known]
        rows = np.array([known[labels[i]] for i in ours], dtype=int)
        inside, where = places.of(part)
        kept = {"model": ours, "point": np.flatnonzero(inside)}
        seen[np.ix_(rows, where)] = True
        for name in present:
            chosen: list[Any] = [np.arange(sizes[dim]) for dim in VARIABLES[name]]
            taken = part[name].isel({d: i for d, i in kept.items() if d in VARIABLES[name]})
            for dim, positions in (("model", rows), ("point", where)):
                if dim in VARIABLES[name]:
                    chosen[VARIABLES[name].index(dim)] = positions
            values[name][np.ix_(*chosen)] = taken.values
    wanted = np.array([known[row] for row in asked])
    lost = np.count_nonzero(~seen[np.ix_(wanted, places.first)].all(axis=0))
    if lost:
        missing = f"{lost} of {places.first.size} points missing"
        raise DataError([Violation(f"relaxation under {load}", missing, "each point")])
    if places.same is not None:
        for name in present:
            if "point" in VARIABLES[name]:
                at = VARIABLES[name].index("point")
                values[name] = np.take(values[name], places.same, axis=at)
    variables = {
        name: _on_axes(values[name], VARIABLES[name], dims, shape, attributes(name, load))
        for name in present
    }
    coords = {name: coord for name, coord in first.coords.items() if name != "model"}
    return xr.Dataset(variables, coords)


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
