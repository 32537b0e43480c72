"""The paper's specimen: lattices of bonds against the three-dimensional solid."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import pairwise
from typing import Any

import numpy as np
import xarray as xr

from bondcell.cell import FloatArray
from bondcell.errors import InputError, Violation
from bondcell.lattice import specimen_geometry as given
from bondcell.lattice.solve import Solution
from bondcell.models import MODELS
from bondcell.specimen.bonds import Material
from bondcell.specimen.full_lattice import LayerEnergies, layer_energies
from bondcell.specimen.lattice_variants import VARIANTS, SpecimenLattice, specimen_lattice
from bondcell.specimen.names import LOADINGS, METHODS, SOLIDS, WALLS
from bondcell.status import Status, cf_flag_attributes
from bondcell.timing import ATTRIBUTES as TIMES
from bondcell.timing import Timing, timed, timed_once

Watch = Callable[[str, str, Any, Any], None]

MODES = ("normal", "shear", "bending", "torsion", "pocket", "ground")
"""Parts of a lattice's energy."""

CELL_SIZES = (1.0, 2.0)
"""Element sizes, relative to the gap, of the layer's cells; the second one gives an estimate."""

_DIMS = ("method", "loading", "walls")
_CHOICES = {"methods": METHODS, "loadings": tuple(LOADINGS), "walls": WALLS}
_ATTRIBUTES = {
    "energy": {"units": "J", "long_name": "strain energy"},
    "displacement": {"units": "m", "long_name": "displacement of the particle's centre"},
    "rotation": {"units": "rad", "long_name": "rotation of the particle"},
    "displacement_norm": {
        "units": "m",
        "long_name": "root of the sum of squared displacements of all particles",
    },
    "mode_energy": {"units": "J", "long_name": "strain energy by mode of deformation"},
    "error_estimate": {"units": "1", "long_name": "relative numerical error of the energy"},
    "status": cf_flag_attributes(),
    "dof": {"units": "1", "long_name": "degrees of freedom"},
    **TIMES,
    "seconds": {"units": "s", "long_name": "wall time of all loadings together, mesh excluded"},
    "level_energy": {"units": "J", "long_name": "strain energy on each mesh of the ladder"},
    "level_dof": {"units": "1", "long_name": "degrees of freedom of each mesh"},
    "level_seconds": {"units": "s", "long_name": "wall time on each mesh, mesh excluded"},
    "level_seconds_cpu": {"units": "s", "long_name": "processor time on each mesh, mesh excluded"},
    "limit_energy": {"units": "J", "long_name": "strain energy extrapolated over the meshes"},
    "limit_error": {"units": "1", "long_name": "relative uncertainty of that energy"},
}


