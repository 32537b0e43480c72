"""The specimen at finite strain: how far its energies are from those of the linear theory."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import xarray as xr

from bondcell.cell import FloatArray
from bondcell.errors import InputError, Violation
from bondcell.lattice import specimen_geometry as given
from bondcell.lattice.large import solve_large
from bondcell.specimen.bonds import Material
from bondcell.specimen.lattice_variants import specimen_lattice
from bondcell.specimen.names import DIRECTIONS
from bondcell.specimen.names import FINITE_STRAIN as METHODS


def specimen_finite_strain(
    methods: Sequence[str] = METHODS,
    directions: Sequence[str] = tuple(DIRECTIONS),
    walls: str = "free",
    per_gap: float = 1.0,
    material: Material | None = None,
    steps: int = 2,
) -> xr.Dataset:
    """Displace particles 1 to 3 by 0.5 mm, by the linear theory and at finite strain.

    Parameters
    ----------
    methods, directions
        Names in `METHODS` and `DIRECTIONS`.
    walls
        ``free`` or ``fixed``.
    per_gap
        Element size of the solid relative to the gap.
    material
        Elastic constants; default: the paper's.
    steps
        Load steps.

    Returns
    -------
    xarray.Dataset
        On ``method`` and ``direction``: ``energy`` and ``linear_energy`` [J] and their ``ratio``.

    Raises
    ------
    InputError
        A name is unknown.
    BondcellError
        Newton's method does not converge.

    Examples
    --------
    >>> out = specimen_finite_strain(["lattice_fsi"], ["+x"])
    >>> bool(0.95 < out.ratio.item() < 1.05)
    True
    """
    chosen = {"methods": (methods, METHODS), "directions": (directions, tuple(DIRECTIONS))}
    violations = [
        Violation(field, name, f"one of {', '.join(known)}")
        for field, (names, known) in chosen.items()
        for name in names
        if name not in known
    ]
    if violations:
        raise InputError(violations)
    own = material or Material()
    ways = given.DISPLACEMENT * np.array([DIRECTIONS[name] for name in directions])
    found = np.array(
        [
            _solid(ways, walls, per_gap, own, steps)
            if name == "fe_elastic"
            else _lattice(name, ways, walls, own, steps)
            for name in methods
        ]
    )
    dims = ("method", "direction")
    data = xr.Dataset(
        {
            "energy": (dims, found[:, 0], {"units": "J", "long_name": "energy at finite strain"}),
            "linear_energy": (dims, found[:, 1], {"units": "J", "long_name": "linear energy"}),
        },
        {"method": list(methods), "direction": list(directions)},
        {"walls": walls, "per_gap": per_gap},
    )
    data["ratio"] = data.energy / data.linear_energy
    data["ratio"].attrs = {"units": "1", "long_name": "energy at finite strain over linear"}
    return data


def _solid(
    ways: FloatArray, walls: str, per_gap: float, material: Material, steps: int
) -> FloatArray:
    """Energies of the whole specimen, finite and linear, shape (2, directions)."""
    from bondcell.solid.finite_strain import solve_finite_strain
    from bondcell.specimen.solid_half import (
        elastic_answer,
        half_specimen,
        materials,
        specimen_mesh,
        supports,
    )

    mesh = specimen_mesh(per_gap)
    system = (mesh, half_specimen(), *materials(material), supports(mesh, walls))
    loaded = np.array(given.LOADED)
    finite = [2 * solve_finite_strain(*system, loaded, way, steps).energy for way in ways]
    return np.array([finite, elastic_answer(mesh, material, walls, ways).energy])


def _lattice(name: str, ways: FloatArray, walls: str, material: Material, steps: int) -> FloatArray:
    """Energies of a lattice, finite and linear, shape (2, directions)."""
    own = specimen_lattice(name, material, walls)
    shape = (own.lattice.count, own.lattice.width)
    held = np.zeros(shape, dtype=bool)
    held[own.fixed] = True
    held[list(given.LOADED), :2] = True
    energies = []
    for way in ways:
        values = np.zeros(shape)
        values[list(given.LOADED), :2] = way
        large = solve_large(own.lattice, held, values, steps)
        energies.append([large.energy, own.solve(way).energy])
    return np.array(energies).T
