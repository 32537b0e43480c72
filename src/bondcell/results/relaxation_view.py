"""What of a relaxation result is shown: some series, one point of the sweep."""

from __future__ import annotations

import numpy as np
import xarray as xr

from bondcell.results.relaxation_tables import relaxation_axes
from bondcell.results.view import axis_unit, axis_values
from bondcell.wording import at, listed

PANELS = 3
"""Most series that are shown beside each other."""


def shown_series(study: xr.Dataset) -> list[str]:
    """Names of the series to show: materials and given terms, else generated ones."""
    names = [str(name) for name in study["series"].values]
    generated = study["series_kind"].values == "generated"
    own = [name for name, made in zip(names, generated, strict=True) if not made]
    pool = own or names
    chosen = np.unique(np.linspace(0, len(pool) - 1, min(len(pool), PANELS)).round().astype(int))
    return [pool[i] for i in chosen]


def middle_point(study: xr.Dataset) -> dict[str, int]:
    """Position of the point to show: the middle of every axis."""
    return {axis: study.sizes[axis] // 2 for axis in relaxation_axes(study)}


def point_words(study: xr.Dataset, index: dict[str, int]) -> str:
    """A point of the sweep in words, empty without axes."""
    words = [
        at(axis, axis_values(study, axis)[position], axis_unit(study, axis))
        for axis, position in index.items()
    ]
    return listed(words) if words else ""


def convention_words(name: str) -> str:
    """A convention within a sentence.

    Examples
    --------
    >>> convention_words("constant_bulk")
    'constant bulk modulus'
    """
    known = {
        "constant_bulk": "constant bulk modulus",
        "constant_poisson": "constant Poisson's ratio",
    }
    return known.get(name, name.replace("_", " "))


def series_words(name: str) -> str:
    """A series in titles: names as words, generated ones spelt out.

    Examples
    --------
    >>> series_words("sbs_ac13"), series_words("n16_d8_r0.99")
    ('SBS-AC13', '16 terms over 8 decades, 99 % relaxes')
    """
    parts = name.split("_")
    if len(parts) >= 3 and [part[:1] for part in parts[:3]] == ["n", "d", "r"]:
        try:
            terms, decades, share = (float(part[1:]) for part in parts[:3])
        except ValueError:
            return name.replace("_", " ")
        tail = f", {parts[3]}" if len(parts) > 3 else ""
        noun = "term" if terms == 1 else "terms"
        over = "" if terms == 1 else f" over {decades:g} decades"
        return f"{terms:g} {noun}{over}, {100 * share:.6g} % relaxes{tail}"
    has_digit = any(letter.isdigit() for letter in name)
    return name.upper().replace("_", "-") if has_digit else name.replace("_", " ")
