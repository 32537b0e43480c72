"""What a sweep shows besides the models' errors: particles, reference, losses, cost."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pandas as pd
import xarray as xr

from bondcell.report.findings import Finding
from bondcell.report.model_findings import (
    POISSON,
    lower_bound,
    outside_range,
    ranking,
    series_model,
)
from bondcell.results.particle_influence import PAPER_RATIO, RATIO_AXIS, particles_negligible_from
from bondcell.results.view import analytic_names, model_names, reference_names, swept_axes
from bondcell.status import Status
from bondcell.wording import at, listed, model_name, number, percent, quantity, symbol

FEWEST_TIMED = 10
"""Points below which nothing is said on the time of one."""


def sweep_findings(study: xr.Dataset, table: pd.DataFrame) -> list[Finding]:
    """What a sweep shows, most important first.

    Parameters
    ----------
    study
        A sweep's result.
    table
        Its accuracy table.
    """
    if not model_names(study):
        return []
    found: list[Finding] = []
    if not table.empty:
        found += series_model(study, table)
    found += particles(study)
    if not table.empty:
        found += ranking(study, table)
        found += outside_range(table)
        found += lower_bound(table)
        found += reference_quality(study, table)
    return [*found, *without_value(study), *speed(study)]


def particles(study: xr.Dataset) -> Iterator[Finding]:
    """From which modulus ratio on the particles do not matter, against what the paper says."""
    table = particles_negligible_from(study)
    known = table[table["ratio_from"].notna()]
    if known.empty:
        return
    parts, starts, shortfalls = [], [], []
    for method, rows in known.groupby("method", sort=False):
        against = "the stiffness k_int of its interface" if method == "fsi" else "rigid particles"
        name = "FSI" if method == "fsi" else model_name(str(method))
        spans = _spans(rows)
        parts.append(f"by {name} from E_i/E_m = {spans} on (against {against})")
        starts.append(f"E_i/E_m = {spans} by {name}")
        gap = rows["deviation_at_paper_ratio"].dropna()
        if not gap.empty:
            low, high = percent(gap.min()), percent(gap.max())
            shortfalls.append(f"{low if low == high else f'{low} to {high}'} ({name})")
    text = f"The particles no longer matter, within 1 % of K_n, {listed(parts)}."
    lowest = known["ratio_from"].min()
    if shortfalls and lowest > PAPER_RATIO:
        text += (
            f" The paper puts this at {number(PAPER_RATIO)}; there K_n is still "
            f"{listed(shortfalls)} below that limit."
        )
    if len(known) < len(table):
        text += (
            f" The sweep shows it at {len(known)} of {len(table)} combinations of a method and the "
            f"other axes; at the rest its ratios end too early or lie too far apart."
        )
        yield Finding(text)
        return
    key = f"{symbol(RATIO_AXIS)} ≥ {_range(known['ratio_from'])}"
    brief = f"The particles matter, by more than 1 % of K_n, up to {listed(starts)}"
    brief += f"; the paper puts this at {number(PAPER_RATIO)}." if lowest > PAPER_RATIO else "."
    yield Finding(text, key, "particles no longer matter", "particles", brief)


def _spans(rows: pd.DataFrame) -> str:
    """Ratios by Poisson's ratio where it is an axis, as a range over all other axes."""
    if POISSON not in rows or _same(rows["ratio_from"]):
        return _range(rows["ratio_from"])
    return listed(
        f"{_range(group['ratio_from'])} ({at(POISSON, value)})"
        for value, group in rows.groupby(POISSON)
    )


def _range(values: pd.Series) -> str:
    low, high = number(values.min(), 2), number(values.max(), 2)
    return low if _same(values) or low == high else f"{low} to {high}"


def _same(values: pd.Series) -> bool:
    return bool(values.max() <= 1.005 * values.min())


def reference_quality(study: xr.Dataset, table: pd.DataFrame) -> Iterator[Finding]:
    """How sure the reference is of itself."""
    for name in reference_names(study):
        rows = table[(table["reference"] == name) & (table["group_axis"] == "all")]
        error = rows["reference_error"].max()
        if np.isnan(error):
            continue
        text = f"The values of {model_name(name)} are sure to {number(error, 2)} (relative, the "
        text += "largest estimate over all points)"
        least = rows["abs_error_median"].min()
        text += ", far finer than the differences above." if error < least / 100 else "."
        missed = 0
        if "status" in study:
            missed = int((study["status"].sel(model=name) == Status.tolerance_not_met).sum())
        if missed:
            text += f" At {missed} points they miss the tolerance that was asked for."
        yield Finding(text)


def without_value(study: xr.Dataset) -> Iterator[Finding]:
    """Points without a value, by model and flag."""
    if "status" not in study:
        return
    losses = []
    for name in model_names(study):
        codes, counts = np.unique(study["status"].sel(model=name).values, return_counts=True)
        bad = [
            f"{count} ({Status(int(code)).name.replace('_', ' ')})"
            for code, count in zip(codes, counts, strict=True)
            if not Status(int(code)).has_value
        ]
        if bad:
            losses.append(f"{model_name(name)} at {listed(bad)}")
    total = int(np.prod(list(swept_axes(study).values())))
    if losses:
        yield Finding(f"Without a value, of {total} points: {listed(losses)}.")


def speed(study: xr.Dataset) -> Iterator[Finding]:
    """What a point costs."""
    if "seconds" not in study or study["stiffness"].sizes.get("model", 0) == 0:
        return
    if np.prod(list(swept_axes(study).values())) < FEWEST_TIMED:
        return  # the time of a lone point is mostly overhead
    seconds = study["seconds"].transpose("model", ...)
    cost = {
        str(name): float(np.nanmedian(seconds.sel(model=name).values))
        for name in model_names(study)
        if np.isfinite(seconds.sel(model=name).values).any()
    }
    analytic = [cost[name] for name in analytic_names(study) if name in cost]
    reference = [cost[name] for name in reference_names(study) if name in cost]
    parts = []
    if analytic:
        low, high = quantity(min(analytic), "s", 2), quantity(max(analytic), "s", 2)
        parts.append(f"an analytic model {low if low == high else f'{low} to {high}'}")
    if reference:
        parts.append(f"finite elements {quantity(max(reference), 's', 2)}")
    if parts:
        yield Finding(f"A point costs {listed(parts)} (median wall time on the machine below).")
