"""What the page says on the specimen: sentences; its tables are in `specimen_lines`."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pandas as pd
import xarray as xr

from bondcell.report.findings import Finding
from bondcell.report.specimen_lines import specimen_lines
from bondcell.report.tables import Table
from bondcell.specimen.names import LATTICES, SOLIDS
from bondcell.specimen.paper import PAPER_RATIO, PRINTED, printed_stiffness
from bondcell.specimen.view import (
    NAMES,
    Results,
    error_table,
    first_walls,
    fullest,
    rows_of,
)
from bondcell.wording import listed, number, percent, quantity

AIM = 0.02
"""Error that the fullest lattice should stay below."""

FINITE = 0.03
"""Difference of finite strain from linear theory that the paper prints."""


def specimen_part(results: Results) -> tuple[list[Finding], list[Table]]:
    """Findings and tables of a specimen's results.

    Parameters
    ----------
    results
        See `bondcell.specimen.view.read_specimen`.
    """
    study, table = results[""], error_table(results)
    found = [
        *_energies(study, table),
        *_motions(table, study),
        *_walls(table, study),
        *_modes(study),
        *_printed(study),
        *_solid(table, study),
    ]
    if "relaxation" in results:
        found += _relaxation(results["relaxation"])
    if "finite_strain" in results:
        found += _finite_strain(results["finite_strain"])
    return found, specimen_lines(results, table)


def _of(table: pd.DataFrame, method: str, walls: str) -> pd.DataFrame:
    return table[(table["method"] == method) & (table["walls"] == walls)]


def _span(values: pd.Series, loadings: pd.Series, *, sign: bool = True) -> str:
    """Values of the loadings, in words."""
    return listed(
        f"{percent(value, sign=sign)} ({loading})"
        for value, loading in zip(values, loadings, strict=True)
    )


def _energies(study: xr.Dataset, table: pd.DataFrame) -> Iterator[Finding]:
    walls, method = first_walls(study), fullest(study)
    rows = _of(table, method, walls)
    if rows["energy_error"].isna().all():
        yield Finding("Without a solid there is nothing to compare the lattices with.")
        return
    doubt = float(study["reference_error"].sel(walls=walls).max())
    worst = rows["energy_error"].abs().max()
    if np.isnan(doubt):
        verdict = "one mesh does not say how far the solid itself is off"
    elif worst + doubt <= AIM:
        verdict = f"within {percent(AIM)}"
    elif worst - doubt > AIM:
        verdict = f"beyond {percent(AIM)}"
    else:
        verdict = (
            f"whether that is within {percent(AIM)}, these meshes cannot say: the solid's limit is "
            f"sure to {percent(doubt)} only"
        )
    text = (
        f"{walls.capitalize()} walls: the {NAMES[method]} has an energy of "
        f"{_span(rows['energy_error'], rows['loading'])} beside the solid's, with nothing fitted "
        f"to the specimen; {verdict}."
    )
    key = percent(worst) if np.isnan(doubt) else f"{percent(worst)} ± {percent(doubt)}"
    yield Finding(text, key, "energy of the full lattice beside the 3D solid", "lattice")
    normal = [
        (name, _of(table, name, walls))
        for name in rows_of(study, LATTICES)
        if name in ("lattice_paper", "lattice_fsi", "lattice_fe_normal")
    ]
    words = [f"{NAMES[name]} {_span(own['energy_error'], own['loading'])}" for name, own in normal]
    if words:
        yield Finding(f"Normal springs alone are too soft: {listed(words)}.")


def _motions(table: pd.DataFrame, study: xr.Dataset) -> Iterator[Finding]:
    walls, method = first_walls(study), fullest(study)
    rows = _of(table, method, walls).dropna(subset=["displacement_error"])
    if rows.empty:
        return
    moved = rows["displacement_error"].max()
    verdict = "within" if moved <= AIM else "beyond"
    text = (
        f"Its displacement vectors of the free particles are off by "
        f"{_span(rows['displacement_error'], rows['loading'], sign=False)}, {verdict} the aim of "
        f"{percent(AIM)}"
    )
    turned = rows.dropna(subset=["rotation_error"])
    if not turned.empty:
        text += (
            f", its rotations by {_span(turned['rotation_error'], turned['loading'], sign=False)}"
        )
    yield Finding(f"{text}.")
    if "norm_ratio" in study and "lattice_fe_normal" in rows_of(study, LATTICES):
        one = study.sel({"method": "lattice_fe_normal", "walls": walls})
        off = float(abs(one["norm_ratio"] - 1).max())
        energy = float(abs(one["energy_ratio"] - 1).max())
        if off < energy:
            yield Finding(
                "The displacement norm says little: the lattice of normal FE springs matches it to "
                f"{percent(off)} with an energy that is off by {percent(energy)}."
            )


def _walls(table: pd.DataFrame, study: xr.Dataset) -> Iterator[Finding]:
    method = fullest(study)
    if first_walls(study) != "free":
        return
    rows = _of(table, method, "fixed").dropna(subset=["energy_error"])
    if not rows.empty:
        worst = rows["energy_error"].abs().max()
        aim = "within" if worst <= AIM else "not within"
        yield Finding(
            f"Sides fixed: the {NAMES[method]} is off by "
            f"{_span(rows['energy_error'], rows['loading'])}, {aim} {percent(AIM)}; what "
            "a side does to the two particles next to it comes from a cell of the margin alone."
        )


def _modes(study: xr.Dataset) -> Iterator[Finding]:
    method, walls = fullest(study), first_walls(study)
    here = study.sel({"method": method, "walls": walls})
    share = here["mode_energy"] / here["energy"]
    words = [
        f"{loading}: "
        + listed(
            f"{percent(value)} {mode}"
            for mode, value in zip(
                study["mode"].values, share.sel(loading=loading).values, strict=True
            )
            if abs(value) > 1e-3
        )
        for loading in study["loading"].values
    ]
    axial = share.sel(mode="normal")
    low, high = float(axial.min()), float(axial.max())
    text = (
        f"Energy by mode in the {NAMES[method]}: {'; '.join(words)}. The paper says up to 95 % "
        f"axial; here it is {percent(low)}"
    )
    yield Finding(text + (f" to {percent(high)}." if high > low else "."))


def _printed(study: xr.Dataset) -> Iterator[Finding]:
    """Why the printed figures do not follow from the stated constants."""
    softest = study["softest"]
    for model, method in (("de", "lattice_paper"), ("fe", "fe_rigid")):
        if not rows_of(study, (method,)):
            continue
        least = float(softest.sel({"method": method}).min())
        pair = printed_stiffness(model)
        energy, norm = PRINTED[model]
        mesh = ""
        if model == "fe" and study["reference_error"].notnull().any():
            stiff = study["energy_ratio"].sel({"method": method}).max() - 1
            mesh = f" (on a mesh that is too stiff by {percent(stiff)})"
        if not np.isfinite(least) or pair >= least:
            continue
        yield Finding(
            f"The paper prints {quantity(1e3 * energy, '1')} mJ and a displacement norm of "
            f"{quantity(norm, 'm')} for its {'lattice' if model == 'de' else '3D solid'}: "
            f"2U/n² = {quantity(pair, 'N m-1')}. With a fixed bottom no loading whatever gives "
            f"less than the smallest eigenvalue, {quantity(least, 'N m-1')} for the "
            f"{NAMES[method]}{mesh}: {number(least / pair, 2)} times as much. The two figures "
            "cannot both follow from the constants that the paper states; nothing here is tuned to "
            "them.",
            f"{number(least / pair, 2)} times",
            "stiffer than the printed energy and norm allow",
            "printed",
        )
    if rows_of(study, ("lattice_paper",)) and "energy_ratio" in study:
        ratio = study["energy_ratio"].sel({"method": "lattice_paper", "walls": first_walls(study)})
        if ratio.notnull().any():
            words = [
                f"{percent(value)} ({loading})"
                for loading, value in zip(ratio["loading"].values, ratio.values, strict=True)
            ]
            yield Finding(
                f"The paper's lattice stores {listed(words)} of the solid's energy; the paper "
                f"prints {percent(PAPER_RATIO, 3)}."
            )


def _solid(table: pd.DataFrame, study: xr.Dataset) -> Iterator[Finding]:
    walls = first_walls(study)
    for method in rows_of(study, SOLIDS):
        rows = _of(table, method, walls)
        if rows.empty:
            continue
        best = rows.groupby(["per_gap", "order"])["energy"].sum().idxmin()
        finest = rows[(rows["per_gap"] == best[0]) & (rows["order"] == best[1])]
        yield Finding(
            f"The {NAMES[method]}, elements {best[0]:g} times the gap, displacements of order "
            f"{best[1]:g}: "
            f"{finest['dof'].iloc[0]} unknowns, {quantity(finest['seconds'].iloc[0], 's', 2)}, its "
            f"energy {_span(finest['energy_error'], finest['loading'])} beside the limit that the "
            "ladder gives."
        )
    both = [_of(table, name, walls).set_index(["loading", "per_gap", "order"]) for name in SOLIDS]
    if not (both[0].empty or both[1].empty):
        ratio = (both[0]["energy"] / both[1]["energy"] - 1).dropna()
        if not ratio.empty:
            yield Finding(
                f"Rigid particles store {percent(ratio.max())} more than elastic ones "
                "on the same mesh."
            )


def _relaxation(group: xr.Dataset) -> Iterator[Finding]:
    known = group.dropna("method", how="all", subset=["reaction"])
    left = known["reaction"].isel(time=-1) / known["reaction"].isel(time=0)
    at = quantity(float(known["time"][-1]), "s", 1)
    words = [
        f"{NAMES[str(name)]} {percent(left.sel({'method': name}).mean())}"
        for name in known["method"].values
    ]
    convention = str(group.attrs["convention"]).replace("_", " ")
    yield Finding(
        f"Relaxation ({convention}): after {at} there is left of the reaction, mean of the "
        f"loadings: {listed(words)}. The pockets have no part in it."
    )


def _signed(way: object) -> str:
    """A direction with a minus sign at which no line breaks."""
    return str(way).replace("-", "−")


def _finite_strain(group: xr.Dataset) -> Iterator[Finding]:
    known = group.dropna("method", how="all", subset=["ratio"])
    for method in known["method"].values:
        ratio = known["ratio"].sel({"method": method}) - 1
        if method not in ("fe_elastic", "lattice_fe_beam"):
            continue
        words = [
            f"{percent(value, sign=True)} ({_signed(way)})"
            for way, value in zip(ratio["direction"].values, ratio.values, strict=True)
        ]
        inside = [
            _signed(way)
            for way, value in zip(ratio["direction"].values, ratio.values, strict=True)
            if abs(value) <= FINITE
        ]
        rest = f"within {percent(FINITE)}, as the paper says, for {listed(inside)}"
        if len(inside) < ratio.size:
            rest += " only" if inside else ""
        yield Finding(
            f"Finite strain, {NAMES[str(method)]}: the energy is {listed(words)} beside the linear "
            f"one, {rest if inside else 'nowhere within the 3 % that the paper prints'}."
        )
