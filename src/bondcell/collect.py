"""The files of a scene's jobs assembled into what its study.nc holds."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import xarray as xr

from bondcell import provenance
from bondcell.analytic_batch import compute_analytic
from bondcell.batch_files import read_batch
from bondcell.batches import ANALYTIC, REFERENCE, Batch
from bondcell.merge import merge

if TYPE_CHECKING:
    from bondcell.scene import Scene


def collect(
    scene: Scene, study: xr.Dataset | None, analytic: Sequence[Path], reference: Sequence[Path]
) -> xr.Dataset:
    """Results at the points of a scene with their provenance.

    Parameters
    ----------
    scene
        The scene.
    study
        Its inputs; None if nothing is evaluated at points.
    analytic
        Files of its analytic batches; without any the scene's models are evaluated here.
    reference
        Files of its finite element batches.

    Raises
    ------
    DataError
        A file is damaged, was computed for other parameters, or points are missing.
    """
    attributes = provenance.collect(scene)
    if study is None:
        return xr.Dataset(attrs=attributes)
    batches = [read_batch(path, scene.models_digest) for path in analytic]
    batches += [read_batch(path, scene.reference_digest) for path in reference]
    attributes |= machines(batches)
    if scene.models and not analytic:
        batches.append(
            compute_analytic(study, Batch(ANALYTIC), scene.models, scene.load, scene.contributions)
        )
    return merge(study, batches, labels(scene)).assign_attrs(attributes)


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


def labels(scene: Scene) -> dict[str, str]:
    """Name in the batch files -> name in the dimension ``model``, in the scene's order."""
    models = {name: name for name in scene.models}
    return models | {f"{REFERENCE}_{bc}": name for name, bc in scene.fe_names.items()}


def machines(datasets: Iterable[xr.Dataset]) -> dict[str, str]:
    """The machines that computed the datasets, joined where there were several."""
    attributes = [dataset.attrs for dataset in datasets]
    return {
        key: " | ".join(dict.fromkeys(str(found[key]) for found in attributes))
        for key in (provenance.machine() if attributes else ())
    }
