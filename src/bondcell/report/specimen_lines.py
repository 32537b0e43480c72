"""Tables of the specimen."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pandas as pd
import xarray as xr

from bondcell.report.tables import Table
from bondcell.specimen.names import LATTICES
from bondcell.specimen.paper import PAPER_NODES, PRINTED, printed_stiffness
from bondcell.specimen.view import NAMES, Results, first_walls, rows_of
from bondcell.wording import number, percent, quantity


def specimen_lines(results: Results, table: pd.DataFrame) -> list[Table]:
    """Errors of all methods, energy by mode, printed against computed.

    Parameters
    ----------
    results
        All groups.
    table
        See `bondcell.specimen.view.error_table`.
    """
    study = results[""]
    return [*_errors(study, table), _modes(study), _printed(study)]


def _errors(study: xr.Dataset, table: pd.DataFrame) -> Iterator[Table]:
    header = [
        "method",
        "h / gap",
        "order",
        "unknowns",
        "time",
        "energy",
        "energy error",
        "displacement error",
        "rotation error",
    ]
    for (loading, walls), rows in table.groupby(["loading", "walls"], sort=False):
        here = study.sel(loading=loading, walls=walls)
        best, doubt = float(here["reference_energy"]), float(here["reference_error"])
        caption = f"{loading} loading, {walls} walls."
        if np.isfinite(best):
            sure = f", sure to {percent(doubt)}" if np.isfinite(doubt) else ", from one mesh alone"
            caption += (
                f" Errors of the energy are to {_millijoule(best)}, the limit of the solid's "
                f"meshes{sure}; those of displacement and rotation to its best one. Time: "
                "with the finite elements of bonds and pockets, without the solid's mesh."
            )
        lines = [
            [
                NAMES[row.method],
                number(row.per_gap, 2),
                number(row.order),
                str(row.dof),
                quantity(row.seconds, "s", 2),
                _millijoule(row.energy),
                percent(row.energy_error, sign=True),
                *(
                    "reference" if error == 0 else percent(error)
                    for error in (row.displacement_error, row.rotation_error)
                ),
            ]
            for row in rows.itertuples()
        ]
        yield Table(caption[0].upper() + caption[1:], header, lines)


def _millijoule(energy: float) -> str:
    return f"{number(1e3 * energy)} mJ"


def _modes(study: xr.Dataset) -> Table:
    walls = first_walls(study)
    modes = [
        str(mode)
        for mode in study["mode"].values
        if float(np.abs(study["mode_energy"].sel(mode=mode, walls=walls)).max()) > 0
    ]
    lines = []
    for loading in study["loading"].values:
        for method in rows_of(study, LATTICES):
            one = study.sel({"method": method, "loading": loading, "walls": walls})
            shares = [percent(one["mode_energy"].sel(mode=m) / one["energy"]) for m in modes]
            lines.append([NAMES[method], str(loading), _millijoule(float(one["energy"])), *shares])
    caption = (
        f"Energy by mode of deformation, {walls} walls. The paper: up to 95 % axial. A pocket may "
        "give back what the bonds count too much, below zero."
    )
    return Table(caption, ["lattice", "loading", "energy", *modes], lines, names=2)


def _printed(study: xr.Dataset) -> Table:
    """The paper's figures beside those computed."""
    walls = first_walls(study)
    lines = []
    for method, model in (("lattice_paper", "de"), ("fe_rigid", "fe"), ("fe_elastic", "fe")):
        if not rows_of(study, (method,)):
            continue
        energy, norm = PRINTED[model]
        softest = float(study["softest"].sel({"method": method, "walls": walls}))
        for loading in study["loading"].values:
            one = study.sel({"method": method, "loading": loading, "walls": walls})
            own = 2 * float(one["energy"]) / float(one["displacement_norm"]) ** 2
            lines.append(
                [
                    NAMES[method],
                    str(loading),
                    _millijoule(energy),
                    _millijoule(float(one["energy"])),
                    quantity(norm, "m"),
                    quantity(float(one["displacement_norm"]), "m"),
                    quantity(printed_stiffness(model), "N m-1"),
                    quantity(own, "N m-1"),
                    quantity(softest, "N m-1") if np.isfinite(softest) else "–",
                ]
            )
    header = ["model", "loading", "U printed", "U here", "n printed", "n here"]
    header += ["2U/n² printed", "2U/n² here", "least possible"]
    caption = (
        "What the paper prints beside what its stated constants give: energy U, displacement norm "
        f"n of the particles' centres (its mesh has {PAPER_NODES} nodes). No loading of a specimen "
        "with a fixed bottom has 2U/n² below the smallest eigenvalue of its stiffness, the last "
        "column."
    )
    return Table(caption, header, lines, names=2)
