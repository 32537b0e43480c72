"""Numbers of one Prony series as users give them: checked, then made shares of the whole."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from bondcell.cell import FloatArray
from bondcell.errors import Violation
from bondcell.prony.chain import Chain, merged
from bondcell.relaxing_ranges import FLUID, TIMES

LEAST_SHARE = 1e-120
"""Weights below this share of the whole are nothing."""


def _numbers(field: str, given: Any, violations: list[Violation]) -> FloatArray | None:
    try:
        raw = np.atleast_1d(np.asarray(given))
    except ValueError:
        raw = np.empty((), dtype=object)
    if raw.ndim != 1 or (raw.size and raw.dtype.kind not in "iuf"):
        violations.append(Violation(field, given, "a list of numbers"))
        return None
    return raw.astype(float)


def checked_series(
    prefix: str,
    relative_to: str,
    weights: Any,
    times: Any,
    long_term: Any,
    violations: list[Violation],
) -> tuple[FloatArray, FloatArray, float]:
    """Numbers of one series; what is wrong goes to ``violations``."""
    before = len(violations)
    w = _numbers(f"{prefix}weights", weights, violations)
    tau = _numbers(f"{prefix}times", times, violations)
    for k, value in enumerate(() if w is None else w):
        if not (np.isfinite(value) and value >= 0):
            violations.append(Violation(f"{prefix}weights[{k}]", float(value), "[0, inf), finite"))
    for k, value in enumerate(() if tau is None else tau):
        if not TIMES[0] <= value <= TIMES[1]:
            allowed = f"[{TIMES[0]:g}, {TIMES[1]:g}] s"
            violations.append(Violation(f"{prefix}times[{k}]", float(value), allowed))
    if w is not None and tau is not None and w.size != tau.size:
        allowed = f"as many as {prefix}weights, {w.size}"
        violations.append(Violation(f"{prefix}times", f"{tau.size} values", allowed))
    end = _checked_end(f"{prefix}long_term", relative_to, long_term, violations)
    if w is None or tau is None or len(violations) > before:
        return np.empty(0), np.empty(0), 0.0
    if relative_to == "instantaneous" and math.fsum(w) > 1 + FLUID:
        allowed = "at most 1 relative to the instantaneous modulus"
        violations.append(Violation(f"sum of {prefix}weights", math.fsum(w), allowed))
    if relative_to == "absolute" and end + math.fsum(w) <= 0:
        violations.append(Violation(f"sum of {prefix}weights", 0.0, "(0, inf) Pa with long_term"))
    return w, tau, end


def _checked_end(field: str, relative_to: str, given: Any, violations: list[Violation]) -> float:
    if relative_to != "absolute":
        if given is not None:
            violations.append(Violation(field, given, "left out unless weights are absolute"))
        return 0.0
    number = isinstance(given, int | float | np.number) and not isinstance(given, bool)
    if not number or not (np.isfinite(given) and given >= 0):
        violations.append(Violation(field, given, "[0, inf) Pa, finite: absolute weights need it"))
        return 0.0
    return float(given)


def normalised(
    relative_to: str, weights: FloatArray, times: FloatArray, end: float
) -> tuple[Chain, float]:
    """Series relative to the instantaneous modulus, and that modulus over the reference one."""
    if relative_to == "instantaneous":
        rest = math.fsum([1.0, *(-weights)])
        equilibrium, scale = (rest if rest > FLUID else 0.0), 1.0
    else:
        end = 1.0 if relative_to == "long_term" else end
        scale = math.fsum([end, *weights])
        equilibrium, weights = end / scale, weights / scale
    strengths, ordered = merged(np.where(weights > LEAST_SHARE, weights, 0.0), times)
    return Chain(np.asarray(equilibrium), strengths, ordered), scale
