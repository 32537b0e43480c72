"""What a specimen's jobs found, put together and compared with the best known solution."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr

from bondcell.cell import FloatArray
from bondcell.specimen.compare import compare
from bondcell.specimen.names import METHODS, SOLIDS, WALLS
from bondcell.status import Status, cf_flag_attributes

LEVELS = ("level_energy", "level_dof", "level_seconds", "level_seconds_cpu")
BONDS = ("bond_force", "bond_nodes")

_REFERENCE = {
    "reference_energy": {"units": "J", "long_name": "best known energy of the solid"},
    "reference_error": {"units": "1", "long_name": "relative uncertainty of that energy"},
}


def combine(parts: Mapping[str, xr.Dataset]) -> tuple[xr.Dataset, dict[str, xr.Dataset]]:
    """Results of all methods on common dimensions, and the groups beside them.

    Parameters
    ----------
    parts
        Part -> what `bondcell.specimen.run.run_part` gave.

    Returns
    -------
    tuple
        The root group with the comparison; the groups ``ladder``, ``bonds``, ``relaxation`` and
        ``finite_strain`` of what there is. A method that was asked for nowhere has no row; a
        combination that was not computed is NaN and flagged.
    """
    found = [parts[name] for name in ("lattices", *SOLIDS) if name in parts]
    groups = {name: parts[name] for name in ("relaxation", "finite_strain") if name in parts}
    walls = [name for name in WALLS if any(name in part.walls.values for part in found)]
    data = xr.concat([_filled(part, walls) for part in found], "method", "all", join="outer")
    if "per_gap" in data.dims:
        data = data.sortby("per_gap", ascending=False)
    asked = {str(name) for part in parts.values() for name in part["method"].values}
    data = _blank(data, method=[name for name in METHODS if name in asked])
    for name in (*(str(name) for name in data.data_vars),):
        source = next(part for part in found if name in part)
        data[name].attrs = source[name].attrs
    data["status"] = data["status"].astype(np.int8).assign_attrs(cf_flag_attributes())
    data["dof"] = data["dof"].astype(np.int64).assign_attrs(found[0]["dof"].attrs)
    data = _with_reference(data)
    ladder = [name for name in LEVELS if name in data]
    if ladder:
        groups["ladder"] = data[ladder]
    groups["bonds"] = parts["lattices"][list(BONDS)]
    root = data.drop_vars(
        [*ladder, *(name for name in data.coords if name in ("per_gap", "order"))]
    )
    return root, {name: _aligned(group, root) for name, group in groups.items()}


def _aligned(group: xr.Dataset, root: xr.Dataset) -> xr.Dataset:
    """A group on the root's coordinates, so that the file is a tree; NaN where it has nothing."""
    shared = [name for name in ("method", "loading", "walls") if name in group.dims]
    return group.reindex({name: root[name].values for name in shared})


def _filled(part: xr.Dataset, walls: list[str]) -> xr.Dataset:
    """A part on all walls, without what goes into the group of bonds."""
    kept = part.drop_vars([name for name in (*BONDS, "force") if name in part.variables])
    return _blank(kept, walls=walls)


def _blank(data: xr.Dataset, **names: list[str]) -> xr.Dataset:
    """The data on more methods or walls: NaN and flagged where there was nothing."""
    blank: dict[Any, Any] = {"status": Status.not_computed, "dof": 0}
    others = {name: np.nan for name in data.data_vars if name not in blank}
    return data.reindex(names, fill_value=others | blank)


def _with_reference(data: xr.Dataset) -> xr.Dataset:
    """Add the best known energy and every method's errors."""
    energy, error, from_method = best_energy(data)
    dims = ("loading", "walls")
    data["reference_energy"] = (dims, energy, _REFERENCE["reference_energy"])
    data["reference_error"] = (dims, error, _REFERENCE["reference_error"])
    if not from_method:
        return data
    # Displacements converge faster than the energy: the lowest solution serves as it is.
    solid = data.sel({"method": from_method})
    for name in SOLIDS:
        if name in data["method"].values:
            solid = solid.fillna(data.sel({"method": name}))
    row = data["method"].values == from_method
    filled = data[["energy", "displacement", "rotation", "displacement_norm"]].copy(deep=True)
    for key in filled.data_vars:
        filled[key].values[row] = solid[key].values
    errors = compare(filled, from_method).drop_vars("energy_ratio")
    ratio = data["energy"] / data["reference_energy"]
    ratio.attrs = {"units": "1", "long_name": "energy over the best known one"}
    known = data["energy"].notnull()
    for key, values in errors.items():
        data[key] = values.where(known).assign_attrs(values.attrs)
    return data.assign(energy_ratio=ratio)


def best_energy(data: xr.Dataset) -> tuple[FloatArray, FloatArray, str]:
    """Energy of the solid without discretisation error, as well as it is known.

    Parameters
    ----------
    data
        All methods with their ladders.

    Returns
    -------
    tuple
        Energy [J] and its relative uncertainty, both on (loading, walls), and the method whose it
        is: elastic particles where they were solved; ``""`` without a solid.

    Notes
    -----
    The lowest solution times the ratio of limit to value of a ladder that has this mesh: its own,
    or that of rigid particles or other walls, whose relative error on one mesh is nearly the same
    because it arises in the gaps. Of several the surest one is taken, and its uncertainty.
    """
    shape = (data.sizes["loading"], data.sizes["walls"])
    energy, error = np.full(shape, np.nan), np.full(shape, np.nan)
    solved_by = data["method"].values[data["energy"].notnull().any(("loading", "walls")).values]
    solids = [name for name in reversed(SOLIDS) if name in solved_by]
    for i, loading in enumerate(data["loading"].values):
        here = data.sel(loading=loading)
        for k, walls in enumerate(data["walls"].values):
            for method in solids:
                levels = here["level_energy"].sel({"method": method, "walls": walls})
                if levels.isnull().all():
                    continue
                lowest = levels.isel({str(k): v for k, v in levels.argmin(...).items()})
                level = {name: float(lowest[name]) for name in ("per_gap", "order")}
                factor, error[i, k] = _correction(here, solids, level)
                energy[i, k] = float(lowest) * factor
                break
    return energy, error, solids[0] if solids else ""


def _correction(
    here: xr.Dataset, solids: list[str], level: dict[str, float]
) -> tuple[float, float]:
    """Limit over value at a level, and the limit's uncertainty, by the surest ladder with it."""
    best = (1.0, np.nan)
    for method in solids:
        for walls in here["walls"].values:
            row = here.sel({"method": method, "walls": walls})
            energy = float(row["level_energy"].sel(level))
            limit, doubt = float(row["limit_energy"]), float(row["limit_error"])
            if np.isfinite(energy * doubt) and not best[1] <= doubt:
                best = (limit / energy, doubt)
    return best
