"""Closed-form models against their definitions in 50 or more digits, from the exact doubles on."""

from dataclasses import dataclass

import numpy as np
import pytest
from mpmath import mp, mpf

from bondcell.cell import Cell, FloatArray
from bondcell.models import MODELS
from bondcell.models.general import film_core

GAPS = (1e-12, 1e-7, 1e-3, 0.07, 1.0, 1e3, 1e6)
RADII = (1e-3, 0.03, 0.5, 0.99, 1 - 1e-6, 1 - 1e-11, 1 - 1e-15, 1.0)
MODULI = (1e-12, 1e-3, 0.3, 1 - 1e-9, 1.0, 1 + 1e-9, 2.0, 20.0, 1e6, 1e12)
CYLINDERS = (1.0, 1 + 1e-12, 1.3, 1e4)

DIGITS = 50
ZERO = mpf(0)
NUDGE = mpf(10) ** -80
"""Moves roots of partial fractions apart or off zero; changes an integral in the 80th digit."""


@dataclass(frozen=True)
class Exact:
    """One cell in high precision, the larger particle first."""

    large: mpf
    small: mpf
    gap: mpf
    outer: mpf
    young_large: mpf
    young_small: mpf
    matrix: mpf

    @property
    def length(self) -> mpf:
        return self.large + self.small + self.gap


def exact(cell: Cell, index: int) -> Exact:
    value = {name: mpf(float(array[index])) for name, array in cell.as_dict().items()}
    i, j = (value["radius_i"], value["young_i"]), (value["radius_j"], value["young_j"])
    (large, young_large), (small, young_small) = (i, j) if i[0] >= j[0] else (j, i)
    return Exact(
        large,
        small,
        value["gap"],
        value["cylinder_radius"],
        young_large,
        young_small,
        value["young_m"],
    )


def log_remainder(y: mpf) -> mpf:
    """-log(1 - y) - y with enough working digits for any y met here."""
    with mp.workdps(4 * mp.dps):
        return -mp.log(1 - y) - y


def lines(x: Exact, soft_large: mpf, soft_small: mpf, core: mpf = ZERO) -> mpf:
    """Integral of r dr / (h_m + soft_l h_l + soft_s h_s), core < r < large, by partial fractions.

    With w = h_l + h_s: h_l - h_s = D/w, r dr = -(w - D^2/w^3)/4 dw, D = R_l^2 - R_s^2.
    """
    a, b = 1 - soft_large, 1 - soft_small
    length = x.length
    difference = x.large**2 - x.small**2
    top = mp.sqrt(x.large**2 - core**2), mp.sqrt(x.small**2 - core**2)
    if difference == 0:
        y = (a + b) * top[0] / length
        return top[0] ** 2 / (2 * length) if y == 0 else top[0] ** 2 / length * remainder(y)
    rim = mp.sqrt(difference)
    y = a * rim / length
    ledge = rim**2 / length * (mpf(1) / 2 if y == 0 else remainder(y))
    if top[1] == 0:
        return ledge
    with mp.workdps(400):
        p = (a + b) / 2 + NUDGE * (1 + abs(a))
        q = (a - b) * difference / 2 + NUDGE * difference * (1 + abs(a))
        root = mp.sqrt(length**2 - 4 * p * q)
        outer, inner = (length + root) / (2 * p), (length - root) / (2 * p)

        def residue(at: mpf, other: mpf) -> mpf:
            return (at**4 - difference**2) / (-p * at**2 * (at - other))

        low, high = mp.sqrt(difference), sum(top)
        both = (
            -(high - low) / p
            + difference**2 / q * (1 / low - 1 / high)
            + difference**2 * length / q**2 * mp.log(high / low)
            + residue(outer, inner) * mp.log((high - outer) / (low - outer))
            + residue(inner, outer) * mp.log((high - inner) / (low - inner))
        )
        return ledge + mp.re(both) / 4


def remainder(y: mpf) -> mpf:
    return log_remainder(y) / y**2


def exact_fsi(x: Exact) -> mpf:
    ring = (x.outer**2 - x.large**2) / (2 * x.length)
    k_int = 2 * mp.pi * x.matrix * (lines(x, ZERO, ZERO) + ring)
    particles = 1 / (x.young_large * x.large) + 1 / (x.young_small * x.small)
    return 1 / (particles / (2 * mp.pi) + 1 / k_int)


def exact_generatrix(x: Exact, core: mpf = ZERO) -> mpf:
    ring = (x.outer**2 - x.large**2) / (2 * x.length)
    inside = lines(x, x.matrix / x.young_large, x.matrix / x.young_small, core)
    return 2 * mp.pi * x.matrix * (inside + ring)


