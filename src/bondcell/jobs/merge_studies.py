"""Two studies in one: the points of both, where both asked the same of their points."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr

from bondcell.cell import UNITS, Cell
from bondcell.errors import InputError, Violation
from bondcell.jobs.point_hash import SCHEME, HashIndex, point_hashes
from bondcell.results.finite_axes import PREFIX, with_finite_axes
from bondcell.results.view import SAMPLE, parameters
from bondcell.scenes.sweep import DERIVED

Loads = Mapping[str, xr.Dataset]

IDENTITY = ("hash_scheme", "rows")
"""Attributes that say what a study asks of its points; `bondcell.jobs.collect` writes them."""


def merge_studies(first: Loads, second: Loads) -> dict[str, xr.Dataset]:
    """The points of two studies under every load.

    Parameters
    ----------
    first, second
        Load -> result, see `bondcell.results.load_groups.read_loads`.

    Returns
    -------
    dict
        Load -> result. Where the grids differ along one axis alone it is a grid again, with the
        values of both in rising order; else the points stand on ``sample``, those of the first
        study first. A point of both is that of the first.

    Raises
    ------
    InputError
        Hash schemes, models, loads, conditions or tolerances differ, or values of a point of both
        differ by more than their error estimates allow.
    """
    violations = list(_differences(first, second))
    if violations:
        raise InputError(violations)
    new = _new_points(first, second)
    axis = _growing_axis(*(next(iter(loads.values())) for loads in (first, second)))
    merged = {}
    for load, study in first.items():
        attributes = _joined(study.attrs, second[load].attrs)
        if axis is not None:
            whole = _longer(study, second[load], axis)
        else:
            named = _sample_parameters(first, second)
            rest = _samples(second[load], named).isel({SAMPLE: new})
            whole = _renumbered([_samples(study, named), rest])
        merged[load] = with_finite_axes(whole).assign_attrs(attributes)
    return merged


def _differences(first: Loads, second: Loads) -> list[Violation]:
    """Why two studies cannot be one, in the words of the second."""
    found = []
    if set(first) != set(second):
        found.append(Violation("loads", ", ".join(second), ", ".join(first) + ": as the first"))
    for load in [load for load in first if load in second]:
        a, b = first[load], second[load]
        for study, which in ((a, "first"), (b, "second")):
            missing = [name for name in IDENTITY if name not in study.attrs]
            if missing or "stiffness" not in study or "relaxation" in study:
                words = "results at points, with hash_scheme and rows, without relaxation"
                found.append(Violation(f"{which} study, {load}", "another file", words))
        if found:
            continue
        schemes = int(a.attrs["hash_scheme"]), int(b.attrs["hash_scheme"])
        if schemes != (SCHEME, SCHEME):
            words = f"{SCHEME} in both, that of this version; the first has {schemes[0]}"
            found.append(Violation("hash_scheme", schemes[1], words))
        found += _row_differences(load, *(json.loads(study.attrs["rows"]) for study in (a, b)))
        names = [study["model"].values.tolist() for study in (a, b)]
        if names[0] != names[1]:
            allowed = f"{', '.join(names[0])}: the models of the first study, in its order"
            found.append(Violation(f"model, {load}", ", ".join(names[1]), allowed))
    return found


def _row_differences(load: str, first: list[Any], second: list[Any]) -> list[Violation]:
    """Models, conditions and options that only one of the studies has."""
    ours, theirs = ({json.dumps(row[2:]) for row in rows} for rows in (first, second))
    if ours == theirs:
        return []
    only = ", ".join(sorted(theirs - ours)) or "less"
    allowed = f"the same as the first study, which has {', '.join(sorted(ours - theirs)) or 'less'}"
    return [Violation(f"rows, {load}", only, allowed)]


def _new_points(first: Loads, second: Loads) -> np.ndarray[Any, Any]:
    """Positions of the second study's points that the first does not have.

    Raises
    ------
    InputError
        Values of a point of both differ.
    """
    loads = [next(iter(found.values())) for found in (first, second)]
    hashes = [point_hashes(Cell(**{name: _flat(s, name) for name in UNITS})) for s in loads]
    at = HashIndex(hashes[0]).find(hashes[1])
    both = at >= 0
    violations = []
    for load in first:
        values, errors = (
            [_flat(found[load], name) for found in (first, second)]
            for name in ("stiffness", "error_estimate")
        )
        a, b = values[0][:, at[both]], values[1][:, both]
        allowed = np.nan_to_num(errors[0][:, at[both]]) + np.nan_to_num(errors[1][:, both]) + 1e-9
        wrong = (np.isnan(a) != np.isnan(b)) | (np.abs(a - b) > allowed * np.abs(a))
        if wrong.any():
            text = f"{int(wrong.any(axis=0).sum())} of {int(both.sum())} points of both studies"
            words = "values that agree within their error estimates"
            violations.append(Violation(f"stiffness, {load}", text, words))
    if violations:
        raise InputError(violations)
    return np.flatnonzero(~both)


def _growing_axis(first: xr.Dataset, second: xr.Dataset) -> str | None:
    """The only axis along which two grids differ, None if they are no such grids."""
    if first["stiffness"].dims != second["stiffness"].dims or SAMPLE in first.dims:
        return None
    axes = [str(axis) for axis in first["stiffness"].dims if axis != "model"]
    differing = [axis for axis in axes if not first[axis].equals(second[axis])]
    if len(differing) != 1:
        return None
    along = differing[0]
    inputs = [name for name in UNITS if name in first.data_vars and along not in first[name].dims]
    same = all(name in second and first[name].equals(second[name]) for name in inputs)
    return along if same else None


def _longer(first: xr.Dataset, second: xr.Dataset, axis: str) -> xr.Dataset:
    """Both grids along an axis; what does not depend on it is the first's."""
    companion = f"{PREFIX}{axis}"
    parts = [study.drop_vars(companion, errors="ignore") for study in (first, second)]
    new = ~np.isin(parts[1][axis].values, parts[0][axis].values)
    parts[1] = parts[1].isel({axis: new})
    joined = xr.concat(
        parts, axis, data_vars="minimal", coords="minimal", compat="override", join="override"
    )
    return joined.sortby(axis)


