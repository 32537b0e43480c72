"""What ``bondcell show`` prints of a file: dimensions, ranges, flags, worst points."""

from __future__ import annotations

from typing import TYPE_CHECKING

from bondcell.errors import DataError, Violation

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr


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
    return "\n\n".join(blocks)


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
        values, unit = axis_values(study, name), axis_unit(study, str(name))
        span = quantity(values.min(), unit)
        span += f" to {quantity(values.max(), unit)}" if size > 1 else ""
        rows.append([str(name), f"{size} values", span, meaning(str(name))])
    for name in parameters(study) if is_scattered(study) else ():
        if name not in study.sizes:
            values, unit = axis_values(study, name), axis_unit(study, name)
            span = f"{quantity(values.min(), unit)} to {quantity(values.max(), unit)}"
            rows.append([name, "along sample", span, meaning(name)])
    for name, unit in UNITS.items():
        if name in study and not study[name].dims:
            rows.append([name, "fixed", quantity(study[name].item(), unit), meaning(name)])
    return text_table(rows, ["input", "", "range", "meaning"])


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
