"""A specimen's results as figures and tables read them: names, rows, the fullest lattice."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import product
from pathlib import Path

import numpy as np
import pandas as pd
import xarray as xr

from bondcell.errors import DataError
from bondcell.specimen.names import LATTICES, SOLIDS
from bondcell.storage import read_dataset

NAMES: Mapping[str, str] = {
    "fe_rigid": "3D solid, rigid particles",
    "fe_elastic": "3D solid, elastic particles",
    "lattice_paper": "paper's lattice",
    "lattice_fsi": "FSI lattice",
    "lattice_film": "film lattice",
    "lattice_fe_normal": "FE normal lattice",
    "lattice_fe_shear": "FE normal + shear lattice",
    "lattice_fe_beam": "FE beam lattice",
    "lattice_full": "full lattice",
}
"""Methods in tables and legends."""

GROUPS = ("ladder", "bonds", "relaxation", "finite_strain", "midplane")

Results = Mapping[str, xr.Dataset]
"""The groups of a specimen's file; the root's name is empty."""


def read_specimen(path: str | Path) -> dict[str, xr.Dataset]:
    """All groups that a specimen's file has, the root under the name ``""``."""
    found = {"": read_dataset(path)}
    for group in GROUPS:
        try:
            found[group] = read_dataset(path, group)
        except DataError as error:
            if error.violations[0].field != "group":
                raise
    return found


def rows_of(study: xr.Dataset, known: tuple[str, ...]) -> list[str]:
    """Methods of a kind whose energy the file has, in their order."""
    there = study["energy"].notnull()
    there = there.any([dim for dim in there.dims if dim != "method"])
    found = there["method"].values[there.values]
    return [name for name in known if name in found]


def fullest(study: xr.Dataset) -> str:
    """The lattice with the most springs."""
    return rows_of(study, LATTICES)[-1]


def best_solid(study: xr.Dataset) -> str:
    """The solid that lattices are compared with, empty without one."""
    return next(iter(rows_of(study, SOLIDS[::-1])), "")


def first_walls(study: xr.Dataset) -> str:
    """Free walls where the fullest lattice has them."""
    there = study["energy"].sel({"method": fullest(study)}).notnull().any("loading")
    known = there["walls"].values[there.values].tolist()
    return "free" if "free" in known else str(known[0])


def error_table(results: Results) -> pd.DataFrame:
    """Every method under every loading and kind of walls, each level of the solid for itself.

    Parameters
    ----------
    results
        See `read_specimen`.

    Returns
    -------
    pandas.DataFrame
        ``loading``, ``walls``, ``method``, ``per_gap`` and ``order`` (of solids), ``dof``,
        ``seconds``, ``energy`` [J], ``energy_error`` (to the best known energy),
        ``displacement_error``, ``rotation_error``; what was not computed has no row.
    """
    study, ladder = results[""], results.get("ladder", xr.Dataset())
    rows = []
    for loading in study["loading"].values:
        for walls in study["walls"].values:
            here = study.sel(loading=loading, walls=walls)
            right = float(here["reference_energy"])
            place = {"loading": str(loading), "walls": str(walls)}
            for method in rows_of(study, LATTICES):
                one = here.sel({"method": method})
                if np.isfinite(one["energy"]):
                    rows.append({**place, "method": method, **_row(one, right)})
            for method in rows_of(study, SOLIDS):
                rows += [
                    {**place, "method": method, **level}
                    for level in _levels(ladder, here, method, place, right)
                ]
    return pd.DataFrame(rows)


def _row(one: xr.Dataset, right: float) -> dict[str, float]:
    errors = {
        name: float(one[name]) if name in one else np.nan
        for name in ("displacement_error", "rotation_error")
    }
    return {
        "per_gap": np.nan,
        "order": np.nan,
        "dof": int(one["dof"]),
        "seconds": float(one["seconds"]),
        "energy": float(one["energy"]),
        "energy_error": float(one["energy"]) / right - 1,
        **errors,
    }


def _levels(
    ladder: xr.Dataset, here: xr.Dataset, method: str, place: dict[str, str], right: float
) -> list[dict[str, float]]:
    levels = ladder.sel({"method": method, **place})
    found = []
    sure = bool(np.isfinite(here["reference_error"]))
    for size, order in product(levels["per_gap"].values, levels["order"].values):
        level = levels.sel(per_gap=size, order=order)
        energy = float(level["level_energy"])
        if np.isfinite(energy):
            lowest = energy == float(here["energy"].sel({"method": method}))
            row = _row(here.sel({"method": method}), right)
            if not lowest:
                row |= {"displacement_error": np.nan, "rotation_error": np.nan}
            row |= {
                "per_gap": float(size),
                "order": int(order),
                "dof": int(level["level_dof"]),
                "seconds": float(level["level_seconds"]),
                "energy": energy,
                # One mesh alone does not say how far it is off.
                "energy_error": energy / right - 1 if sure else np.nan,
            }
            found.append(row)
    return found
