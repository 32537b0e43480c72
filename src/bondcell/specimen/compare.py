"""How far the specimen's methods are from one of them."""

from __future__ import annotations

from typing import Any

import xarray as xr

from bondcell.lattice import specimen_geometry as given


def compare(data: xr.Dataset, reference: str = "fe_elastic") -> xr.Dataset:
    """Errors of every method against one of them.

    Parameters
    ----------
    data
        From `bondcell.specimen.specimen.specimen`.
    reference
        The method taken as right.

    Returns
    -------
    xarray.Dataset
        ``energy_ratio``, ``norm_ratio`` (of displacement norms), ``displacement_error`` (norm of
        the difference of the displacement vectors of the particles that are neither loaded nor
        fixed, over the reference's norm of them) and ``rotation_error`` (the same of the rotations
        of all that are not fixed); NaN for lattices without rotations.
    """
    other = data.sel({"method": reference})
    count = len(given.LOADED)
    free = slice(count + 1, sum(given.ROWS[:2]))
    moved, turned = data.displacement.sel(particle=free), data.rotation.sel(particle=slice(1, 11))
    right_moved = other.displacement.sel(particle=free)
    right_turned = other.rotation.sel(particle=slice(1, 11))
    dims = ("particle", "component")

    def norm(values: xr.DataArray, over: Any) -> xr.DataArray:
        return (values**2).sum(over, skipna=False) ** 0.5

    result = xr.Dataset(
        {
            "energy_ratio": data.energy / other.energy,
            "norm_ratio": data.displacement_norm / other.displacement_norm,
            "displacement_error": norm(moved - right_moved, dims) / norm(right_moved, dims),
            "rotation_error": norm(turned - right_turned, "particle")
            / norm(right_turned, "particle"),
        }
    )
    for name in result:
        result[name].attrs = {"units": "1", "long_name": str(name).replace("_", " ")}
    return result.assign_attrs(reference=reference)
