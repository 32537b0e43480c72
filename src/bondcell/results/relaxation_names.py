"""Variables of relaxation in a result: names, dimensions, units. Nothing of it computes."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import xarray as xr

from bondcell.outputs import STIFFNESS_UNITS
from bondcell.status import cf_flag_attributes

_SERIES = ("model", "convention", "series", "point")

VARIABLES: dict[str, tuple[str, ...]] = {
    "relaxation": (*_SERIES, "time"),
    "relaxation_status": (*_SERIES, "time"),
    "storage": (*_SERIES, "frequency"),
    "loss": (*_SERIES, "frequency"),
    "K_inf": _SERIES,
    "K_k": (*_SERIES, "term"),
    "tau_k": (*_SERIES, "term"),
    "series_terms": _SERIES,
    "series_error": _SERIES,
    "series_status": _SERIES,
    "series_seconds": _SERIES,
    "correspondence_error": _SERIES,
    "correspondence_allowed": _SERIES,
    "shear_share": ("series", "time"),
    "poisson_t": ("convention", "series", "point", "time"),
}
"""Name -> dimensions; in a scene's file the swept axes take the place of ``point``."""

METHODS = "relaxation_methods"
"""Group of the comparison of methods in time in a scene's file."""

TERM_VARIABLES = ("K_k", "tau_k")

_ONE = {"units": "1"}


def with_equal_terms(parts: Sequence[xr.Dataset]) -> list[xr.Dataset]:
    """The same datasets with as many terms in each, padded with NaN."""
    width = max(part.sizes["term"] for part in parts)
    return [
        part.pad(term=(0, width - part.sizes["term"])) if part.sizes["term"] < width else part
        for part in parts
    ]


def attributes(name: str, load: str) -> dict[str, Any]:
    """CF attributes of a variable under a load."""
    stiffness = {"units": STIFFNESS_UNITS[load]}
    found: dict[str, dict[str, Any]] = {
        "relaxation": {
            **stiffness,
            "long_name": f"{load} stiffness of the bond after a step",
            "ancillary_variables": "relaxation_status series_error",
        },
        "relaxation_status": cf_flag_attributes() | {"long_name": "outcome at each time"},
        "storage": {**stiffness, "long_name": f"{load} storage stiffness of the bond"},
        "loss": {**stiffness, "long_name": f"{load} loss stiffness of the bond"},
        "K_inf": {**stiffness, "long_name": "stiffness that never relaxes"},
        "K_k": {**stiffness, "long_name": "stiffness of the term of the bond at t = 0"},
        "tau_k": {"units": "s", "long_name": "relaxation time of the term of the bond"},
        "series_terms": _ONE | {"long_name": "terms of the bond"},
        "series_error": _ONE | {"long_name": "relative numerical error of K at any time"},
        "series_status": cf_flag_attributes() | {"long_name": "outcome over all times"},
        "series_seconds": {"units": "s", "long_name": "wall time of the series"},
        "correspondence_error": _ONE
        | {"long_name": "largest relative difference from the elastic stiffness at real s"},
        "correspondence_allowed": _ONE
        | {"long_name": "what the error estimates of both sides of that difference allow"},
        "shear_share": _ONE | {"long_name": "shear modulus of the matrix over that at t = 0"},
        "poisson_t": _ONE | {"long_name": "Poisson's ratio of the matrix as it relaxes"},
    }
    return found[name]