def specimen(
    methods: Sequence[str] = METHODS,
    loadings: Sequence[str] = tuple(LOADINGS),
    walls: Sequence[str] = WALLS,
    per_gap: Sequence[float] = (1.0, 0.5),
    orders: Sequence[int] = (),
    material: Material | None = None,
    watch: Watch | None = None,
    repeats: int = 1,
) -> xr.Dataset:
    """Displace particles 1 to 3 of the specimen by 0.5 mm, in every asked way.

    Parameters
    ----------
    methods, loadings, walls
        Names in `METHODS`, `LOADINGS` and `WALLS`.
    per_gap
        Element sizes of the solid relative to the gap, falling: the ladder of its meshes.
    orders
        Orders of the displacements above the second, on the first of those meshes besides.
    material
        Elastic constants; default: the paper's.
    watch
        Called as ``watch(method, walls, mesh, answer)`` with each answer of the solid, and as
        ``watch(method, walls, lattice, solutions)`` with a lattice's solutions of all loadings.
    repeats
        Timed runs of each lattice; a solid is solved once.

    Returns
    -------
    xarray.Dataset
        On ``method``, ``loading``, ``walls``: ``energy``, ``displacement_norm``, ``error_estimate``
        (relative numerical error of the energy), ``status``, ``dof``, ``seconds`` (median
        of the runs), ``seconds_spread`` (NaN of a single run), ``seconds_cpu``; with
        ``particle`` (1 to 18) ``rotation``, with ``component`` as well ``displacement``; with
        ``mode`` ``mode_energy`` of the lattices. Of the solids also ``level_energy``,
        ``level_dof``, ``level_seconds`` on ``per_gap`` and ``order``, ``limit_energy`` and
        ``limit_error``; their answer is that of the level with the lowest energy. What was not
        computed is NaN and flagged.

    Raises
    ------
    InputError
        A name is unknown or a size out of range.

    Examples
    --------
    >>> out = specimen(methods=["lattice_paper"], walls=["free"])
    >>> out.energy.squeeze().round(5).values
    array([0.01449, 0.03154])
    """
    material = material or Material()
    _check({"methods": methods, "loadings": loadings, "walls": walls}, per_gap)
    data = _empty(methods, loadings, walls, per_gap, (2, *orders))
    ways = given.DISPLACEMENT * np.array([LOADINGS[name] for name in loadings])
    solids = [name for name in methods if name in SOLIDS]
    if solids:
        _add_solids(data, solids, ways, material, watch)
    # The pockets and borders of the full lattice come from cells of their own, solved once for all
    # walls.
    sizes = CELL_SIZES if "lattice_full" in methods else ()
    layers, of_cells = timed_once(lambda: [layer_energies(material, size) for size in sizes])
    for method in methods:
        if method in VARIANTS and VARIANTS[method][0] in (*MODELS, "paper"):
            for wall in walls:
                timing = _add_lattice(data, method, wall, ways, material, layers, repeats, watch)
                whole = timing.plus(of_cells) if method == "lattice_full" else timing
                _put_timing(data, {"method": method, "walls": wall}, whole)
    data["displacement_norm"] = np.sqrt(
        (data.displacement**2).sum(("particle", "component"), skipna=False)
    )
    for name, attributes in _ATTRIBUTES.items():
        if name in data:
            data[name].attrs.update(attributes)
    data.attrs["title"] = "Lattices of bonds against the three-dimensional solid"
    return data


def _check(chosen: dict[str, Sequence[str]], per_gap: Sequence[float]) -> None:
    violations = [
        Violation(field, name, f"one of {', '.join(_CHOICES[field])}")
        for field, names in chosen.items()
        for name in names
        if name not in _CHOICES[field]
    ]
    if not len(per_gap) or not all(0 < size <= 2 for size in per_gap):
        violations.append(Violation("per_gap", list(per_gap), "at least one size in (0, 2]"))
    elif any(later >= size for size, later in pairwise(per_gap)):
        violations.append(Violation("per_gap", list(per_gap), "falling sizes"))
    if violations:
        raise InputError(violations)


def _empty(
    methods: Sequence[str],
    loadings: Sequence[str],
    walls: Sequence[str],
    per_gap: Sequence[float],
    orders: Sequence[int],
) -> xr.Dataset:
    """The data with nothing computed yet."""
    coords: dict[str, Any] = {
        "method": list(methods),
        "loading": list(loadings),
        "walls": list(walls),
        "particle": np.arange(1, 19),
        "component": ["x", "y"],
        "mode": list(MODES),
        "per_gap": ("per_gap", list(per_gap), {"units": "1", "long_name": "element size per gap"}),
        "order": ("order", list(orders), {"units": "1", "long_name": "order of displacements"}),
    }
    sizes = {name: len(v[1]) if isinstance(v, tuple) else len(v) for name, v in coords.items()}
    more = {
        "energy": (), "error_estimate": (), "limit_energy": (), "limit_error": (),
        **dict.fromkeys(TIMES, ()),
        "rotation": ("particle",), "displacement": ("particle", "component"),
        "mode_energy": ("mode",), "level_energy": ("per_gap", "order"),
        "level_seconds": ("per_gap", "order"), "level_seconds_cpu": ("per_gap", "order"),
        "level_dof": ("per_gap", "order"),
    }  # fmt: skip
    data = xr.Dataset(coords=coords)
    for name, dims in more.items():
        shape = tuple(sizes[dim] for dim in (*_DIMS, *dims))
        data[name] = ((*_DIMS, *dims), np.full(shape, np.nan))
    shape = tuple(sizes[dim] for dim in _DIMS)
    data["status"] = (_DIMS, np.full(shape, Status.not_computed, dtype=np.int8))
    data["dof"] = (_DIMS, np.zeros(shape, dtype=np.int64))
    return data


