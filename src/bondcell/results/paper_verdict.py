"""How the paper's model does at a cell, and what it leaves out there, in words."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from bondcell.results.accuracy_map import AXES, AccuracyMap, decode
from bondcell.cell import Cell
from bondcell.wording import listed, number, percent

if TYPE_CHECKING:
    from bondcell.advice import Candidate

PAPER = "fsi"

SHARE = 0.25
"""A cause is named if its part of the error is at least this share of the largest part."""


def paper_verdict(
    shipped: AccuracyMap, cell: Cell, load: str, wanted: float, found: Candidate | None
) -> str:
    """A sentence or two on the paper's model.

    Parameters
    ----------
    shipped
        The accuracy map.
    cell
        The cells.
    load
        The load.
    wanted
        The wanted error.
    found
        What is known of the paper's model; None if it does not have the load.

    Notes
    -----
    The error e is split along the map: from rigid particles in a matrix without Poisson's effect,
    whose error e_0 is that of lines of matrix which do not drag each other along, to particles of
    the given modulus, e_1, to the given matrix, e. The parts are the logarithms of ``1 + e_0``,
    ``(1 + e_1)/(1 + e_0)`` and ``(1 + e)/(1 + e_1)``.
    """
    if found is None:
        return f"Why not FSI, the paper's model: it has no {load}, only the normal stiffness."
    if np.isnan(found.expected_error):
        return "FSI, the paper's model: its error here is not known."
    span = _span(found)
    if found.serves(wanted):
        return f"FSI, the paper's model, serves here: error {span}."
    if found.expected_error <= wanted:
        return f"FSI, the paper's model, is outside its stated range here: error {span}."
    causes = _causes(shipped, cell)
    because = f", by {listed(causes)}" if causes else ""
    return f"Why not FSI, the paper's model: error {span}{because}."


def _span(found: Candidate) -> str:
    low, high = percent(found.error_low, sign=True), percent(found.error_high, sign=True)
    return low if low == high else f"{low} to {high}"


def _causes(shipped: AccuracyMap, cell: Cell) -> list[str]:
    """What makes the error at the worst neighbouring point of the map, the largest part first."""
    flat = cell.ravel()
    flat = flat.take(np.flatnonzero(shipped.contains(flat)))
    if not flat.gap.size:
        return []
    error = decode(shipped.codes["normal"][PAPER])
    corners = [np.stack(corner) for corner in shipped.corners(flat)]
    points = np.concatenate(corners, axis=1).T
    at = points[np.abs(error[tuple(points.T)]).argmax()]
    gap, ratio, poisson = (shipped.axes[axis][i] for axis, i in zip(AXES, at, strict=True))
    rigid, stiff, actual = error[at[0], -1, 0], error[at[0], at[1], 0], error[tuple(at)]
    poisson_words = (
        f"Poisson's effect, which it ignores: with ν_m = {number(poisson)} the matrix cannot just "
        f"stretch, it must flow sideways (with ν_m = 0 the error would be "
        f"{percent(stiff, sign=True)})"
    )
    soft_words = (
        f"soft particles, only {number(ratio)} times stiffer than the matrix, each of them one "
        f"spring (rigid ones without Poisson's effect: {percent(rigid, sign=True)})"
    )
    line_words = (
        "lines of matrix that do not drag each other along: even for rigid particles and ν_m = 0 "
        f"that makes {percent(rigid, sign=True)} at L_g/R = {number(gap)}"
    )
    parts = {
        poisson_words: np.log1p(actual) - np.log1p(stiff),
        soft_words: np.log1p(stiff) - np.log1p(rigid),
        line_words: np.log1p(rigid),
    }
    sizes = {words: abs(float(part)) for words, part in parts.items()}
    most = max(sizes.values())
    ordered = sorted(sizes, key=lambda words: -sizes[words])
    return [words for words in ordered if sizes[words] >= SHARE * most]
