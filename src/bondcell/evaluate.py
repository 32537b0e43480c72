"""The stiffness of every bond cell in a study by one model: labelled arrays in and out."""

from __future__ import annotations

import time
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
import xarray as xr

from bondcell.by_geometry import solve_points
from bondcell.cell import Cell, FloatArray
from bondcell.errors import InputError, UnknownModel, UnsupportedLoad, Violation
from bondcell.inputs import cell_from_study
from bondcell.models import MODELS
from bondcell.models.asked import ask
from bondcell.models.model import Model
from bondcell.outputs import OUTPUTS, PointResults, output_attributes, part_attributes

CHUNK = 200_000
"""Points given to an analytic model at once: bounds the memory of its intermediate arrays."""

Block = tuple[slice, ...]
Parts = dict[str, FloatArray]


def evaluate(
    study: xr.Dataset, model: str = "fsi", load: str = "normal", **options: Any
) -> xr.Dataset:
    """Stiffness of the bond at every point of a study.

    Parameters
    ----------
    study
        Inputs by the names of `bondcell.cell.UNITS` in SI units, as data variables or coordinates;
        scalars or any dimensions, they broadcast against each other by name. Coordinates with other
        names (``modulus_ratio``) are carried along.
    model
        A name in ``bondcell.MODELS``.
    load
        ``"normal"``, ``"shear"``, ``"torsion"`` or ``"bending"``; a model lists those it covers in
        ``bondcell.MODELS[model].loads``.
    **options
        Options of the model, see ``bondcell.MODELS[model].options``; for ``"fe"`` these are ``bc``
        (of the normal load) and ``tolerance``.

    Returns
    -------
    xarray.Dataset
        On the broadcast dimensions: ``stiffness`` [N m-1; N m rad-1 for torsion and bending],
        ``error_estimate`` (relative numerical error of that value, not of the model), ``status``
        (codes of `bondcell.Status`), ``dof``, ``seconds`` (wall time per point), and the model's
        own springs (``k_i``, ``k_int``, ``k_j``) if it has any. The reference adds ``order``
        (polynomial order of its finest solve), ``way`` (a flag: direct, reduced_basis),
        ``reduction_error`` (the part of ``error_estimate`` that a reduced basis added) and, for
        bending, ``coupling`` [N rad-1] (force across the axis for a unit rotation of end plane j).
        A failed point is NaN, ``status`` says why.

    Raises
    ------
    InputError
        Names every wrong input with its value and what is allowed. `UnknownModel` and
        `UnsupportedLoad` are kinds of it.

    Examples
    --------
    >>> import xarray as xr
    >>> study = xr.Dataset(
    ...     {
    ...         "radius_i": 7.5e-3,
    ...         "young_i": 3e10,
    ...         "poisson_i": 0.25,
    ...         "young_m": 1.4e6,
    ...         "poisson_m": 0.46,
    ...     },
    ...     coords={"gap": [1e-6, 5e-4, 0.1]},
    ... )
    >>> out = evaluate(study, model="fsi")
    >>> out.k_int.round(4).values
    array([284230.5331,  84065.1275,   2358.822 ])
    >>> dict(out.sizes)
    {'gap': 3}
    """
    chosen = checked_model(model, load, options)
    cell, dims = cell_from_study(study)
    if chosen.is_reference:
        results, parts = _evaluate_reference(load, cell, options), Parts()
    else:
        results, parts = _evaluate_analytic(chosen, load, cell, options)
    attributes = output_attributes(load)
    variables = {
        name: (dims, getattr(results, name).reshape(cell.shape), attributes[name])
        for name in OUTPUTS
    }
    for name, detail in results.details.items():
        variables[name] = (dims, detail.reshape(cell.shape), attributes[name])
    for name, part in parts.items():
        variables[name] = (dims, part, part_attributes(name, model, load))
    taken = [name for name in variables if name in study.coords]
    if taken:
        allowed = "a coordinate by another name: this one is a result's"
        raise InputError([Violation(name, "coordinate", allowed) for name in taken])
    coords = {name: coord for name, coord in study.coords.items() if set(coord.dims) <= set(dims)}
    return xr.Dataset(variables, coords, {"model": model, "load": load, **options})


def blocks(shape: tuple[int, ...], limit: int) -> Iterator[Block]:
    """Cut an array's index space into rectangular blocks of at most `limit` points.

    Rectangular, so that an input which does not vary along an axis stays of size 1 along it.

    Examples
    --------
    >>> [tuple(part.stop for part in block) for block in blocks((3, 4), limit=8)]
    [(2, 4), (3, 4)]
    """
    if not shape:
        yield ()
        return
    step = max(1, limit // max(1, int(np.prod(shape[1:]))))
    for start in range(0, shape[0], step):
        stop = min(start + step, shape[0])
        for others in blocks(shape[1:], limit):
            yield (slice(start, stop), *others)


def checked_model(name: object, load: object, options: Mapping[str, Any]) -> Model:
    """The model of a name, if it covers the load and has the options; else an `InputError`."""
    if not isinstance(name, str) or name not in MODELS:
        raise UnknownModel([Violation("model", name, f"one of {', '.join(MODELS)}")])
    model = MODELS[name]
    if not isinstance(load, str) or load not in model.loads:
        every = dict.fromkeys(load for own in MODELS.values() for load in own.loads)
        allowed = f"one of {', '.join(every)}"
        if isinstance(load, str) and load in every:
            allowed = f"one of {', '.join(model.loads)} for model {name!r}"
        raise UnsupportedLoad([Violation("load", load, allowed)])
    known = ", ".join(model.options) or "none"
    unknown = [
        Violation(option, value, f"one of the options of model {name!r}: {known}")
        for option, value in options.items()
        if option not in model.options
    ]
    if unknown:
        raise InputError(unknown)
    return model


def _evaluate_reference(load: str, cell: Cell, options: Mapping[str, Any]) -> PointResults:
    from bondcell.fem.reference import solve

    return solve_points(cell.ravel(), solve, load=load, **options)


def _evaluate_analytic(
    model: Model, load: str, cell: Cell, options: Mapping[str, Any]
) -> tuple[PointResults, Parts]:
    results, parts = PointResults.empty(cell.shape), Parts()
    start = time.perf_counter()
    for block in blocks(cell.shape, CHUNK):
        piece = _cut(cell, block)
        springs, results.status[block] = ask(model, load, piece, **options)
        results.stiffness[block] = springs.stiffness
        results.error_estimate[block] = springs.relative_error
        for name, part in springs.parts.items():
            parts.setdefault(name, np.empty(cell.shape))[block] = part
    results.seconds[...] = (time.perf_counter() - start) / results.seconds.size
    return results, parts


def _cut(cell: Cell, block: Block) -> Cell:
    def cut(value: FloatArray) -> FloatArray:
        pairs = zip(block, value.shape, strict=True)
        return value[tuple(part if size > 1 else slice(None) for part, size in pairs)]

    return Cell(**{name: cut(value) for name, value in cell.as_dict().items()})
