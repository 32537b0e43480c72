"""Two results of the same points: where they differ by more than their error estimates allow."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import xarray as xr

from bondcell.results.finite_axes import PREFIX

ESTIMATES = {
    "stiffness": "error_estimate",
    "coupling": "error_estimate",
    "relaxation": "series_error",
    "storage": "series_error",
    "loss": "series_error",
    "K_inf": "series_error",
    "energy": "error_estimate",
    "displacement_norm": "error_estimate",
}
"""Value -> its relative error estimate."""

ROUNDING = 1e-12
"""Relative difference that rounding may leave, of a value with an estimate too."""

WITHOUT_ESTIMATE = 1e-9
"""Relative difference allowed to a value without an estimate."""

ABOUT_THE_RUN = (
    "seconds", "dof", "elements", "order", "way", "level_", "series_terms", "series_seconds",
)  # fmt: skip
"""Begin of the names of what tells how a value was found: it may differ between machines."""

ABOUT_ERRORS = (
    "error", "bound", "sample_error", "reference_error", "reduction_error", "series_error",
    "model_error", "model_seconds", "fit_error", "correspondence_", "refinement", "limit_energy",
    "K_k", "tau_k",
)  # fmt: skip
"""Estimates, and splittings whose sum is compared elsewhere: terms of a curve."""


@dataclass(frozen=True)
class Difference:
    """What one variable of one group says.

    Parameters
    ----------
    group, variable
        Where.
    points
        Values that both files have.
    beyond
        How many of them differ by more than is allowed.
    largest
        Largest relative difference.
    allowed
        What was allowed there.
    where
        Position of the value that is farthest beyond (or nearest to) what is allowed.
    values
        The two values there.
    reason
        Why they cannot be compared, empty if they can.
    """

    group: str
    variable: str
    points: int
    beyond: int
    largest: float
    allowed: float
    where: dict[str, str | float]
    values: tuple[str | float, str | float]
    reason: str = ""

    @property
    def differs(self) -> bool:
        """Whether the files disagree here."""
        return bool(self.beyond or self.reason)


def compare_groups(
    first: dict[str, xr.Dataset], second: dict[str, xr.Dataset]
) -> Iterator[Difference]:
    """Compare two files group by group.

    Parameters
    ----------
    first, second
        Path of a group -> its content.

    Notes
    -----
    Two values ``a`` and ``b`` with relative error estimates ``e_a`` and ``e_b`` agree where
    ``|a - b| <= e_a |a| + e_b |b|`` and a little rounding. A value without an estimate may differ
    by `WITHOUT_ESTIMATE` of the largest of its variable; flags and text must be the same.
    """
    for name in [*first, *(name for name in second if name not in first)]:
        if name not in first or name not in second:
            missing = "first" if name not in first else "second"
            yield _apart(name, "", f"the {missing} file has no such group")
            continue
        yield from _compare(name, first[name], second[name])


def _compare(group: str, first: xr.Dataset, second: xr.Dataset) -> Iterator[Difference]:
    for name in [*first.variables, *(name for name in second.variables if name not in first)]:
        variable = str(name)
        if _is_aside(variable) or variable in first.dims or variable in second.dims:
            continue
        if variable not in first or variable not in second:
            missing = "first" if variable not in first else "second"
            yield _apart(group, variable, f"the {missing} file has no such variable")
            continue
        yield _of_variable(group, variable, first, second)
    for dim in first.dims:
        yield from _axis(group, str(dim), first, second)


def _is_aside(name: str) -> bool:
    if name in ESTIMATES.values() or name.startswith((PREFIX, *ABOUT_THE_RUN)):
        return True
    return name.startswith(ABOUT_ERRORS) and name not in ESTIMATES


def _axis(group: str, dim: str, first: xr.Dataset, second: xr.Dataset) -> Iterator[Difference]:
    """Positions that only one of the files has."""
    if dim not in first.indexes or dim not in second.indexes:
        return
    one, other = first.indexes[dim], second.indexes[dim]
    only = [len(one.difference(other)), len(other.difference(one))]
    if any(only):
        words = f"{only[0]} values in the first file only, {only[1]} in the second only"
        yield _apart(group, dim, words)


def _of_variable(group: str, name: str, first: xr.Dataset, second: xr.Dataset) -> Difference:
    a, b = first[name], second[name]
    if set(a.dims) != set(b.dims):
        return _apart(group, name, f"dimensions {a.dims} against {b.dims}")
    sizes = {str(d): (a.sizes[d], b.sizes[d]) for d in a.dims if d not in a.coords}
    if any(one != other for one, other in sizes.values()):
        return _apart(group, name, f"lengths {sizes}")
    if a.attrs.get("units") != b.attrs.get("units"):
        return _apart(group, name, f"units {a.attrs.get('units')} against {b.attrs.get('units')}")
    a, b = xr.align(a, b.transpose(*a.dims), join="inner", copy=False)
    if a.dtype.kind not in "iuf" or "flag_values" in a.attrs:
        return _exactly(group, name, a, b)
    estimate = ESTIMATES.get(name, "")
    allowed = xr.zeros_like(a, dtype=float) + WITHOUT_ESTIMATE * _scale(a, b)
    if estimate in first and estimate in second:
        shares = (first[estimate].fillna(0), second[estimate].fillna(0))
        allowed = abs(a) * (shares[0] + ROUNDING / 2) + abs(b) * (shares[1] + ROUNDING / 2)
    return _numbers(group, name, a, b, allowed.transpose(*a.dims))


def _scale(a: xr.DataArray, b: xr.DataArray) -> float:
    both = np.concatenate([np.abs(values.values.ravel()) for values in (a, b)])
    both = both[np.isfinite(both)]
    return float(both.max()) if both.size else 0.0


def _numbers(
    group: str, name: str, a: xr.DataArray, b: xr.DataArray, allowed: xr.DataArray
) -> Difference:
    one, other, bound = (np.asarray(v.values, dtype=float) for v in (a, b, allowed))
    with np.errstate(invalid="ignore"):
        distance = np.where(one == other, 0.0, np.abs(one - other))
    both_missing = np.isnan(one) & np.isnan(other)
    distance = np.where(both_missing, 0.0, np.where(np.isnan(distance), np.inf, distance))
    bound = np.where(np.isfinite(bound), bound, 0.0)
    beyond = distance > bound
    if not one.size:
        return Difference(group, name, 0, 0, 0.0, 0.0, {}, (0.0, 0.0))
    size = np.maximum(np.abs(one), np.abs(other))
    with np.errstate(divide="ignore", invalid="ignore"):
        relative = np.where(distance == 0, 0.0, distance / size)
        share = np.where(distance == 0, 0.0, distance / bound)
        relative_bound = bound / size
    relative = np.where(np.isnan(relative), np.inf, relative)
    share = np.where(np.isnan(share), np.inf, share)
    worst = np.unravel_index(int(np.argmax(share)), one.shape)
    return Difference(
        group,
        name,
        int((~both_missing).sum()),
        int(beyond.sum()),
        float(relative.max()),
        float(np.nan_to_num(relative_bound[worst])),
        _place(a, worst),
        (float(one[worst]), float(other[worst])),
    )


def _exactly(group: str, name: str, a: xr.DataArray, b: xr.DataArray) -> Difference:
    """Flags, counts and text."""
    unequal = a.values != b.values
    if not unequal.any():
        return Difference(group, name, a.size, 0, 0.0, 0.0, {}, ("", ""))
    worst = np.unravel_index(int(np.argmax(unequal)), a.shape)
    values = (_word(a, worst), _word(b, worst))
    count = int(unequal.sum())
    return Difference(group, name, a.size, count, np.inf, 0.0, _place(a, worst), values)


def _word(values: xr.DataArray, place: tuple[np.intp, ...]) -> str:
    value = values.values[place]
    words = str(values.attrs.get("flag_meanings", "")).split()
    codes = np.atleast_1d(values.attrs.get("flag_values", [])).tolist()
    return words[codes.index(value)] if value in codes else str(value)


def _place(values: xr.DataArray, place: tuple[np.intp, ...]) -> dict[str, str | float]:
    found: dict[str, str | float] = {}
    for dim, position in zip(values.dims, place, strict=True):
        known = dim in values.coords
        found[str(dim)] = values[dim].values.tolist()[position] if known else int(position)
    return found


def _apart(group: str, name: str, reason: str) -> Difference:
    return Difference(group, name, 0, 0, np.inf, 0.0, {}, ("", ""), reason)
