"""Results of relaxation put on their dimensions: model, convention, series, point, time."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr

from bondcell.outputs import FREQUENCY, TIME
from bondcell.results.relaxation_names import TERM_VARIABLES, VARIABLES, attributes
from bondcell.scenes.prony_block import PronyBlock
from bondcell.scenes.series_cases import SeriesCase


def laid_out(
    found: list[list[dict[str, Any]]],
    block: PronyBlock,
    cases: list[SeriesCase],
    labels: list[str],
    load: str,
) -> xr.Dataset:
    """Values of all series as one dataset.

    Parameters
    ----------
    found
        Variable -> values, models first; by convention and series.
    block, cases
        Conventions, times and frequencies, and the series.
    labels
        The models' rows.
    load
        Load name.
    """
    width = max(v.shape[-1] for rows in found for row in rows for v in row["K_k"])
    variables: dict[str, Any] = {}
    for name, dims in VARIABLES.items():
        if name not in found[0][0]:
            continue
        wide = width if name in TERM_VARIABLES else 0
        values = np.array([[_padded(row[name], wide) for row in rows] for rows in found])
        if "model" in dims:
            values = np.moveaxis(values, 2, 0)
        elif "convention" not in dims:
            values = values[0]
        variables[name] = (dims, values, attributes(name, load))
    coords = {"model": labels, **series_coordinates(block, cases)}
    return xr.Dataset(variables, coords)


def _padded(values: Any, width: int) -> Any:
    """Models on one array, terms padded with NaN to a width."""
    if not width:
        return np.array(values)
    return np.array(
        [np.pad(v, ((0, 0), (0, width - v.shape[-1])), constant_values=np.nan) for v in values]
    )


def series_coordinates(block: PronyBlock, cases: list[SeriesCase]) -> dict[str, Any]:
    """Coordinates of the dimensions convention, series, time and frequency."""
    temperature = [np.nan if case.temperature is None else case.temperature for case in cases]
    of_series = {
        "series_kind": [case.kind for case in cases],
        "series_profile": [case.profile for case in cases],
        "series_decades": [case.decades for case in cases],
        "series_relaxing": [case.relaxing_share for case in cases],
        "series_size": [len(case.times) for case in cases],
        "temperature": temperature,
    }
    about = {
        "series_kind": {"long_name": "what the series is: kind of material, inline or generated"},
        "series_profile": {"long_name": "weights of a generated series over its times"},
        "series_decades": {"units": "1", "long_name": "decades from smallest to largest time"},
        "series_relaxing": {
            "units": "1",
            "long_name": "share of the modulus that relaxes",
        },
        "series_size": {"units": "1", "long_name": "terms of the matrix"},
        "temperature": {"units": "K", "long_name": "temperature"},
    }
    labels = {"long_name": "Prony series of the matrix"}
    return {
        "convention": ("convention", list(block.conventions), {"long_name": "what relaxes"}),
        "series": ("series", [case.name for case in cases], labels),
        "time": ("time", np.concatenate(([0.0], block.times.values())), TIME),
        "frequency": ("frequency", np.asarray(block.dynamic_frequencies), FREQUENCY),
        **{name: ("series", values, about[name]) for name, values in of_series.items()},
    }
