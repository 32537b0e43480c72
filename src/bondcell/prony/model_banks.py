"""The analytic models as banks of springs: exactly, or by a quadrature to round-off.

Each function gives K as a function of one modulus of the matrix: Young's modulus, but for
`cementation` the modulus of confined compression.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.linalg

from bondcell.cell import Cell, FloatArray
from bondcell.models import fsi, parallel_bond
from bondcell.models.cementation import oedometric_modulus
from bondcell.models.columns import Columns, annulus
from bondcell.models.elastic_foundation import operators
from bondcell.models.general import film_core
from bondcell.models.model import radius_ratio
from bondcell.prony import secular
from bondcell.prony.bank import Bank
from bondcell.prony.graded_rule import graded_rule

LEAST_LEDGE = 1e-8
"""Ledge over the smaller radius below which both spheres are as good as equal."""

NEGLIGIBLE = 1e-18
"""Share of the compliance below which a slice is left out."""


@dataclass(frozen=True)
class Representation:
    """How a model becomes a bank.

    Parameters
    ----------
    bank
        ``(cell, **options) -> Bank`` of a raveled cell.
    modulus
        What it is a function of: ``"young"`` or ``"oedometric"``.
    """

    bank: Callable[..., Bank]
    modulus: str = "young"


def fsi_bank(cell: Cell) -> Bank:
    """One pair: ``1/K = 1/k_int + 1/k_i + 1/k_j``, ``k_int = m E_m``."""
    strength = fsi.interface(cell) / cell.young_m
    before = _two(
        fsi.particle(cell.young_i, cell.radius_i), fsi.particle(cell.young_j, cell.radius_j)
    )
    return Bank.of(strength[:, None], (strength * before)[:, None])


def parallel_bond_bank(cell: Cell, **options: Any) -> Bank:
    """One spring of matrix: ``K = m E_m``."""
    strength = parallel_bond.normal(cell, **options).stiffness / cell.young_m
    return Bank.of(strength[:, None], np.zeros((strength.size, 1)))


def generatrix_bank(cell: Cell) -> Bank:
    """Every line a pair, ``m = dA/h_m``, ``a = (h_i/E_i + h_j/E_j)/h_m``; the annulus is bare."""
    return _lines(cell, Columns.of_cell(cell)).beside(_bare(2 * np.pi * annulus(cell)))


def general_bank(cell: Cell, core_radius_ratio: float | None = None) -> Bank:
    """The core is a pair, the lines outside it as for `generatrix_bank`."""
    if core_radius_ratio is None:
        square, complement = film_core(cell)
    else:
        ratio = np.asarray(radius_ratio("core_radius_ratio", core_radius_ratio))
        square, complement = ratio**2, (1 - ratio) * (1 + ratio)
    columns = Columns.outside(cell, square, complement)
    core_square = square * np.minimum(cell.radius_i, cell.radius_j) ** 2
    height_i, height_j = columns.heights(cell)
    k_i = 2 * np.pi * cell.young_i * core_square / (cell.radius_i + height_i)
    k_j = 2 * np.pi * cell.young_j * core_square / (cell.radius_j + height_j)
    layer = np.pi * core_square / cell.gap
    core = Bank.of(layer[:, None], (layer * _two(k_i, k_j))[:, None])
    return core.beside(_lines(cell, columns)).beside(_bare(2 * np.pi * annulus(cell)))


def slices_bank(cell: Cell, relaxed: float = 0.0) -> Bank:
    """Slices in series, ``1/K = sum w_l/(E + rho_l)``, turned into pairs side by side.

    Parameters
    ----------
    cell
        A raveled cell.
    relaxed
        Share of the cell's E_m down to which E_m relaxes: the softer the matrix, the nearer to the
        tips of the particles do slices count.

    Notes
    -----
    A slice has ``w = dz/A_m``, ``rho = E_i A_i/A_m``, the gap ``w = L_g/A``, ``rho = 0``.
    ``K(E) = E/sum w_l + sum a_j E/(E + e_j)``: ``-e_j`` are the zeros of the sum, one between any
    two neighbouring ``-rho_l``, and ``a_j = 1/(e_j sum w_l/(rho_l - e_j)^2)``.
    """
    outer = cell.cylinder_radius[:, None]
    poles, weights = [np.zeros((outer.size, 1))], [cell.gap[:, None] / (np.pi * outer**2)]
    for radius, young in ((cell.radius_i, cell.young_i), (cell.radius_j, cell.young_j)):
        finite = np.where(np.isinf(young), cell.young_m, young)
        ratio = cell.young_m / finite
        ring = (cell.cylinder_radius - radius) * (cell.cylinder_radius + radius)
        root = np.sqrt(radius**2 / ratio + ring)
        tip = np.maximum(radius * np.minimum(1.0, ratio * relaxed), 1e-17 * cell.gap)
        z, from_tip, weight = graded_rule(radius, root, tip)
        area_m = ring[:, None] + z**2
        area_i = from_tip * (radius[:, None] + z)
        rigid = np.isinf(young)[:, None]
        poles.append(np.where(rigid, 0.0, finite[:, None] * area_i / area_m))
        weights.append(np.where(rigid, 0.0, weight / (np.pi * area_m)))
    pole, share = np.hstack(poles), np.hstack(weights)
    stiff = cell.young_m[:, None]
    compliance = share / (stiff + pole)
    share = np.where(compliance > NEGLIGIBLE * compliance.sum(axis=1, keepdims=True), share, 0.0)
    pairs = [_pairs(p, w) for p, w in zip(pole, share, strict=True)]
    width = max(m.size for m, _ in pairs)
    strength, softness = (np.zeros((len(pairs), width)) for _ in range(2))
    for k, (m, a) in enumerate(pairs):
        strength[k, : m.size], softness[k, : a.size] = m, a
    return Bank.of(strength, softness)


def _pairs(poles: FloatArray, weights: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Pairs side by side of one compliance ``sum w_l/(E + rho_l)``."""
    distinct, position = np.unique(poles, return_inverse=True)
    sums: FloatArray = np.bincount(position, weights).astype(float)
    distinct, sums = distinct[sums > 0], sums[sums > 0]
    zero = np.zeros(1)
    roots = secular.solve(distinct, (sums, np.zeros_like(sums)), (zero, zero))
    e = roots.value[0]
    strength = np.concatenate(([1 / sums.sum()], 1 / e / e / roots.slope[0]))
    return strength, np.concatenate((zero, 1 / e))


