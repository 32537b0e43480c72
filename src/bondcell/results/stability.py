"""How the reference fares at every point: estimate, flag, cost and condition, worst first."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pandas as pd
import xarray as xr

from bondcell.outputs import WAYS
from bondcell.results.view import parameters, reference_names
from bondcell.status import Status

FLAGS: Mapping[Status, str] = {
    Status.ok: "the estimated error is within the tolerance",
    Status.outside_valid_range: "outside the range for which the model is made",
    Status.tolerance_not_met: "a value, but its estimated error is above the tolerance: the bound "
    "on unknowns was reached, or what the mesh leaves out matters",
    Status.limit_exceeded: "no value: too few orders fit into the bound on unknowns",
    Status.solver_failed: "no value: the equations could not be solved to a positive stiffness",
    Status.mesh_failed: "no value: the geometry could not be meshed",
    Status.diverges: "no value: the stiffness itself is infinite",
    Status.not_computed: "no value: it was not asked for",
}
"""What each flag means for the reference."""


def condition(study: xr.Dataset) -> xr.DataArray:
    """Largest over smallest modulus of the cell: a proxy for the condition of its equations.

    Parameters
    ----------
    study
        Inputs of a sweep.

    Returns
    -------
    xarray.DataArray
        Among shear moduli and bulk moduli of matrix and particles, those that are finite: a rigid
        particle has none, an incompressible material no bulk modulus.

    Examples
    --------
    >>> moduli = {"young_i": 3e10, "young_j": 3e10, "young_m": 3e6}
    >>> poisson = {"poisson_i": 0.5, "poisson_j": 0.5, "poisson_m": 0.5}
    >>> float(condition(xr.Dataset(moduli | poisson)))
    10000.0
    """
    moduli = []
    with np.errstate(divide="ignore"):
        for part in "ijm":
            young, poisson = study[f"young_{part}"], study[f"poisson_{part}"]
            moduli += [young / (2 * (1 + poisson)), young / (3 * (1 - 2 * poisson))]
    kinds = xr.concat(xr.broadcast(*moduli), "modulus")
    finite = kinds.where(np.isfinite(kinds))
    return (finite.max("modulus") / finite.min("modulus")).rename("condition")


def stability_table(loads: Mapping[str, xr.Dataset]) -> pd.DataFrame:
    """Every point of the reference under every load, the worst first.

    Parameters
    ----------
    loads
        Load -> result, see `bondcell.results.load_groups.read_loads`.

    Returns
    -------
    pandas.DataFrame
        ``load``, ``reference``, the axes, ``stiffness`` [N m-1; N m rad-1 for torsion and
        bending], ``error_estimate``, ``status`` (its name), ``order``, ``dof``, ``seconds``,
        ``way``, ``condition``. Points without a value come first, then by falling estimate.
    """
    tables = [
        _points(study, load, name)
        for load, study in loads.items()
        for name in reference_names(study)
    ]
    table = pd.concat(tables, ignore_index=True)
    worst = table["error_estimate"].fillna(np.inf)
    return table.loc[worst.sort_values(ascending=False, kind="stable").index].reset_index(drop=True)


def stability_summary(table: pd.DataFrame) -> pd.DataFrame:
    """Points by load and flag: how many, their largest estimate and their time.

    Parameters
    ----------
    table
        See `stability_table`.
    """
    groups = table.groupby(["load", "reference", "status"], sort=False)
    summary = groups.agg(
        points=("status", "size"),
        largest_estimate=("error_estimate", "max"),
        median_seconds=("seconds", "median"),
        largest_seconds=("seconds", "max"),
        largest_dof=("dof", "max"),
    ).reset_index()
    rank = summary["status"].map({flag.name: flag.value for flag in Status})
    return summary.assign(rank=rank).sort_values(["load", "rank"]).drop(columns="rank")


def _points(study: xr.Dataset, load: str, name: str) -> pd.DataFrame:
    here = study.sel(model=name, drop=True)
    axes = [str(axis) for axis in here["stiffness"].dims]
    columns = ["stiffness", "error_estimate", "status", "order", "dof", "seconds", "way"]
    chosen = here[columns].assign(condition=condition(study).broadcast_like(here["stiffness"]))
    if not axes:
        chosen = chosen.expand_dims("point")
    frame = chosen.to_dataframe(dim_order=axes or ["point"]).reset_index()
    frame["status"] = [Status(int(code)).name for code in frame["status"]]
    frame["way"] = [WAYS[int(code)] for code in frame["way"]]
    frame.insert(0, "reference", name)
    frame.insert(0, "load", load)
    kept = ["load", "reference", *axes]
    kept += [name for name in parameters(study) if name not in axes] + [*columns, "condition"]
    return frame[kept]
