"""The Prony series of a bond by any analytic model."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import lru_cache
from typing import Any

import numpy as np

from bondcell.cell import Cell, FloatArray
from bondcell.errors import UnsupportedLoad, Violation
from bondcell.models.model import Model
from bondcell.prony.bank import Bank
from bondcell.prony.chain import Chain, decade_below
from bondcell.prony.conventions import Relaxing
from bondcell.prony.model_banks import BANKS
from bondcell.prony.sampled_bank import sampled_bank

SERIES_ERROR = 1e-12
"""Bound of the relative error of an exact series, tests/verification/test_prony_springs.py."""

SAMPLED_FACTOR, DEEPEST = 3.0, 1e-6
"""Error of K(t) over that of a fit in the modulus and the share of the modulus that is left, see
tests/unit/test_relaxation.py, and the share from where on it grows no more."""

OWN_FACTOR = 2.0
"""Error of K(t) over the largest that the model has at any modulus passed, see the same."""


def bond_series(
    model: Model, load: str, matrix: Relaxing, **options: Any
) -> tuple[Chain, FloatArray]:
    """Series of every bond.

    Parameters
    ----------
    model, load
        An analytic model and one of its loads.
    matrix
        The cells and how their matrix relaxes.
    **options
        Options of the model.

    Returns
    -------
    Chain
        Shape (points,) [N/m, or N m/rad]; NaN where the model has no value.
    ndarray
        Relative numerical error of K(t); of a fitted series with the model's own at all moduli.
    """
    if load == "normal" and model.name in BANKS:
        return _exact(model.name, matrix, options)
    if matrix.convention == "separate":
        allowed = "a model with an exact series, or a convention without a bulk series"
        raise UnsupportedLoad([Violation(f"model under {load}", model.name, allowed)])
    return _fitted(model.loads[load], matrix, options)


def _exact(name: str, matrix: Relaxing, options: dict[str, Any]) -> tuple[Chain, FloatArray]:
    cell, form = matrix.cell, BANKS[name]
    own = dict(options)
    if name == "slices":
        own["relaxed"] = _lowest(matrix)
    bank = form.bank(cell, **own)
    if form.modulus == "oedometric":
        series = _oedometric(bank, matrix)
    elif matrix.convention == "constant_poisson":
        squeezed = bank.squeezed(cell.young_m)
        series = squeezed.relaxation(matrix.prony.shear, cell.young_m, np.zeros(cell.shape))
    elif matrix.convention == "constant_bulk":
        modulus = 3 * matrix.shear
        before = matrix.bulk_compliance / 9
        series = bank.squeezed(cell.young_m).relaxation(matrix.prony.shear, modulus, before)
    else:
        series = _by_matrix(bank.squeezed(cell.young_m), matrix, matrix.young_chain)
    return series, np.full(cell.shape, SERIES_ERROR)


def _oedometric(bank: Bank, matrix: Relaxing) -> Chain:
    cell = matrix.cell
    compliance = matrix.bulk_compliance
    soft = compliance > 0
    with np.errstate(divide="ignore"):
        modulus = 1 / compliance + 4 / 3 * matrix.shear
    if matrix.convention == "constant_poisson":
        modulus = np.where(soft, modulus, cell.young_m)
        squeezed = bank.squeezed(modulus)
        series = squeezed.relaxation(matrix.prony.shear, modulus, np.zeros(cell.shape))
    else:
        own = np.flatnonzero(soft)
        squeezed = bank.squeezed(np.where(soft, modulus, cell.young_m))
        series = _by_matrix(squeezed, matrix, matrix.oedometric_chain, own)
    series.equilibrium[~soft] = np.nan
    series.strengths[~soft] = np.nan
    return series


def _by_matrix(
    bank: Bank,
    matrix: Relaxing,
    chain_of: Callable[[float, float], Chain],
    points: Any = None,
) -> Chain:
    """Points whose chain has shear and bulk modulus in its own ratio, ratio by ratio."""
    count = len(bank.constant)
    points = np.arange(count) if points is None else points
    states = np.stack([matrix.shear, matrix.bulk_compliance], axis=1)[points]
    found = []
    distinct, member = np.unique(states, axis=0, return_inverse=True)
    for k, (shear, compliance) in enumerate(distinct):
        rows = points[member.ravel() == k]
        chain = chain_of(float(shear), float(compliance))
        whole = float(chain.instantaneous)
        scale, nothing = np.full(rows.size, whole), np.zeros(rows.size)
        unit = chain.times_factor(1 / whole)
        found.append((rows, bank.take(rows).relaxation(unit, scale, nothing)))
    width = max((series.count for _, series in found), default=0)
    result = Chain(np.zeros(count), np.zeros((count, width)), np.ones((count, width)))
    for rows, series in found:
        result.equilibrium[rows] = series.equilibrium
        result.strengths[rows, : series.count] = series.strengths
        result.times[rows, : series.count] = series.times
    return result


def _lowest(matrix: Relaxing) -> float:
    """Least share of E_m at t = 0 that any point relaxes to."""
    share = float(matrix.prony.shear.equilibrium)
    if matrix.prony.bulk is not None:
        share = min(share, float(matrix.prony.bulk.equilibrium))
    return share


def _fitted(
    formula: Callable[..., Any], matrix: Relaxing, options: dict[str, Any]
) -> tuple[Chain, FloatArray]:
    modulus = matrix.shear
    end = decade_below(float(matrix.prony.shear.equilibrium))
    state = np.concatenate([*matrix.cell.as_dict().values()]).tobytes()
    asked = _Asked(formula, state, matrix.convention, end, tuple(options.items()), matrix)
    bank, error, own = _fit(asked)
    series = bank.relaxation(matrix.prony.shear, modulus, np.zeros(modulus.shape))
    missing = np.isnan(error)
    series.equilibrium[missing] = np.nan
    series.strengths[missing] = np.nan
    # In time a fit misses by the stiffness at t = 0, in relation to what is left of it later.
    left = max(float(matrix.prony.shear.equilibrium), DEEPEST)
    return series, SAMPLED_FACTOR / left * error + OWN_FACTOR * own


@dataclass(frozen=True)
class _Asked:
    """What a fit depends on: of the series only its end, not its terms."""

    formula: Callable[..., Any]
    state: bytes
    convention: str
    end: float
    options: tuple[tuple[str, Any], ...]
    matrix: Relaxing = field(compare=False, repr=False)


@lru_cache(maxsize=8)
def _fit(asked: _Asked) -> tuple[Bank, FloatArray, FloatArray]:
    """The bank, what it misses of the values, and the model's own largest error among them."""
    matrix, options = asked.matrix, dict(asked.options)
    own = np.zeros(matrix.cell.shape)

    def values(shares: FloatArray) -> FloatArray:
        found = []
        for share in shares:
            springs = _springs(asked.formula, matrix.at(float(share)), options)
            np.fmax(own, springs.relative_error, out=own)
            found.append(np.asarray(springs.stiffness))
        return np.array(found)

    return *sampled_bank(values, matrix.shear, asked.end), own


def _springs(formula: Callable[..., Any], cell: Cell, options: dict[str, Any]) -> Any:
    with np.errstate(divide="ignore", over="ignore", invalid="ignore"):
        return formula(cell, **options)
