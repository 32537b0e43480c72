"""What a convergence study says: error against the finest level, observed order, a tidy table.

A study has the dimensions ``(case, method, level)``: its methods are the discretisations, its
levels their ladders from coarse to fine. Analytic models stand beside them on
``(case, analytic_model)``.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr

from bondcell.cell import FloatArray
from bondcell.status import Status
from bondcell.timing import ATTRIBUTES

STRUCTURED, GRADED, TRIANGLES = "structured", "structured_h", "triangles"
"""The discretisations: the p-ladder, the h-ladder of the same elements, that of the triangles."""

BASIS = "reduced_basis"
"""The ladder of a growing reduced basis."""

MODEL = "analytic_model"
"""Dimension of the analytic models; not ``model``, whose entries are those of the sweep."""

ROTATIONAL = "rotational_stiffness"
"""Where the stiffness under torsion and bending stands, for it has another unit."""

ROUND_OFF = 1e-13
"""Errors below it are round-off: no order is observed there."""

STAGES = ("seconds_mesh", "seconds_assembly", "seconds_solve")
"""Times of a level."""

COLUMNS = (
    "case",
    "load",
    "bc",
    "method",
    "level",
    "refinement",
    "dof",
    "elements",
    "stiffness",
    "unit",
    "error",
    "order",
    *STAGES,
    *ATTRIBUTES,
    "status",
    "bound",
    "sample_error",
)
"""Columns of `convergence_table`."""


def relative_error(stiffness: FloatArray, reference: float) -> FloatArray:
    """``|K / K_reference - 1|``; the level that is the reference itself has none (NaN)."""
    error = np.abs(stiffness / reference - 1)
    return np.where(stiffness == reference, np.nan, error)


def observed_order(error: FloatArray, work: FloatArray) -> FloatArray:
    """Observed order of convergence from each level to the next.

    Parameters
    ----------
    error
        Relative errors from coarse to fine, shape (levels,), NaN where there is none.
    work
        What grows with refinement, as a logarithm: ``ln(dof^(1/2))`` for an h-ladder, the
        polynomial order for a p-ladder; shape (levels,).

    Returns
    -------
    numpy.ndarray
        ``-d ln(error) / d work``, shape (levels,): the order in h for triangles, where
        ``error ~ h^order``; the exponential rate for the p-ladder, ``error ~ exp(-order p)``.
        NaN at the first level and where an error is missing or mere round-off.

    Examples
    --------
    >>> h = np.array([0.4, 0.2, 0.1])
    >>> observed_order(3 * h**4, -np.log(h)).round(12)
    array([nan,  4.,  4.])
    """
    order = np.full(error.shape, np.nan)
    seen = np.flatnonzero((error > ROUND_OFF) & np.isfinite(work))
    gain, step = -np.diff(np.log(error[seen])), np.diff(work[seen])
    order[seen[1:]] = np.divide(gain, step, out=np.full(step.shape, np.nan), where=step > 0)
    return order


def combine_cases(cases: Mapping[str, xr.Dataset]) -> xr.Dataset:
    """Put the results of several cases on one dimension ``case``.

    Parameters
    ----------
    cases
        Case name -> its result, as `bondcell.jobs.convergence_run.run_case` gives it.
    """
    names = xr.DataArray(list(cases), dims="case", name="case", attrs={"long_name": "case"})
    missing = {"status": Status.not_computed, "dof": 0, "elements": 0}
    first = next(iter(cases.values()))
    present = {name: value for name, value in missing.items() if name in first}
    return xr.concat(
        list(cases.values()),
        dim=names,
        join="outer",
        combine_attrs="drop_conflicts",
        fill_value={name: first[name].dtype.type(value) for name, value in present.items()}
        | {name: np.nan for name in first.data_vars if first[name].dtype.kind == "f"},
    )


def convergence_table(study: xr.Dataset) -> pd.DataFrame:
    """One row for each level of each discretisation, and for each analytic model, of each case.

    Parameters
    ----------
    study
        A convergence study on ``(case, method, level)``.

    Returns
    -------
    pandas.DataFrame
        The `COLUMNS`. ``refinement`` is the polynomial order of ``structured``, the ratio of
        neighbouring elements of ``structured_h``, the element size of ``triangles``, the number of
        vectors of ``reduced_basis``; ``error`` is relative to the finest structured level, which
        has none itself; ``order`` as in `observed_order`; times [s] are medians of repeats (but
        ``seconds_spread``, from the quickest to the slowest), those of a reduced basis and of an
        analytic model per point. An analytic model has neither level
        nor unknowns. ``bound`` and ``sample_error`` of a reduced basis are its largest bound over
        random materials and its largest true error over a sample of them.
    """
    rows = []
    for case in study["case"].values:
        of_case = study.sel(case=case)
        head = {name: str(of_case[name].values) for name in ("case", "load", "bc", "unit")}
        rows += [head | row for row in _ladder_rows(of_case)]
        rows += [head | row for row in _model_rows(of_case)]
    table = pd.DataFrame(rows, columns=list(COLUMNS))
    whole = ["level", "dof", "elements"]
    return table.astype(dict.fromkeys(whole, "Int64"))


def _ladder_rows(of_case: xr.Dataset) -> list[dict[str, Any]]:
    rows = []
    for method in of_case["method"].values if "method" in of_case.dims else ():
        ladder = of_case.sel({"method": method})  # as a keyword it is an option of sel
        for level in ladder["level"].values[np.isfinite(ladder["refinement"].values)]:
            at = ladder.sel(level=level)
            known = [name for name in COLUMNS if name in at.data_vars and not at[name].isnull()]
            row = {name: at[name].item() for name in known if at[name].dtype.kind in "iuf"}
            row |= _stiffness(at, "")
            rows.append(row | {"method": str(method), "level": int(level)} | _status(row["status"]))
    return rows


def _model_rows(of_case: xr.Dataset) -> list[dict[str, Any]]:
    rows = []
    for model in of_case[MODEL].values if MODEL in of_case.dims else ():
        at = of_case.sel({MODEL: model})
        if at["model_status"] == Status.not_computed:
            continue
        wanted = [name for name in ("error", *ATTRIBUTES, "status") if f"model_{name}" in at]
        row = {name: at[f"model_{name}"].item() for name in wanted}
        row |= _stiffness(at, "model_")
        rows.append(row | {"method": str(model)} | _status(row["status"]))
    return rows


def _stiffness(at: xr.Dataset, prefix: str) -> dict[str, float]:
    """The stiffness, from whichever variable the load's unit put it in."""
    values = [at[prefix + name].item() for name in ("stiffness", ROTATIONAL) if prefix + name in at]
    known = [value for value in values if np.isfinite(value)]
    return {"stiffness": known[0] if known else np.nan}


def _status(code: float) -> dict[str, str]:
    return {"status": Status(int(code)).name}
