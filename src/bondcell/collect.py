"""The files of a scene's jobs assembled into what its study.nc holds."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING

import xarray as xr

from bondcell import provenance
from bondcell.batch_files import read_batch
from bondcell.batches import REFERENCE
from bondcell.merge import merge

if TYPE_CHECKING:
    from bondcell.scene import Scene


def collect(
    scene: Scene, study: xr.Dataset | None, analytic: Iterable[Path], reference: Iterable[Path]
) -> xr.Dataset:
    """Results at the points of a scene with their provenance.

    Parameters
    ----------
    scene
        The scene.
    study
        Its inputs; None if nothing is evaluated at points.
    analytic, reference
        Files of its batches.

    Raises
    ------
    DataError
        A file is damaged, was computed for other parameters, or points are missing.
    """
    batches = [read_batch(path, scene.models_digest) for path in analytic]
    batches += [read_batch(path, scene.reference_digest) for path in reference]
    result = xr.Dataset() if study is None else merge(study, batches, labels(scene))
    return result.assign_attrs(provenance.collect(scene) | machines(batches))


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
