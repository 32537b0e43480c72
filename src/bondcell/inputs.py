"""From a study, labelled by name, to a cell, plain arrays: the edge between the two floors."""

from __future__ import annotations

from collections.abc import Hashable
from typing import Any

import numpy as np
import xarray as xr

from bondcell.cell import UNITS, Cell
from bondcell.errors import InputError, Violation


def cell_from_study(study: xr.Dataset) -> tuple[Cell, tuple[str, ...]]:
    """The inputs of a study as a checked cell whose arrays are aligned to common dimensions.

    Parameters
    ----------
    study
        Inputs by the names of `bondcell.cell.UNITS` in SI units, as data variables or coordinates.

    Returns
    -------
    Cell
        Every field has one axis for each dimension, of size 1 where the input does not vary.
    tuple of str
        The dimensions that the inputs have, in the study's order.

    Raises
    ------
    InputError
        Names every wrong input with its value and what is allowed.

    Examples
    --------
    >>> study = xr.Dataset(
    ...     {
    ...         "radius_i": 1.0,
    ...         "young_i": 1e9,
    ...         "poisson_i": 0.2,
    ...         "poisson_m": ("nu", [0.0, 0.3, 0.4]),
    ...     },
    ...     coords={"gap": [0.1, 0.2], "young_m": 1e6},
    ... )
    >>> cell, dims = cell_from_study(study)
    >>> dims, cell.shape, cell.gap.shape
    (('nu', 'gap'), (3, 2), (1, 2))
    """
    if not isinstance(study, xr.Dataset):
        raise InputError([Violation("study", type(study).__name__, "an xarray.Dataset")])
    _check_units(study)
    names = [*study.data_vars, *(name for name in study.coords if name in UNITS)]
    used = {dim for name in names for dim in study[name].dims}
    dims = tuple(dim for dim in study.sizes if dim in used)
    empty = [
        Violation(str(dim), "no values", "at least one") for dim in dims if not study.sizes[dim]
    ]
    if empty:
        raise InputError(empty)
    values = {str(name): _aligned(study[name].variable, dims) for name in names}
    return Cell.from_values(**values), tuple(str(dim) for dim in dims)


def _aligned(variable: xr.Variable, dims: tuple[Hashable, ...]) -> np.ndarray[Any, Any]:
    ordered = variable.transpose(*(dim for dim in dims if dim in variable.dims))
    return ordered.values.reshape([variable.sizes.get(dim, 1) for dim in dims])


def _check_units(study: xr.Dataset) -> None:
    violations = []
    for name, unit in UNITS.items():
        given = study[name].attrs.get("units", unit) if name in study.variables else unit
        if given != unit:
            violations.append(Violation(f"{name}.units", given, f"{unit!r}: values are SI"))
    if violations:
        raise InputError(violations)