def _sample_parameters(first: Loads, second: Loads) -> list[str]:
    """What becomes a coordinate of the samples: what varies in a study, or between them."""
    a, b = (next(iter(loads.values())) for loads in (first, second))
    named = dict.fromkeys([*parameters(a), *parameters(b)])
    for name in list(named):
        if name in DERIVED and not (name in a.coords and name in b.coords):
            del named[name]
            named[DERIVED[name]] = None
    set_by_ratio = {DERIVED[name] for name in named if name in DERIVED}
    for name in UNITS:
        values = [_flat(study, name) for study in (a, b)]
        if name not in set_by_ratio and np.unique(np.concatenate(values)).size > 1:
            named[name] = None
    return list(named)


def _samples(study: xr.Dataset, named: list[str]) -> xr.Dataset:
    """The points of a study one after the other on ``sample``."""
    flat = {}
    for name in [*UNITS, *named, *(n for n in study.data_vars if n not in UNITS)]:
        variable = study[name]
        dims = ("model", SAMPLE) if "model" in variable.dims else (SAMPLE,)
        flat[str(name)] = (dims, _flat(study, str(name)), variable.attrs)
    return xr.Dataset(flat, {"model": study["model"]}).set_coords(named)


def _flat(study: xr.Dataset, name: str) -> np.ndarray[Any, Any]:
    """Values of a variable at every point in order, models first."""
    shape = study["stiffness"].isel(model=0, drop=True)
    variable = study[name]
    if "model" not in variable.dims:
        return np.asarray(variable.broadcast_like(shape).transpose(*shape.dims).values.ravel())
    return np.asarray(variable.transpose("model", ...).values.reshape(study.sizes["model"], -1))


def _renumbered(parts: list[xr.Dataset]) -> xr.Dataset:
    """Samples of several studies, numbered anew; an input that does not vary is one number."""
    whole = xr.concat(parts, SAMPLE, data_vars="minimal", coords="minimal", compat="override")
    for name in UNITS:
        values = whole[name].values
        if name in whole.data_vars and np.all(values == values[0]):
            whole[name] = ((), values[0], whole[name].attrs)
    number = {"units": "1", "long_name": "number of the sample"}
    return whole.assign_coords({SAMPLE: (SAMPLE, np.arange(whole.sizes[SAMPLE]), number)})


def _joined(first: Mapping[str, Any], second: Mapping[str, Any]) -> dict[str, Any]:
    """Attributes of both: what differs is told of both, in order."""
    both = {**second, **first}
    for name in set(first) & set(second):
        if str(first[name]) != str(second[name]):
            both[name] = f"{first[name]} | {second[name]}"
    return both