def cementation_bank(cell: Cell, cement_radius_ratio: float = 1.0) -> Bank:
    """Principal tractions of the integral equation, a function of the oedometric modulus M.

    ``K = 4 pi R* M f.(A_0 + c M H)^-1 f`` is diagonal in the eigenvectors of A_0 and H. They are
    taken from ``c M H v = theta (A_0 + c M H) v`` at the cell's own M, where the sum is then exact.
    """
    ratio = radius_ratio("cement_radius_ratio", cement_radius_ratio)
    radius = ratio * np.minimum(cell.radius_i, cell.radius_j)
    curvature = 1 / (1 / cell.radius_i + 1 / cell.radius_j)
    grains = (1 - cell.poisson_i**2) / cell.young_i + (1 - cell.poisson_j**2) / cell.young_j
    gap = 2 * curvature / radius * (cell.gap / radius)
    flexibility = 8 * curvature / (np.pi * radius) * grains
    modulus = oedometric_modulus(cell.young_m, cell.poisson_m)
    modulus = np.where(np.isfinite(modulus), modulus, cell.young_m)
    op = operators()
    strength, softness = (np.empty((radius.size, op.resultant.size)) for _ in range(2))
    for k in range(radius.size):
        layer = gap[k] * op.uniform + op.parabolic
        settled = flexibility[k] * modulus[k] * op.half_spaces
        theta, vectors = scipy.linalg.eigh(settled, layer + settled)
        theta = np.clip(theta, 0.0, 1 - 1e-15)
        strength[k] = 4 * np.pi * curvature[k] * (vectors.T @ op.resultant) ** 2 / (1 - theta)
        softness[k] = theta / (1 - theta) / modulus[k]
    return Bank.of(strength, softness)


BANKS: Mapping[str, Representation] = {
    "fsi": Representation(fsi_bank),
    "general": Representation(general_bank),
    "generatrix": Representation(generatrix_bank),
    "slices": Representation(slices_bank),
    "parallel_bond": Representation(parallel_bond_bank),
    "cementation": Representation(cementation_bank, "oedometric"),
}
"""Models of the normal load whose series is exact."""


def _two(k_i: FloatArray, k_j: FloatArray) -> FloatArray:
    """Compliance of two springs in a row."""
    return 1 / k_i + 1 / k_j


def _bare(strength: FloatArray) -> Bank:
    return Bank.of(strength[:, None], np.zeros((strength.size, 1)))


def _lines(cell: Cell, columns: Columns) -> Bank:
    """Lines through both spheres, and those through the larger one only; see `columns`."""
    large, small, ledge, gap = (
        np.broadcast_to(part, cell.shape)
        for part in (columns.large, columns.small, columns.ledge, columns.gap)
    )
    swap = cell.radius_j > cell.radius_i
    young_large = np.where(swap, cell.young_j, cell.young_i)
    young_small = np.where(swap, cell.young_i, cell.young_j)
    length = large + small + gap
    softest = np.minimum(young_large, young_small) / (2 * cell.young_m)
    branch = np.where(ledge > LEAST_LEDGE * small, ledge, np.inf)
    start = np.minimum(length * softest, branch)
    both = _crossing(
        graded_rule(small, start, gap / 2), large, small, ledge, gap, young_large, young_small
    )
    if not (ledge > 0).any():
        return both
    beside = gap + small * (1 + small / (large + ledge))
    edge, rest, weight = graded_rule(ledge, length * softest, beside)
    matrix = beside[:, None] + rest
    rim = Bank.of(2 * np.pi * weight * edge / matrix, edge / young_large[:, None] / matrix)
    return both.beside(rim)


def _crossing(rule: tuple[FloatArray, FloatArray, FloatArray], *of_points: FloatArray) -> Bank:
    """Lines through both spheres, by the height of the smaller one on them."""
    height, below, weight = rule
    large, small, ledge, gap, young_large, young_small = (part[:, None] for part in of_points)
    height_large = np.where(ledge == 0, height, np.hypot(ledge, height))
    matrix = gap + below * (1 + (small + height) / (large + height_large))
    soft = height_large / young_large + height / young_small
    return Bank.of(2 * np.pi * weight * height / matrix, soft / matrix)
