"""The files of a scene's jobs assembled into what its study.nc holds."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from bondcell import provenance
from bondcell.jobs.analytic_batch import compute_analytic
from bondcell.jobs.batch import Batch
from bondcell.jobs.batch_files import read_batch, read_point_batch
from bondcell.jobs.cell_points import cell_at
from bondcell.jobs.collect_relaxation import collect_relaxation
from bondcell.jobs.merge import Canvas
from bondcell.jobs.point_hash import SCHEME
from bondcell.jobs.rows import REFERENCE, Row, analytic_rows, wanted_rows
from bondcell.outputs import DETAILS
from bondcell.results.finite_axes import with_finite_axes
from bondcell.results.names import models_with, reference_variants, result_names
from bondcell.status import Status

if TYPE_CHECKING:
    from bondcell.scenes.scene import Scene


def collect(
    scene: Scene,
    study: xr.Dataset | None,
    analytic: Sequence[Path],
    reference: Sequence[Path],
    load: str | None = None,
    relaxation: Sequence[Path] = (),
) -> xr.Dataset:
    """Results at the points of a scene under one load with their provenance.

    Parameters
    ----------
    scene
        The scene.
    study
        Its inputs; None if nothing is evaluated at points.
    analytic
        Files of its analytic batches; points that none of them has are evaluated here.
    reference
        Files of its finite element batches.
    load
        One of its loads, the first by default. Every load has the same models: one that does not
        cover the load is NaN, flagged ``not_computed``.
    relaxation
        Files of its relaxation batches, if its matrix relaxes.

    Raises
    ------
    DataError
        A file is damaged, was computed for other parameters, or points are missing.
    """
    attributes = provenance.collect(scene)
    if study is None:
        return xr.Dataset(attrs=attributes)
    load = load or scene.load
    origins = []
    canvas = Canvas(study, labels(scene, load))
    for path in (*analytic, *reference):
        batch = read_point_batch(path)
        origins.append(xr.Dataset(attrs=batch.attrs))
        if batch.attrs["load"] == load:
            canvas.add(batch)
    for quick in quick_batches(scene, canvas, load):
        canvas.add(compute_analytic(quick))
    attributes |= machines(origins)
    result = _with_models(canvas.dataset(), result_names(scene))
    rows = [row.as_list() for row in wanted_rows(scene) if row.load == load]
    identity = {"hash_scheme": SCHEME, "rows": json.dumps(rows)}
    result = result.assign_attrs(attributes, load=load, **identity)
    if relaxation:
        result = result.merge(collect_relaxation(scene, study, relaxation, load))
    return with_finite_axes(result)


def collect_other_loads(
    scene: Scene,
    study: xr.Dataset | None,
    analytic: Sequence[Path],
    reference: Sequence[Path],
    relaxation: Sequence[Path] = (),
) -> dict[str, xr.Dataset]:
    """Results under every load but the first, as groups of the scene's file: axes and outputs.

    Parameters
    ----------
    scene, study, analytic, reference, relaxation
        As in `collect`.
    """
    if study is None:
        return {}
    inputs = list(study.data_vars)
    return {
        load: collect(scene, study, analytic, reference, load, relaxation).drop_vars(inputs)
        for load in scene.loads[1:]
    }


def collect_convergence(scene: Scene, files: Iterable[Path]) -> dict[str, xr.Dataset]:
    """The group ``convergence`` of a scene's file, none if the scene has no such study.

    Parameters
    ----------
    scene
        The scene.
    files
        Its one file, or none.
    """
    groups = {}
    for path in files:
        groups["convergence"] = read_batch(path, scene.convergence_digest)
    return groups


def quick_batches(scene: Scene, canvas: Canvas, load: str) -> Iterator[Batch]:
    """Analytic rows at the points that no file has, too few to be worth a job."""
    left: dict[bytes, list[Row]] = {}
    for row in analytic_rows(scene, load):
        missing = canvas.missing(row.model)
        if missing.size:
            left.setdefault(missing.tobytes(), []).append(row)
    for positions, rows in left.items():
        points = cell_at(canvas.cell, np.frombuffer(positions, dtype=np.int64))
        yield Batch(tuple(rows), points)


def labels(scene: Scene, load: str | None = None) -> dict[str, str]:
    """Name in the batch files -> name in the dimension ``model``, in the scene's order."""
    load = load or scene.load
    models = {name: name for name in models_with(scene, load)}
    references = reference_variants(scene, load)
    return models | {f"{REFERENCE}_{variant}": name for name, variant in references.items()}


def _with_models(merged: xr.Dataset, names: list[str]) -> xr.Dataset:
    """Rows for models without the load as well, so that all loads share one dimension."""
    if merged["model"].values.tolist() == names:
        return merged
    blank: dict[Any, Any] = {"status": Status.not_computed, "dof": 0, **DETAILS}
    present = {name: value for name, value in blank.items() if name in merged}
    full = merged.reindex(model=names, fill_value={**present, "stiffness": np.nan})
    for name in present:
        full[name] = full[name].astype(merged[name].dtype)
    full["model"].attrs = merged["model"].attrs
    return full


def machines(datasets: Iterable[xr.Dataset]) -> dict[str, str]:
    """The machines that computed the datasets, joined in one order where there were several."""
    keys = list(provenance.machine())
    found = dict.fromkeys(tuple(str(data.attrs[key]) for key in keys) for data in datasets)
    columns = zip(*found, strict=True)
    return {key: " | ".join(values) for key, values in zip(keys, columns, strict=False)}
