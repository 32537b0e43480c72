"""From which modulus ratio on the particles behave as rigid ones."""

from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd
import xarray as xr
from numpy.typing import NDArray

from bondcell.results.view import axis_values, is_scattered, reference_names, swept_axes

RATIO_AXIS = "modulus_ratio"

PAPER_RATIO = 12.0
"""E_i/E_b above which the paper says that the particles no longer matter (its section 4)."""

WIDEST_STEP = 10.01
"""Between swept ratios farther apart than this factor nothing is interpolated."""

MARGIN = 10.0
"""The finite element limit counts as reached this many times above the ratio that is looked for."""

FloatArray = NDArray[np.float64]


def particles_negligible_from(study: xr.Dataset, tolerance: float = 0.01) -> pd.DataFrame:
    """Modulus ratio E_i/E_m from which K_n is that of the interface alone.

    Parameters
    ----------
    study
        A sweep's result with an axis ``modulus_ratio``, ``stiffness(model, axes...)`` [N m-1] and,
        for FSI, the contribution ``k_int(axes...)`` [N m-1].
    tolerance
        Largest relative deviation from the interface-only stiffness.

    Returns
    -------
    pandas.DataFrame
        A row for each method (``fsi`` and the references) and each combination of the other axes
        (columns by their names): ``ratio_from``, NaN when the sweep does not show it, and
        ``deviation_at_paper_ratio``, how far K_n is below the interface-only stiffness at the
        paper's E_i/E_b = 12. Empty when there is no such axis.

    Notes
    -----
    By FSI the interface-only stiffness is k_int. By finite elements it is that of rigid particles,
    ``K = E_m lim(K/E_m)``, the limit taken at the largest ratio swept. Small deviations d fall as
    E_m/E_i, so the ratio is interpolated on straight lines in log-log. At the paper's ratio they
    are not small: there it is d/(1 - d), the particles' compliance over the interface's, which
    falls as E_m/E_i throughout when the two are in series.
    """
    axes = [axis for axis in swept_axes(study) if axis != RATIO_AXIS]
    columns = ["method", *axes, "ratio_from", "deviation_at_paper_ratio", "largest_ratio"]
    if RATIO_AXIS not in swept_axes(study) or is_scattered(study):
        return pd.DataFrame(columns=columns)
    ordered = study.sortby(RATIO_AXIS)
    ratio = axis_values(ordered, RATIO_AXIS).astype(float)
    rows = []
    for method, deviation in _deviations(ordered).items():
        for at, values in _lines(deviation.transpose(..., RATIO_AXIS)):
            largest = ratio[-1]
            bound = largest if method == "fsi" else largest / MARGIN
            found = negligible_from(ratio, values, tolerance)
            rows.append(
                {
                    "method": method,
                    **at,
                    "ratio_from": found if found <= bound else np.nan,
                    "deviation_at_paper_ratio": _deviation_at(PAPER_RATIO, ratio, values),
                    "largest_ratio": largest,
                }
            )
    return pd.DataFrame(rows, columns=columns)


def negligible_from(ratio: FloatArray, deviation: FloatArray, tolerance: float) -> float:
    """Ratio above which the deviation stays within the tolerance, NaN when it does not.

    Parameters
    ----------
    ratio
        Rising modulus ratios, shape (n,).
    deviation
        Relative deviations from the interface-only stiffness, shape (n,); NaN and zero (where the
        stiffness is itself taken for the limit) are skipped.
    tolerance
        The bound.

    Examples
    --------
    >>> ratio = np.array([1.0, 10.0, 100.0, 1000.0])
    >>> round(negligible_from(ratio, 2.5 / ratio, 0.01), 6)
    250.0
    """
    known = np.isfinite(deviation) & (deviation != 0)  # zero only where it is the limit itself
    ratio, size = ratio[known], np.abs(deviation[known])
    above = np.flatnonzero(size > tolerance)
    if not size.size or size[-1] > tolerance:
        return float("nan")
    if not above.size:
        return float(ratio[0])
    last = int(above[-1])
    if ratio[last + 1] / ratio[last] > WIDEST_STEP:
        return float("nan")
    high, low = np.log(size[last]), np.log(size[last + 1])
    share = (high - np.log(tolerance)) / (high - low)
    step = np.log(ratio[last + 1] / ratio[last])
    return float(ratio[last] * np.exp(share * step))


def _deviations(study: xr.Dataset) -> dict[str, xr.DataArray]:
    """Relative shortfall of K_n against the interface-only stiffness, by method."""
    stiffness = study["stiffness"]
    found = {}
    if "fsi" in study["model"].values and "k_int" in study:
        found["fsi"] = 1 - stiffness.sel(model="fsi", drop=True) / study["k_int"]
    for name in reference_names(study):
        scaled = stiffness.sel(model=name, drop=True) / study["young_m"]
        limit = scaled.isel({RATIO_AXIS: -1}, drop=True)
        found[name] = 1 - scaled / limit
    return found


def _lines(deviation: xr.DataArray) -> list[tuple[dict[str, Any], FloatArray]]:
    others = [str(name) for name in deviation.dims[:-1]]
    lines = []
    for index in np.ndindex(deviation.shape[:-1]):
        at = {
            axis: axis_values(deviation, axis)[position]
            for axis, position in zip(others, index, strict=True)
        }
        lines.append((at, np.asarray(deviation.values[index], dtype=float)))
    return lines


def _deviation_at(wanted: float, ratio: FloatArray, deviation: FloatArray) -> float:
    good = np.isfinite(deviation) & (deviation > 0) & (deviation < 1)
    if good.sum() < 2 or not ratio[good][0] <= wanted <= ratio[good][-1]:
        return float("nan")
    compliance = deviation[good] / (1.0 - deviation[good])
    at = float(np.exp(np.interp(np.log(wanted), np.log(ratio[good]), np.log(compliance))))
    return at / (1.0 + at)
