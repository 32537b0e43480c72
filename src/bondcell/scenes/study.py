"""From a scene to its study: the inputs at every point, labelled by the swept axes."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr

from bondcell.cell import LONG_NAMES, UNITS
from bondcell.results.view import SAMPLE
from bondcell.scenes.scene import Scene
from bondcell.scenes.sweep import AXIS_NAMES, resolve_inputs


def build_study(scene: Scene) -> xr.Dataset:
    """Inputs of every point of a scene.

    Parameters
    ----------
    scene
        A checked scene.

    Returns
    -------
    xarray.Dataset
        The dimensions are the swept axes in the scene's order, with ``units`` and ``long_name``.
        Every input of theory.md section 6 is there in SI units, defaults filled in, each on the
        axes it depends on: as the coordinate itself where it is an axis, else as a data variable.
        A design's points are the dimension ``sample``, its parameters coordinates along it.
        Attributes: ``title``, ``scene``.

    Notes
    -----
    A ratio sets its input: ``young_m = young_i / modulus_ratio``, ``gap = gap_ratio radius_i``,
    ``radius_j = radius_ratio radius_i``. Left out, particle j is like particle i and
    ``cylinder_radius = max(radius_i, radius_j)``.

    Examples
    --------
    >>> from bondcell.scenes.parsing import parse_scene
    >>> study = build_study(
    ...     parse_scene(
    ...         {
    ...             "title": "Gaps and ratios",
    ...             "models": ["fsi"],
    ...             "cell": {
    ...                 "radius_i": "7.5 mm",
    ...                 "young_i": "30 GPa",
    ...                 "poisson_i": 0.25,
    ...                 "poisson_m": 0.46,
    ...             },
    ...             "sweep": {"gap": ["0.5 mm", "1 mm"], "modulus_ratio": [1, 1e3, 1e6]},
    ...         }
    ...     )
    ... )
    >>> dict(study.sizes)
    {'gap': 2, 'modulus_ratio': 3}
    >>> study.young_m.values
    array([3.e+10, 3.e+07, 3.e+04])
    """
    axes = {
        name: xr.DataArray(values, dims=name, coords={name: values})
        for name, values in scene.axes.items()
    }
    samples = {name: xr.DataArray(values, dims=SAMPLE) for name, values in scene.samples.items()}
    inputs = resolve_inputs(scene.cell.given(), {**axes, **samples})
    for particle_j, particle_i in (
        ("radius_j", "radius_i"),
        ("young_j", "young_i"),
        ("poisson_j", "poisson_i"),
    ):
        inputs.setdefault(particle_j, inputs[particle_i])
    if "cylinder_radius" not in inputs:
        inputs["cylinder_radius"] = np.maximum(inputs["radius_i"], inputs["radius_j"])
    coords = {name: (name, axis.values, _attributes(name)) for name, axis in axes.items()}
    if samples:
        number = {"units": "1", "long_name": "number of the sample"}
        coords[SAMPLE] = (SAMPLE, np.arange(len(next(iter(samples.values())))), number)
    coords |= {name: (SAMPLE, value.values, _attributes(name)) for name, value in samples.items()}
    study = xr.Dataset(coords=coords, attrs={"title": scene.title, "scene": scene.name})
    for name in UNITS:
        if name not in coords:
            study[name] = _variable(inputs[name], (*axes, SAMPLE), _attributes(name))
    return study


def _variable(
    value: Any, order: tuple[str, ...], attributes: dict[str, str]
) -> tuple[tuple[str, ...], Any, dict[str, str]]:
    if not isinstance(value, xr.DataArray):
        return (), np.float64(value), attributes
    dims = tuple(name for name in order if name in value.dims)
    return dims, value.transpose(*dims).values, attributes


def _attributes(name: str) -> dict[str, str]:
    return {"units": UNITS.get(name, "1"), "long_name": {**LONG_NAMES, **AXIS_NAMES}[name]}
