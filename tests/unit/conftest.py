"""Results of the agreed form, made from closed expressions in milliseconds instead of solved."""

from types import SimpleNamespace

import numpy as np
import pytest
import xarray as xr

from bondcell.status import cf_flag_attributes

RADIUS = 7.5e-3
YOUNG = 30e9
MODELS = ("fsi", "general", "generatrix", "slices", "parallel_bond", "cementation", "fe")
OFFSET = {"general": 1.04, "generatrix": 0.98, "slices": 4.0, "parallel_bond": 2.0}


def make_study(axes: dict[str, np.ndarray], models: tuple[str, ...] = MODELS) -> xr.Dataset:
    """A sweep whose fake reference is the series model with a stiffer, nu-dependent interface.

    The axes may be ``modulus_ratio``, ``gap_ratio`` and ``poisson_m``.
    """
    grid = xr.Dataset(coords={name: (name, np.asarray(v, float)) for name, v in axes.items()})
    one = xr.DataArray(1.0)
    ratio = grid.get("modulus_ratio", one * YOUNG / 1.4e6)
    gap = grid.get("gap_ratio", one / 15) * RADIUS
    poisson = grid.get("poisson_m", one * 0.46)
    young_m = YOUNG / ratio
    length = 2 * RADIUS + gap
    k_i = 2 * np.pi * YOUNG * RADIUS * xr.ones_like(ratio)
    k_int = 2 * np.pi * young_m * (length / 4 * np.log(length / gap) - RADIUS / 2)
    fsi = 1 / (2 / k_i + 1 / k_int)
    fe = 1 / (2 / k_i + 1 / (k_int * (1.04 + 0.9 * (poisson / 0.46) ** 4)))
    values = {name: fsi * OFFSET.get(name, 1.0) for name in models if name != "fe"}
    if "cementation" in values:
        values["cementation"] = (fsi * 1.2).where(poisson < 0.45)
    if "fe" in models:
        values["fe"] = fe
    dims = tuple(axes)
    stiffness = xr.concat(
        [value.broadcast_like(grid) for value in values.values()], dim="model"
    ).transpose("model", *dims)
    data = xr.Dataset({"stiffness": stiffness}).assign_coords(model=list(values))
    data["stiffness"].attrs = {"units": "N m-1", "long_name": "normal stiffness of the bond"}
    data["error_estimate"] = xr.full_like(data["stiffness"], 1e-14)
    data["error_estimate"].loc[{"model": [m for m in values if m == "fe"]}] = 1e-7
    data["status"] = xr.where(data["stiffness"].isnull(), 6, 0).astype(np.int8)
    data["status"].attrs = cf_flag_attributes()
    data["dof"] = xr.zeros_like(data["status"], dtype=np.int64)
    data["seconds"] = xr.full_like(data["stiffness"], 1e-6)
    data["seconds"].attrs = {"units": "s", "long_name": "wall time per point"}
    full = stiffness.isel(model=0, drop=True)
    for name, part in {"k_i": k_i, "k_int": k_int, "k_j": k_i}.items():
        data[name] = part.broadcast_like(full).transpose(*dims)
        data[name].attrs = {"units": "N m-1", "long_name": f"spring {name} of model fsi"}
    for name, value in {
        "radius_i": RADIUS,
        "gap": gap,
        "young_i": YOUNG,
        "young_m": young_m,
    }.items():
        data[name] = value
    data["poisson_i"], data["poisson_m"] = 0.25, poisson
    data = data.drop_vars("poisson_m") if "poisson_m" not in dims else data
    for axis in dims:
        data[axis].attrs = {"units": "1", "long_name": axis.replace("_", " ")}
    data.attrs = {"Conventions": "CF-1.11", "title": "Synthetic scene"}
    return data


@pytest.fixture(scope="session")
def synthetic() -> SimpleNamespace:
    """Synthetic results: ``figure4``, ``maps``, ``point`` and the maker itself."""
    ratio = np.geomspace(1, 1e6, 25)
    return SimpleNamespace(
        make=make_study,
        figure4=make_study({"modulus_ratio": ratio, "poisson_m": np.array([0.0, 0.46])}),
        maps=make_study(
            {
                "gap_ratio": np.geomspace(1e-3, 1, 7),
                "modulus_ratio": np.geomspace(1, 1e6, 7),
                "poisson_m": np.array([0.0, 0.25, 0.46]),
            }
        ),
        point=make_study({}),
    )
