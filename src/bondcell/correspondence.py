"""A check of any bond's series that knows nothing of how it was found.

At a real Laplace variable s the matrix is an elastic one with the share
``x(s) = g_inf + sum g_k s tau_k/(1 + s tau_k)`` of its relaxing modulus, and the series must be the
elastic stiffness of that cell: ``K_inf + sum K_k s tau_k/(1 + s tau_k)``.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Protocol

import numpy as np
import xarray as xr

from bondcell.cell import FloatArray
from bondcell.evaluate import evaluate
from bondcell.prony.chain import Chain
from bondcell.prony.conventions import Relaxing
from bondcell.status import Status

REACH = 10.0
"""How far beyond the relaxation times the variables reach."""

ROUND_OFF = 1e-12
"""Relative difference that round-off alone may make."""


class AskedModel(Protocol):
    """A model with its options."""

    @property
    def model(self) -> str:
        """Name."""

    @property
    def options(self) -> Mapping[str, Any]:
        """Options."""


def variables(matrix: Relaxing, count: int) -> FloatArray:
    """Real Laplace variables [1/s] that span the relaxation times of the matrix."""
    times = matrix.prony.shear.times
    if not times.size:
        return np.ones(1)
    return np.geomspace(1 / (REACH * times.max()), REACH / times.min(), count)


def correspondence(
    chain: Chain,
    series: xr.Dataset,
    matrix: Relaxing,
    asked: AskedModel,
    load: str,
    count: int,
) -> dict[str, FloatArray]:
    """Largest difference at `count` variables, and what the error estimates allow, by point.

    Parameters
    ----------
    chain, series
        The bonds' series, shape (points,), and how it was told.
    matrix
        The cells and how their matrix relaxes.
    asked
        Model and options.
    load
        Load name.
    count
        Number of variables.
    """
    s = variables(matrix, count)
    found = chain.transform(s)
    cells = [matrix.at(float(x)) for x in matrix.prony.shear.transform(s)]
    values = [cell.as_dict() for cell in cells]
    shape = matrix.cell.shape
    stacked = {
        name: ("s", np.concatenate([np.broadcast_to(cell[name], shape) for cell in values]))
        for name in values[0]
    }
    elastic = evaluate(xr.Dataset(stacked), asked.model, load, **dict(asked.options))
    table = (s.size, -1)
    known = (elastic["status"].values < Status.limit_exceeded).reshape(table) & np.isfinite(found)
    value = elastic["stiffness"].values.reshape(table)
    difference = np.abs(np.where(known, found, 1.0) / np.where(known, value, 1.0) - 1)
    estimate = elastic["error_estimate"].values.reshape(table)
    allowed = np.where(known, estimate, 0.0).max(axis=0) + series["error_estimate"].values
    error = difference.max(axis=0)
    return {
        "correspondence_error": np.where(known.any(axis=0), error, np.nan),
        "correspondence_allowed": allowed + ROUND_OFF,
    }
