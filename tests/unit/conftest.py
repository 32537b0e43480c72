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


def make_convergence(cases: tuple[str, ...] = ("base", "narrow_gap")) -> xr.Dataset:
    """Two ladders and two models on each case: orders p fall by e^-3 each, triangles as h^4."""
    order, size = np.arange(2.0, 8.0), np.array([1.0, 0.5, 0.25])
    shape = (len(cases), 2, order.size)
    data = {name: np.full(shape, np.nan) for name in ("refinement", "error", "order", "seconds")}
    data["refinement"][:, 0], data["refinement"][:, 1, :3] = order, size
    data["error"][:, 0], data["error"][:, 1, :3] = np.exp(-3 * order), 1e-3 * size**4
    data["order"][:, 0, 1:], data["order"][:, 1, 1:3] = 3.0, 4.0
    data["seconds"][:, 0], data["seconds"][:, 1, :3] = 1e-2 * order**2, 0.2 / size**2
    data["stiffness"] = 1.6e5 * (1 + data["error"])
    data["error"][:, 0, -1] = np.nan  # the finest level is the reference itself
    for stage in ("mesh", "assembly", "solve"):
        data[f"seconds_{stage}"] = data["seconds"] / 3
    whole = {"dof": np.zeros(shape, int), "elements": np.full(shape, 20)}
    whole["dof"][:, 0] = 24 * order**2
    whole["dof"][:, 1, :3] = 1500 / size**2
    whole["status"] = np.zeros(shape, np.int8)
    dims = ("case", "method", "level")
    study = xr.Dataset({name: (dims, values) for name, values in (data | whole).items()})
    for name, values in {
        "stiffness": [8.4e4, 4.9e5],
        "error": [0.48, 2.0],
        "seconds": [1e-7, 5e-8],
        "status": [0, 0],
    }.items():
        study[f"model_{name}"] = ("analytic_model", np.array(values))
        study[f"model_{name}"] = study[f"model_{name}"].expand_dims(case=len(cases))
    study["bc"] = ("case", ["roller"] * len(cases))
    study["load"] = ("case", ["normal"] * len(cases))
    study["unit"] = ("case", ["N m-1"] * len(cases))
    study["reference_error"] = ("case", [1e-9] * len(cases))
    return study.assign_coords(
        case=list(cases),
        method=["structured", "triangles"],
        level=np.arange(order.size),
        analytic_model=["fsi", "slices"],
    )


@pytest.fixture(scope="session")
def synthetic() -> SimpleNamespace:
    """Synthetic results: ``figure4``, ``maps``, ``point``, ``convergence``, the maker itself."""
    ratio = np.geomspace(1, 1e6, 25)
    return SimpleNamespace(
        make=make_study,
        figure4=make_study({"modulus_ratio": ratio, "poisson_m": np.array([0.0, 0.46])}),
        maps=make_study(
            {
                "gap_ratio": np.geomspace(1e-3, 1, 7),
                "modulus_ratio": np.geomspace(1, 1e6, 7),
                "poisson_m": np.array([0.0, 0.25, 0.46]),
            },
            models=("fsi", "cementation", "fe"),
        ),
        point=make_study({}),
        convergence=make_convergence(),
    )
