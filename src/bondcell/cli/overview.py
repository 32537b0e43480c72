"""What ``bondcell show`` prints of a file: dimensions, ranges, flags, worst points."""

from __future__ import annotations

from typing import TYPE_CHECKING

from bondcell.errors import DataError, Violation

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr


FEW = 4
"""Names of an axis that are listed."""

WORST = 3
"""Points of a reference that are listed."""


def print_overview(path: str) -> None:
    """Print the dimensions, ranges, flags and worst errors of a file.

    Parameters
    ----------
    path
        A file of results.

    Raises
    ------
    DataError
        It is missing, damaged or of another make.
    """
    from bondcell.results.load_groups import read_loads

    study, *others = read_loads(path).values()
    if "softest" in study:
        print(_specimen(study, path))
        return
    ladders = _convergence(path)
    _check_content(study, ladders, path)
    print(_overview(study, path))
    for other in others:
        print(f"\n{_results(other)}")
    if ladders is not None:
        print(f"\nconvergence study, errors against the finest level\n{_ladders(ladders)}")


def _specimen(study: xr.Dataset, path: str) -> str:
    """Every method of a specimen beside the best known energy."""
    from bondcell.specimen.view import error_table, read_specimen

    table = error_table(read_specimen(path))
    return f"{_heading(study, path)}\n\n{table.to_string(index=False, na_rep='-')}"


def _check_content(study: xr.Dataset, ladders: xr.Dataset | None, path: str) -> None:
    from bondcell.results.view import model_names

    stiffness = study.get("stiffness")
    numeric = stiffness is None or stiffness.dtype.kind in "iuf"
    if not numeric or not (model_names(study) or ladders is not None):
        allowed = "a result of this package: stiffness(model, axes...), or a group convergence"
        raise DataError([Violation("file", path, allowed)], path)


def _overview(study: xr.Dataset, path: str) -> str:
    blocks = [_heading(study, path), _axes(study)]
    if "stiffness" in study and "model" in study["stiffness"].dims:
        blocks.append(_results(study))
    return "\n\n".join(block for block in blocks if block)


def _results(study: xr.Dataset) -> str:
    """Values and errors of the models under one load."""
    from bondcell.results.accuracy import accuracy_table
    from bondcell.results.view import load_name

    blocks = [f"load {load_name(study)}\n{_models(study)}"]
    table = accuracy_table(study)
    if not table.empty:
        blocks.append(_errors(study, table))
    blocks.append(_worst(study))
    if "relaxation" in study:
        blocks.append(_relaxation(study))
    return "\n\n".join(block for block in blocks if block)


def _heading(study: xr.Dataset, path: str) -> str:
    known = ("source", "source_revision", "machine")
    lines = [f"{path}: {study.attrs.get('title', 'untitled')}"]
    lines += [f"  {name}: {study.attrs[name]}" for name in known if name in study.attrs]
    return "\n".join(lines)


def _axes(study: xr.Dataset) -> str:
    """Every dimension, then every input that does not vary."""
    from bondcell.cell import UNITS
    from bondcell.cli.text_table import text_table
    from bondcell.results.view import SAMPLE, axis_unit, axis_values, is_scattered, parameters
    from bondcell.wording import meaning, quantity

    rows = []
    for name, size in study.sizes.items():
        if name == "model":
            continue
        if name == SAMPLE:
            rows.append([name, f"{size} points", "", "points that are no grid"])
            continue
        words = str(study[name].attrs.get("long_name", "")) if name in study.coords else ""
        known = meaning(str(name))
        about = words if known == name else known
        rows.append([str(name), f"{size} values", _span(study, str(name)), about])
    for name in parameters(study) if is_scattered(study) else ():
        if name not in study.sizes:
            values, unit = axis_values(study, name), axis_unit(study, name)
            span = f"{quantity(values.min(), unit)} to {quantity(values.max(), unit)}"
            rows.append([name, "along sample", span, meaning(name)])
    for name, unit in UNITS.items():
        if name in study and not study[name].dims:
            rows.append([name, "fixed", quantity(study[name].item(), unit), meaning(name)])
    return text_table(rows, ["input", "", "range", "meaning"])


def _span(study: xr.Dataset, axis: str) -> str:
    """The ends of an axis, or the first of its names."""
    from bondcell.results.view import axis_unit, axis_values
    from bondcell.wording import quantity

    values = axis_values(study, axis)
    if axis not in study.coords:
        return ""
    if values.dtype.kind not in "iuf":
        more = f" and {len(values) - FEW} more" if len(values) > FEW else ""
        return ", ".join(str(value) for value in values[:FEW]) + more
    unit = axis_unit(study, axis)
    ends = dict.fromkeys(quantity(end, unit) for end in (values.min(), values.max()))
    return " to ".join(ends)


def _worst(study: xr.Dataset) -> str:
    """The points with flags of failures, and with the largest estimates."""
    import numpy as np

    from bondcell.cli.text_table import text_table
    from bondcell.results.view import reference_names, stiffness_unit
    from bondcell.wording import number, quantity

    rows = []
    for name in reference_names(study) if {"status", "error_estimate"} <= set(study) else []:
        here = study.sel(model=name)
        estimate = here["error_estimate"].values
        # What has no value comes before what has a large estimate.
        rank = np.where(np.isnan(estimate), np.inf, estimate).ravel()
        for position in np.argsort(-rank, kind="stable")[:WORST]:
            place = dict(
                zip(here["status"].dims, np.unravel_index(position, estimate.shape), strict=True)
            )
            point = here.isel(place)
            where = ", ".join(_at(study, str(axis), int(k)) for axis, k in place.items())
            value = float(point["stiffness"])
            shown = quantity(value, stiffness_unit(study)) if np.isfinite(value) else "no value"
            told = float(point["error_estimate"])
            rows.append([name, where or "-", shown, number(told, 2), _flag(point["status"])])
    if not rows:
        return ""
    header = ["worst points of", "at", "stiffness", "error estimate", "flag"]
    return text_table(rows, header)


