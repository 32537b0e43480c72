"""Relaxation of every bond cell in a study: its exact Prony series, K(t) and K*(omega)."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

from bondcell.errors import InputError, Violation
from bondcell.evaluate import checked_model
from bondcell.inputs import cell_from_study
from bondcell.outputs import FREQUENCY, STIFFNESS_UNITS, TIME
from bondcell.prony.axis import checked_axis
from bondcell.prony.conventions import Relaxing, absolute_moduli
from bondcell.prony.prony import Prony
from bondcell.relaxation_points import Answer, Question, flags, flags_for_all_times, solve, states
from bondcell.status import cf_flag_attributes

OWN_DIMS = ("time", "frequency", "term")
"""Dimensions that results add to those of the study."""


def relaxation(
    study: xr.Dataset,
    prony: Prony,
    time: ArrayLike,
    model: str = "fsi",
    convention: str | None = None,
    load: str = "normal",
    **options: Any,
) -> xr.Dataset:
    """Stiffness of the bond at every time after a step displacement.

    Parameters
    ----------
    study
        As for `bondcell.evaluate`; the matrix moduli are those that ``prony.relative_to`` says.
        With absolute weights ``young_m`` may be left out.
    prony
        How the matrix relaxes.
    time
        Times since the step [s], not negative; inf is the end.
    model, load, **options
        As for `bondcell.evaluate`.
    convention
        ``"constant_bulk"`` (default), ``"constant_poisson"``, or ``"separate"`` (default and only
        choice with a bulk series).

    Returns
    -------
    xarray.Dataset
        ``stiffness(time, ...)`` = F(t)/d [N m-1; N m rad-1], ``error_estimate(...)`` (relative, at
        any time), ``status(time, ...)``: a model may leave its valid range as poisson_m rises;
        ``dof``, ``seconds``.

    Examples
    --------
    >>> study = xr.Dataset(
    ...     {
    ...         "radius_i": 7.5e-3,
    ...         "young_i": 3e10,
    ...         "poisson_i": 0.25,
    ...         "young_m": 1.4e6,
    ...         "poisson_m": 0.46,
    ...     },
    ...     coords={"gap": [5e-4, 1e-3]},
    ... )
    >>> out = relaxation(study, Prony([0.6, 0.3], [1.0, 100.0]), [0.0, 1.0, np.inf])
    >>> dict(out.sizes)
    {'time': 3, 'gap': 2}
    >>> out.stiffness.isel(gap=0).round(-1).values
    array([84060., 52570.,  8610.])
    """
    question = _ask(study, prony, model, convention, load, options)
    points = checked_axis("time", time)
    answer = solve(question)
    shape = (points.size, *question.shape)
    stiffness = answer.series.relaxation(points).reshape(shape)
    status = np.array([flags(question, answer, state) for state in states(question, points)])
    dims = ("time", *question.dims)
    variables = {
        "stiffness": (dims, stiffness, _stiffness_attributes(load, "stiffness after a step")),
        "status": (dims, status.reshape(shape), cf_flag_attributes()),
        **_point_variables(question, answer),
    }
    coords = {**question.coords, "time": ("time", points, TIME)}
    return xr.Dataset(variables, coords, question.attributes)


def relaxation_series(
    study: xr.Dataset,
    prony: Prony,
    model: str = "fsi",
    convention: str | None = None,
    load: str = "normal",
    **options: Any,
) -> xr.Dataset:
    """The Prony series of the bond itself, ``K(t) = K_inf + sum K_k exp(-t/tau_k)``.

    Parameters
    ----------
    study, prony, model, convention, load, **options
        As for `relaxation`.

    Returns
    -------
    xarray.Dataset
        ``K_inf(...)``, ``K_k(..., term)`` [N m-1; N m rad-1], ``tau_k(..., term)`` [s], times
        ascending; points with fewer terms are padded with NaN. ``error_estimate(...)`` (relative,
        of K at any time), ``status(...)``, ``dof``, ``seconds``.

    Examples
    --------
    >>> study = xr.Dataset(
    ...     {
    ...         "radius_i": 7.5e-3,
    ...         "gap": 5e-4,
    ...         "young_i": 3e10,
    ...         "poisson_i": 0.25,
    ...         "young_m": 1.4e6,
    ...         "poisson_m": 0.46,
    ...     }
    ... )
    >>> series = relaxation_series(study, Prony([0.6, 0.3], [1.0, 100.0]))
    >>> series.tau_k.round(3).values
    array([  1.016, 100.823])
    """
    question = _ask(study, prony, model, convention, load, options)
    answer = solve(question)
    dims, shape = question.dims, question.shape
    series = answer.series
    used = (series.strengths > 0).sum(axis=1).max(initial=0)
    padded = ~(series.strengths[:, :used] > 0)
    strengths = np.where(padded, np.nan, series.strengths[:, :used])
    times = np.broadcast_to(series.times, series.strengths.shape)[:, :used]
    times = np.where(padded, np.nan, times)
    units = STIFFNESS_UNITS[load]
    final = {"units": units, "long_name": "stiffness that never relaxes"}
    part = {"units": units, "long_name": "stiffness of the term at t = 0"}
    tau = {"units": "s", "long_name": "relaxation time of the term"}
    variables = {
        "K_inf": (dims, series.equilibrium.reshape(shape), final),
        "K_k": ((*dims, "term"), strengths.reshape(*shape, used), part),
        "tau_k": ((*dims, "term"), times.reshape(*shape, used), tau),
        "status": (
            dims,
            flags_for_all_times(question, answer).reshape(shape),
            cf_flag_attributes(),
        ),
        **_point_variables(question, answer),
    }
    return xr.Dataset(variables, question.coords, question.attributes)


def dynamic_stiffness(
    study: xr.Dataset,
    prony: Prony,
    frequency: ArrayLike,
    model: str = "fsi",
    convention: str | None = None,
    load: str = "normal",
    **options: Any,
) -> xr.Dataset:
    """Complex stiffness K*(omega) of the bond under steady oscillation.

    Parameters
    ----------
    frequency
        Angular frequencies [rad/s], not negative.
    study, prony, model, convention, load, **options
        As for `relaxation`.

    Returns
    -------
    xarray.Dataset
        ``storage`` and ``loss`` (real and imaginary part) on (frequency, ...) [N m-1; N m rad-1],
        ``loss_factor``, and ``error_estimate``, ``status``, ``dof``, ``seconds`` on (...).
    """
    question = _ask(study, prony, model, convention, load, options)
    points = checked_axis("frequency", frequency, allow_end=False)
    answer = solve(question)
    value = answer.series.dynamic(points).reshape(points.size, *question.shape)
    with np.errstate(divide="ignore", invalid="ignore"):
        factor = np.where(value.real > 0, value.imag / value.real, np.inf)
    factor = np.where(np.isnan(value.real), np.nan, factor)
    dims = ("frequency", *question.dims)
    status = flags_for_all_times(question, answer).reshape(question.shape)
    variables = {
        "storage": (dims, value.real, _stiffness_attributes(load, "storage stiffness")),
        "loss": (dims, value.imag, _stiffness_attributes(load, "loss stiffness")),
        "loss_factor": (dims, factor, {"units": "1", "long_name": "loss over storage"}),
        "status": (question.dims, status, cf_flag_attributes()),
        **_point_variables(question, answer),
    }
    coords = {**question.coords, "frequency": ("frequency", points, FREQUENCY)}
    return xr.Dataset(variables, coords, question.attributes)


def _ask(
    study: xr.Dataset,
    prony: object,
    model: str,
    convention: str | None,
    load: str,
    options: dict[str, Any],
) -> Question:
    chosen = checked_model(model, load, options)
    taken = [dim for dim in OWN_DIMS if isinstance(study, xr.Dataset) and dim in study.dims]
    if taken:
        allowed = f"dimensions of other names: {', '.join(OWN_DIMS)} are the results' own"
        raise InputError([Violation("study", dim, allowed) for dim in taken])
    if not isinstance(prony, Prony):
        raise InputError([Violation("prony", type(prony).__name__, "a bondcell.Prony")])
    if isinstance(study, xr.Dataset) and prony.instantaneous_modulus is not None:
        given = study["poisson_m"].values if "poisson_m" in study.variables else np.nan
        fixed = absolute_moduli(prony, np.asarray(given, dtype=float))
        for name, value in fixed.items():
            if name not in study.variables:
                dims = study["poisson_m"].dims if value.ndim else ()
                study = study.assign({name: (dims, value)})
    cell, dims = cell_from_study(study)
    matrix = Relaxing.of(cell.ravel(), prony, convention)
    return Question(study, chosen, load, dict(options), matrix, cell.shape, dims)


def _stiffness_attributes(load: str, name: str) -> dict[str, str]:
    return {"units": STIFFNESS_UNITS[load], "long_name": f"{load} {name} of the bond"}


def _point_variables(question: Question, answer: Answer) -> dict[str, Any]:
    error = {"units": "1", "long_name": "relative numerical error at any time"}
    dof = {"units": "1", "long_name": "degrees of freedom"}
    seconds = {"units": "s", "long_name": "wall time per point"}
    shape, dims = question.shape, question.dims
    return {
        "error_estimate": (dims, answer.error.reshape(shape), error),
        "dof": (dims, answer.dof.reshape(shape), dof),
        "seconds": (dims, answer.seconds.reshape(shape), seconds),
    }