def _add_solids(
    data: xr.Dataset,
    solids: Sequence[str],
    ways: FloatArray,
    material: Material,
    watch: Watch | None,
) -> None:
    from bondcell.specimen.solid_half import elastic_answer, rigid_answer, specimen_mesh

    solve = {"fe_rigid": rigid_answer, "fe_elastic": elastic_answer}
    sizes, orders = data.per_gap.values.tolist(), data.order.values.tolist()
    for size, order in [*((size, 2) for size in sizes), *((sizes[0], p) for p in orders[1:])]:
        mesh = specimen_mesh(size, order)
        for method in solids:
            for wall in data.walls.values.tolist():
                answer = solve[method](mesh, material, wall, ways)
                at = {"method": method, "walls": wall}
                lowest = np.fmin(data.energy.sel(at).values.mean(), np.inf)
                here = {**at, "per_gap": size, "order": order}
                data.level_energy.loc[here] = answer.energy
                data.level_dof.loc[here] = answer.dof
                data.level_seconds.loc[here] = answer.timing.seconds
                data.level_seconds_cpu.loc[here] = answer.timing.seconds_cpu
                if answer.energy.mean() >= lowest:
                    continue
                if watch:
                    watch(method, wall, mesh, answer)
                data.energy.loc[at] = answer.energy
                data.displacement.loc[at] = answer.motion[..., :2]
                data.rotation.loc[at] = answer.motion[..., 2]
                data.dof.loc[at] = answer.dof
                _put_timing(data, at, answer.timing)
                data.status.loc[at] = Status.ok
    for method in solids:
        _add_limits(data, method)


def _add_limits(data: xr.Dataset, method: str) -> None:
    """Extrapolate over sizes and over orders, and keep what is surer."""
    from bondcell.specimen.solid_half import extrapolate, extrapolate_orders

    levels = data.level_energy.sel({"method": method})
    by_size = levels.sel(order=2).transpose("per_gap", "loading", "walls").values
    by_order = levels.isel(per_gap=0).transpose("order", "loading", "walls").values
    limit, doubt = extrapolate(data.per_gap.values.tolist(), by_size)
    other, its_doubt = extrapolate_orders(by_order)
    surer = its_doubt < np.where(np.isnan(doubt), np.inf, doubt)
    limit, doubt = np.where(surer, other, limit), np.where(surer, its_doubt, doubt)
    data.limit_energy.loc[{"method": method}] = limit
    data.limit_error.loc[{"method": method}] = doubt
    energy = data.energy.sel({"method": method}).transpose("loading", "walls").values
    data.error_estimate.loc[{"method": method}] = np.abs(energy / limit - 1) + doubt


def _add_lattice(
    data: xr.Dataset,
    method: str,
    wall: str,
    ways: FloatArray,
    material: Material,
    layers: list[LayerEnergies],
    repeats: int,
    watch: Watch | None,
) -> Timing:
    """One lattice under all loadings, and what it took."""

    def solve() -> tuple[list[SpecimenLattice], list[list[Solution]]]:
        every = [
            specimen_lattice(method, material, wall, layer)
            for layer in (layers if method == "lattice_full" else [None])
        ]
        return every, [[own.solve(way) for way in ways] for own in every]

    (every, answers), timing = timed(solve, repeats) if repeats > 1 else timed_once(solve)
    if watch:
        watch(method, wall, every[0], answers[0])
    for loading, found in zip(data.loading.values.tolist(), answers[0], strict=True):
        at = {"method": method, "walls": wall, "loading": loading}
        data.energy.loc[at] = found.energy
        data.displacement.loc[at] = found.motion[:18, :2]
        if every[0].lattice.rotates:
            data.rotation.loc[at] = found.motion[:18, 2]
        for mode, energy in found.energies.items():
            data.mode_energy.loc[{**at, "mode": mode}] = energy
        data.dof.loc[at] = found.dof
        data.status.loc[at] = Status.ok
        data.error_estimate.loc[at] = 1e-12 if VARIANTS[method][0] != "fe" else 1e-6
    if len(answers) > 1:
        fine, coarse = (np.array([found.energy for found in own]) for own in answers)
        data.error_estimate.loc[{"method": method, "walls": wall}] = abs(coarse / fine - 1)
    return timing


def _put_timing(data: xr.Dataset, at: dict[str, str], timing: Timing) -> None:
    for name in TIMES:
        data[name].loc[at] = getattr(timing, name)