def _at(study: xr.Dataset, axis: str, position: int) -> str:
    from bondcell.results.view import axis_unit, axis_values
    from bondcell.wording import at

    return at(axis, axis_values(study, axis)[position], axis_unit(study, axis))


def _flag(status: xr.DataArray) -> str:
    from bondcell.status import Status

    names = {flag.value: flag.name for flag in Status}
    return names.get(int(status), f"flag {int(status)}")


def _relaxation(study: xr.Dataset) -> str:
    """Series of each model: what is left at the end, errors and flags."""
    import numpy as np

    from bondcell.cli.text_table import text_table
    from bondcell.results.view import model_names
    from bondcell.wording import percent

    rows = []
    for name in model_names(study):
        here = study.sel(model=name)
        with np.errstate(invalid="ignore", divide="ignore"):
            left = (here["relaxation"].isel(time=-1) / here["relaxation"].isel(time=0)).values
        left = left[np.isfinite(left)]
        span = "no value"
        if left.size:
            span = " to ".join(dict.fromkeys(percent(end) for end in (left.min(), left.max())))
        flags = here[["stiffness"]].assign(status=here["series_status"])
        rows.append([name, span, _flags(flags), _largest(here, "series_error", "{:.1e}")])
    header = ["relaxation of", "left at the end", "series by flag", "largest error estimate"]
    return text_table(rows, header)


def _models(study: xr.Dataset) -> str:
    from bondcell.cli.text_table import text_table
    from bondcell.results.view import model_names, stiffness_unit
    from bondcell.wording import quantity

    unit = stiffness_unit(study)
    rows = []
    for name in model_names(study):
        here = study.sel(model=name)
        values = here["stiffness"].values[~here["stiffness"].isnull().values]
        span = "no value"
        if values.size:
            span = quantity(values.min(), unit)
            span += f" to {quantity(values.max(), unit)}" if values.size > 1 else ""
        estimate = _largest(here, "error_estimate", "{:.1e}")
        seconds = quantity(here["seconds"].median().item(), "s", 3) if "seconds" in here else "-"
        rows.append([str(name), span, _flags(here), estimate, seconds])
    header = ["model", "stiffness", "points by flag", "largest error estimate", "median time"]
    return text_table(rows, header)


def _flags(here: xr.Dataset) -> str:
    import numpy as np

    from bondcell.status import Status

    if "status" not in here:
        return f"{here['stiffness'].size} points"
    codes, counts = np.unique(here["status"].values, return_counts=True)
    names = {flag.value: flag.name for flag in Status}
    return ", ".join(
        f"{names.get(int(code), f'flag {int(code)}')} {count}"
        for code, count in zip(codes, counts, strict=True)
    )


def _largest(here: xr.Dataset, name: str, form: str) -> str:
    value = float(here[name].max()) if name in here else float("nan")
    return "-" if value != value else form.format(value)


def _errors(study: xr.Dataset, table: pd.DataFrame) -> str:
    from bondcell.cli.text_table import text_table
    from bondcell.results.view import axis_unit, parameters
    from bondcell.wording import at, percent

    axes = parameters(study)
    rows = []
    for _, row in table[table["group_axis"] == "all"].iterrows():
        where = ", ".join(at(axis, row[f"at_{axis}"], axis_unit(study, axis)) for axis in axes)
        rows.append(
            [
                row["model"],
                row["reference"],
                percent(row["abs_error_max"]),
                percent(row["abs_error_median"]),
                where if row["points"] else "-",
                str(row["points"]),
                row["left_out_by"] or "-",
            ]
        )
    header = ["model", "against", "max |error|", "median", "worst at", "points", "left out"]
    return text_table(rows, header)


def _ladders(convergence: xr.Dataset) -> str:
    """Coarsest and finest error of each discretisation, and the error of each analytic model."""
    from bondcell.cli.text_table import text_table
    from bondcell.results.convergence import convergence_table
    from bondcell.wording import number, quantity

    rows = []
    table = convergence_table(convergence)
    for (case, method), levels in table.groupby(["case", "method"], sort=False):
        known = levels[levels["error"].notna()]
        if known.empty:
            continue
        last = known.iloc[-1]
        errors = dict.fromkeys(number(error, 2) for error in known["error"].iloc[[0, -1]])
        unknowns = str(last["dof"]).replace("<NA>", "-")
        time = quantity(last["seconds"], "s", 2)
        rows.append([str(case), str(method), f"{len(levels)}", " to ".join(errors), unknowns, time])
    return text_table(rows, ["case", "method", "levels", "error", "unknowns", "time"])


def _convergence(path: str) -> xr.Dataset | None:
    from bondcell.storage import read_dataset

    try:
        return read_dataset(path, group="convergence")
    except DataError as error:
        if error.violations[0].field == "group":
            return None
        raise
