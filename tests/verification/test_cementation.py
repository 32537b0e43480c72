"""The cementation theory against closed limits, published polynomials and finer rings."""

import numpy as np
import pytest

from bondcell.cell import Cell
from bondcell.models.cementation import normal, oedometric_modulus
from bondcell.models.elastic_foundation import RELATIVE_ERROR, compliance_factor, operators

GAPS = 10.0 ** np.arange(-12, 7)[:, None]
FLEXIBILITIES = 10.0 ** np.arange(-12, 13)


def published_stiffness(shear_modulus_ratio: float, alpha: float, poisson: float) -> float:
    """K_n / (pi R M) by Dvorkin and Nur's polynomials, for equal grains in contact."""
    lam = 2 * shear_modulus_ratio / np.pi * (1 - poisson) * (1 - poisson) / (1 - 2 * poisson)
    return (
        -0.024153 * lam**-1.3646 * alpha**2
        + 0.20405 * lam**-0.89008 * alpha
        + 0.00024649 * lam**-1.9864
    )


@pytest.mark.parametrize("alpha", [0.1, 0.3, 1.0])
@pytest.mark.parametrize("lam", [0.1, 0.3, 1.0])
def test_published_polynomials_in_their_range(lam: float, alpha: float) -> None:
    poisson = 0.2
    ratio = lam * np.pi / 2 * (1 - 2 * poisson) / (1 - poisson) ** 2
    cell = Cell.from_values(
        radius_i=1.0, gap=1e-12, young_i=1.0, young_m=ratio, poisson_i=poisson, poisson_m=poisson
    )
    stiffness = normal(cell, cement_radius_ratio=alpha).stiffness
    unit = np.pi * oedometric_modulus(cell.young_m, cell.poisson_m)
    assert stiffness / unit == pytest.approx(published_stiffness(ratio, alpha, poisson), rel=0.05)


def test_polynomials_fail_for_a_bitumen() -> None:
    """Why the equation is solved: at Lambda_n = 1e-4 the polynomials are off a thousandfold."""
    poisson = 0.2
    ratio = 1e-4 * np.pi / 2 * (1 - 2 * poisson) / (1 - poisson) ** 2
    cell = Cell.from_values(
        radius_i=1.0, gap=1e-12, young_i=1.0, young_m=ratio, poisson_i=poisson, poisson_m=poisson
    )
    unit = np.pi * oedometric_modulus(cell.young_m, cell.poisson_m)
    published = published_stiffness(ratio, 1.0, poisson)
    assert published / (normal(cell).stiffness / unit) > 1000


def test_rigid_grains_are_a_logarithm() -> None:
    gap = GAPS.ravel()
    error = compliance_factor(gap, np.zeros(())) / (0.5 * np.log1p(1 / gap)) - 1
    assert np.all(error <= 1e-12)
    assert np.all(error >= -RELATIVE_ERROR)


def test_stiff_cement_is_a_rigid_punch() -> None:
    """K of a flat punch between half-spaces, a / (sum of (1 - nu^2)/(2 E))."""
    cell = Cell.from_values(
        radius_i=1.0,
        gap=1e-6,
        young_i=1.0,
        young_j=3.0,
        young_m=1e12,
        poisson_i=0.1,
        poisson_j=0.3,
        poisson_m=0.2,
    )
    punch = 0.2 / ((1 - 0.1**2) / 2 + (1 - 0.3**2) / (2 * 3.0))
    error = normal(cell, cement_radius_ratio=0.2).stiffness / punch - 1
    assert -RELATIVE_ERROR <= error <= 1e-9


def test_stiffness_rises_to_its_limit_within_the_claimed_error() -> None:
    """Trial tractions give a lower bound; a finer set comes closer from below."""
    finer = operators(ratio=0.6, edge_rings=6, degree=4)
    gap, flexibility = GAPS[::3], FLEXIBILITIES[::3]
    error = compliance_factor(gap, flexibility) / compliance_factor(gap, flexibility, finer)
    assert np.max(error) <= 1 + 1e-9
    assert np.min(error) >= 1 - RELATIVE_ERROR
    assert np.min(error) <= 1 - RELATIVE_ERROR / 10, "the claim is needlessly loose"


def test_bounded_by_both_of_its_limits() -> None:
    """Neither a rigid layer nor rigid grains are softer than the pair."""
    value = compliance_factor(GAPS, FLEXIBILITIES)
    layer = 0.5 * np.log1p(1 / GAPS)
    half_spaces = 4 / np.pi**2 / FLEXIBILITIES
    assert np.all(value <= layer * (1 + 1e-12))
    assert np.all(value <= half_spaces * (1 + 1e-9))


def test_uniform_tractions_settle_as_known() -> None:
    """A uniform pressure on a disk does the work (16/3) a^3 p^2 (1 - nu^2)/E on a half-space."""
    matrices = operators()
    ones = np.zeros(matrices.resultant.size)
    start = 0
    for size in [1] + [3] * ((matrices.resultant.size - 1) // 3):
        ones[start] = 1.0  # the constant is each ring's first trial traction
        start += size
    assert ones @ matrices.resultant == pytest.approx(0.5, rel=1e-14)
    assert ones @ matrices.uniform @ ones == pytest.approx(0.5, rel=1e-14)
    assert ones @ matrices.parabolic @ ones == pytest.approx(0.25, rel=1e-14)
    # 8 pi times the integral of q^2, q = sqrt(1 - t^2), is 16 pi / 3
    assert ones @ matrices.half_spaces @ ones == pytest.approx(2.0 / 3.0, rel=1e-10)