def exact_general(x: Exact, core: mpf) -> mpf:
    def cap(young: mpf, radius: mpf) -> mpf:
        return 2 * mp.pi * young * core**2 / (radius + mp.sqrt(radius**2 - core**2))

    layer = mp.pi * x.matrix * core**2 / x.gap
    series = 1 / cap(x.young_large, x.large) + 1 / layer + 1 / cap(x.young_small, x.small)
    return 1 / series + exact_generatrix(x, core)


def exact_slices(x: Exact) -> mpf:
    """Integral of dz / (pi (c^2 + d (R^2 - z^2))), d = E - E_m, by arc tangents of either kind."""

    def particle(young: mpf, radius: mpf) -> mpf:
        excess = young - x.matrix
        if excess == 0:
            return radius / (mp.pi * x.matrix * x.outer**2)
        top = mp.sqrt(x.matrix * x.outer**2 + excess * radius**2)
        root = mp.sqrt(abs(excess))
        angle = mp.atanh if excess > 0 else mp.atan
        return angle(root * radius / top) / (mp.pi * root * top)

    layer = x.gap / (mp.pi * x.matrix * x.outer**2)
    both = particle(x.young_large, x.large) + particle(x.young_small, x.small)
    return 1 / (both + layer)


def exact_film_core(x: Exact) -> mpf:
    doubling = 2 * x.large * x.small / (x.large + x.small) * x.gap
    return mp.sqrt(1 / (1 / doubling + 1 / x.small**2))


REFERENCES = {
    "fsi": exact_fsi,
    "generatrix": exact_generatrix,
    "slices": exact_slices,
    "general": lambda x: exact_general(x, exact_film_core(x)),
}


def cells(rng: np.random.Generator, points: int) -> Cell:
    """Half from the corners of the required range, half from within, near-coincidences included."""

    def mixed(corners: tuple[float, ...], low: float, high: float) -> FloatArray:
        inside = 10 ** rng.uniform(low, high, points)
        return np.where(rng.random(points) < 0.5, rng.choice(corners, points), inside)

    scale = 7.5e-3
    ratio = mixed(RADII, -3, 0)
    near = 1 - 10 ** rng.uniform(-15, -1, points)
    ratio = np.where(rng.random(points) < 0.2, near, ratio)
    radius_i, radius_j = np.full(points, scale), scale * ratio
    young_i, young_j = mixed(MODULI, -12, 12), mixed(MODULI, -12, 12)
    young_j = np.where(rng.random(points) < 0.3, young_i, young_j)
    young_j = np.where(rng.random(points) < 0.1, young_i * (1 + 1e-13), young_j)
    swap = rng.random(points) < 0.5
    radius_i, radius_j = np.where(swap, radius_j, radius_i), np.where(swap, radius_i, radius_j)
    return Cell.from_values(
        radius_i=radius_i,
        radius_j=radius_j,
        gap=scale * mixed(GAPS, -12, 6),
        cylinder_radius=scale * rng.choice(CYLINDERS, points),
        young_i=1.4e6 * young_i,
        young_j=1.4e6 * young_j,
        young_m=1.4e6,
        poisson_i=0.25,
        poisson_m=0.46,
    ).ravel()


def errors(model: str, cell: Cell) -> tuple[FloatArray, FloatArray]:
    """Relative errors of equal and of unequal spheres."""
    springs = MODELS[model].loads["normal"](cell)
    with mp.workdps(DIGITS):
        truth = [REFERENCES[model](exact(cell, k)) for k in range(cell.shape[0])]
        error = [abs(float(v / t - 1)) for v, t in zip(springs.stiffness, truth, strict=True)]
    equal = cell.radius_i == cell.radius_j
    assert np.max(error) <= springs.relative_error, "the claimed bound does not hold"
    return np.array(error)[equal], np.array(error)[~equal]


def check(model: str, cell: Cell) -> None:
    equal, unequal = errors(model, cell)
    assert equal.size > 10
    assert unequal.size > 50
    assert equal.max() <= 1e-13
    assert unequal.max() <= 1e-12


@pytest.mark.parametrize("model", REFERENCES)
def test_required_range(model: str) -> None:
    check(model, cells(np.random.default_rng(20), 300))


@pytest.mark.slow
@pytest.mark.parametrize("model", REFERENCES)
def test_required_range_densely(model: str) -> None:
    check(model, cells(np.random.default_rng(21), 20_000))


