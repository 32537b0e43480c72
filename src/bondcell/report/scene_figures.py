"""Which interactive figures a scene has, and the static ones that they make needless."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import pandas as pd
import xarray as xr

from bondcell.report.interactive.cost_chart import cost_chart
from bondcell.report.interactive.cost_points import (
    ladder_points,
    method_points,
    specimen_points,
)
from bondcell.report.interactive.figure import InteractiveFigure
from bondcell.report.interactive.relaxation_explorer import relaxation_explorer
from bondcell.report.interactive.sweep_explorer import sweep_explorer

TIME, UNKNOWNS = "wall time [s]", "unknowns"

Figures = Iterator[InteractiveFigure | None]


def sweep_figures(name: str, loads: Mapping[str, xr.Dataset]) -> Figures:
    """Curves of a sweep under all its loads."""
    replaces = ["stiffness", *(f"stiffness_{load}" for load in loads)]
    yield sweep_explorer(loads, f"{name}_explorer", replaces)


def atlas_figures(name: str, loads: Mapping[str, xr.Dataset]) -> Figures:
    """Curves of an atlas; its errors against run time are drawn beside the ladders."""
    yield sweep_explorer(loads, f"{name}_explorer", ["error_against_time"])


def ladder_figures(name: str, ladders: xr.Dataset) -> Figures:
    """Ladders of discretisations."""
    yield cost_chart(
        ladder_points(ladders),
        f"{name}_ladders",
        "Case",
        "Error of every discretisation against the finest structured level, and of the models, "
        "case by case. A step of a ladder is a marker; its observed order is in the tooltip and in "
        "the table.",
        against={"seconds": TIME, "dof": UNKNOWNS},
        replaces=("convergence_time", "convergence_dof"),
    )


def relaxing_figures(name: str, study: xr.Dataset, methods: pd.DataFrame) -> Figures:
    """Relaxation over time, and the ways to it."""
    yield relaxation_explorer(study, f"{name}_explorer", ["relaxation", "error_over_time"])
    if not methods.empty:
        yield cost_chart(
            method_points(methods),
            f"{name}_methods",
            "Series",
            "Error of K(t) against run time of every way to it by finite elements, set-up "
            "included.",
            against={"seconds": TIME},
            replaces=("relaxation_methods",),
        )


def specimen_figures(name: str, table: pd.DataFrame) -> Figures:
    """Error of the energy against run time."""
    yield cost_chart(
        specimen_points(table),
        f"{name}_cost",
        "Loading",
        "Error of the specimen's energy against run time: lattices of bonds beside solids of "
        "several element sizes. The solid's error is that to the limit of its own meshes.",
        against={"seconds": TIME, "dof": UNKNOWNS},
        replaces=("error_against_time",),
    )
