"""The specimen's batches into groups of study.nc."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import xarray as xr

from bondcell import provenance
from bondcell.jobs.batch_files import read_batch
from bondcell.jobs.collect import machines
from bondcell.specimen.names import AXES
from bondcell.specimen.results import combine

if TYPE_CHECKING:
    from bondcell.scenes.scene import Scene


def collect_specimen(scene: Scene, files: list[Path]) -> tuple[xr.Dataset, dict[str, xr.Dataset]]:
    """Root group and groups of a specimen scene's file.

    Parameters
    ----------
    scene
        A scene with a specimen block.
    files
        Its batches, ``specimen_<part>.nc`` and ``specimen_midplane.nc``.

    Raises
    ------
    DataError
        A file is damaged or was computed for other parameters.
    """
    found = {_part(path): read_batch(path, scene.specimen_digest) for path in files}
    attributes = provenance.collect(scene) | machines(found.values())
    for name in provenance.measuring():  # of each part, in the order of the jobs
        attributes[name] = " | ".join(
            str(part.attrs.get(name, provenance.UNKNOWN)) for part in found.values()
        )
    plane = found.pop("midplane", None)
    root, groups = combine(found)
    if plane is not None:
        groups["midplane"] = plane
    described = {name: _described(group) for name, group in groups.items()}
    return _described(root).assign_attrs(attributes), described


def _described(data: xr.Dataset) -> xr.Dataset:
    """The data with attributes on every axis, which reindexing loses."""
    known = [name for name in data.coords if name in AXES]
    return data.assign_coords({name: data[name].assign_attrs(AXES[str(name)]) for name in known})


def _part(path: Path) -> str:
    return Path(path).stem.removeprefix("specimen_")