def test_equal_spheres_on_a_full_grid() -> None:
    gap, young_i, young_j = np.meshgrid(GAPS, MODULI[::2], MODULI[1::2], indexing="ij")
    cell = Cell.from_values(
        radius_i=1.0,
        gap=gap,
        young_i=young_i,
        young_j=young_j,
        young_m=1.0,
        poisson_i=0.25,
        poisson_m=0.46,
    ).ravel()
    for model in REFERENCES:
        equal, unequal = errors(model, cell)
        assert equal.max() <= 1e-13
        assert not unequal.size


@pytest.mark.parametrize("ratio", [1e-9, 0.3, 0.99, 1 - 1e-12, 1.0])
def test_general_with_a_given_core(ratio: float) -> None:
    cell = cells(np.random.default_rng(22), 100)
    springs = MODELS["general"].loads["normal"](cell, core_radius_ratio=ratio)
    with mp.workdps(DIGITS):
        for k in range(cell.shape[0]):
            x = exact(cell, k)
            truth = exact_general(x, mpf(ratio) * x.small)
            assert abs(float(springs.stiffness[k] / truth - 1)) <= springs.relative_error


@pytest.mark.parametrize("ratio", [0.5, 1 - 1e-6, 1 - 1e-12])
def test_caps_of_a_core_nearly_as_wide_as_the_particle(ratio: float) -> None:
    cell = Cell.from_values(
        radius_i=1.0, gap=0.1, young_i=1.0, young_m=1.0, poisson_i=0.2, poisson_m=0.2
    )
    k_i = MODELS["general"].loads["normal"](cell, core_radius_ratio=ratio).parts["k_i"]
    with mp.workdps(DIGITS):
        truth = 2 * mp.pi * (1 - mp.sqrt(1 - mpf(ratio) ** 2))
        assert abs(float(mpf(float(k_i)) / truth - 1)) <= 1e-15


def test_parts_of_general_are_accurate_one_by_one() -> None:
    cell = cells(np.random.default_rng(23), 100)
    parts = MODELS["general"].loads["normal"](cell).parts
    with mp.workdps(DIGITS):
        for k in range(cell.shape[0]):
            x = exact(cell, k)
            core = exact_film_core(x)
            k_par = exact_generatrix(x, core)
            k_lr = mp.pi * x.matrix * core**2 / x.gap
            assert abs(float(parts["k_par"][k] / k_par - 1)) <= 1e-12
            assert abs(float(parts["k_lr"][k] / k_lr - 1)) <= 1e-14


def test_film_core_has_a_precise_complement() -> None:
    cell = cells(np.random.default_rng(24), 50)
    square, complement = film_core(cell)
    with mp.workdps(DIGITS):
        for k in range(cell.shape[0]):
            x = exact(cell, k)
            truth = (exact_film_core(x) / x.small) ** 2
            assert abs(float(square[k] / truth - 1)) < 1e-15
            assert abs(float(complement[k] / (1 - truth) - 1)) < 1e-15


@pytest.mark.parametrize(
    ("large", "small", "gap", "soft_large", "soft_small"),
    [
        ("1", "0.3", "1e-6", "0", "0"),
        ("1", "0.999", "1e-3", "0.5", "1e-4"),
        ("1", "0.01", "2", "1e-5", "0.9"),
        ("1", "0.8", "0.1", "1e5", "0.2"),
        ("1", "0.8", "1e-4", "3", "1e7"),
    ],
)
def test_partial_fractions_are_the_integral(
    large: str, small: str, gap: str, soft_large: str, soft_small: str
) -> None:
    """The reference of this file against plain quadrature of the definition."""
    with mp.workdps(30):
        x = Exact(mpf(large), mpf(small), mpf(gap), mpf(large), mpf(1), mpf(1), mpf(1))
        soft = mpf(soft_large), mpf(soft_small)

        def height(radius: mpf, r_square: mpf) -> mpf:
            return mp.sqrt(max(radius**2 - r_square, mpf(0)))

        def density(u: mpf) -> mpf:
            """In u = r^2, so that r dr = du/2."""
            h_large, h_small = height(x.large, u), height(x.small, u)
            matrix = x.length - h_large - h_small
            return 1 / (2 * (matrix + soft[0] * h_large + soft[1] * h_small))

        near_axis = [x.small**2 * mpf(2) ** -k for k in range(20, 0, -1)]
        near_rim = [x.small**2 * (1 - mpf(2) ** -k) for k in range(2, 44)]
        beside = [x.large**2 - (x.large**2 - x.small**2) * mpf(2) ** -k for k in range(1, 44)]
        points = [ZERO, *near_axis, *near_rim, x.small**2, *beside, x.large**2]
        assert lines(x, *soft) == pytest.approx(mp.quad(density, points, maxdegree=4), rel=1e-12)
