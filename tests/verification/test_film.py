"""The film model against closed forms, bounds and the finite element reference."""

import numpy as np
import pytest

from bondcell.cell import Cell, FloatArray
from bondcell.fem import reference
from bondcell.models import MODELS
from bondcell.models.asked import ask
from bondcell.models.film import domain, loads
from bondcell.status import Status

BASE = {"radius_i": 1.0, "young_m": 1.0, "poisson_i": 0.25}


def cells(**values: object) -> Cell:
    return Cell.from_values(**{**BASE, **values})


def stiffness(cell: Cell, model: str = "film") -> FloatArray:
    return MODELS[model].loads["normal"](cell).stiffness


def equal_pairs(count: int, seed: int, largest_gap: float = 0.0) -> Cell:
    """Random equal pairs, gap/R from 1e-4, E_i/E_m from 1 to 1e6."""
    draw = np.random.default_rng(seed).uniform
    return cells(
        gap=10 ** draw(-4, largest_gap, count),
        young_i=10 ** draw(0, 6, count),
        poisson_i=draw(0, 0.45, count),
        poisson_m=np.where(draw(size=count) < 0.1, 0.5, draw(0, 0.5, count)),
    )


def unequal_pairs(count: int, seed: int) -> Cell:
    """Random radii within a factor of 5, moduli, cylinders up to three radii wide."""
    draw = np.random.default_rng(seed).uniform
    radius = 10 ** draw(-0.7, 0, count)
    return cells(
        radius_j=radius,
        gap=radius * 10 ** draw(-4, 0, count),
        cylinder_radius=np.where(draw(size=count) < 0.5, 1.0, draw(1, 3, count)),
        young_i=10 ** draw(0, 6, count),
        young_j=10 ** draw(0, 6, count),
        poisson_i=draw(0, 0.45, count),
        poisson_j=draw(0, 0.45, count),
        poisson_m=np.where(draw(size=count) < 0.1, 0.5, draw(0, 0.5, count)),
    )


class TestAccuracy:
    def test_equal_pairs(self) -> None:
        cell = equal_pairs(150, seed=11)
        error = stiffness(cell) / stiffness(cell, "surrogate") - 1
        assert error.max() < 0.012
        assert np.median(error) < 1.5e-3
        assert error.min() > -1e-4

    def test_unequal_pairs(self) -> None:
        cell = unequal_pairs(8, seed=12)
        parts = [reference.solve(cell.ravel().take([k]), tolerance=1e-4) for k in range(8)]
        exact = np.concatenate([part.stiffness for part in parts])
        bounds = MODELS["bounds"].loads["normal"](cell)
        assert np.all(bounds.parts["lower"] <= exact)
        assert np.all(exact <= bounds.parts["upper"])
        assert np.all(np.abs(exact / bounds.stiffness - 1) <= bounds.relative_error)
        assert np.all(stiffness(cell) <= 1.03 * exact)

    def test_base_case(self) -> None:
        cell = cells(radius_i=7.5e-3, gap=5e-4, young_i=3e10, young_m=1.4e6, poisson_m=0.46)
        assert stiffness(cell) == pytest.approx(162460.7672, rel=2e-3)

    @pytest.mark.parametrize("gap", [3.0, 10.0, 1e3])
    def test_long_gaps_are_bars(self, gap: float) -> None:
        cell = cells(
            gap=np.full(4, gap), young_i=[1, 10, 1e4, np.inf], poisson_m=[0.0, 0.3, 0.4, 0.5]
        )
        exact = reference.solve(cell.ravel(), tolerance=1e-4).stiffness
        assert stiffness(cell) == pytest.approx(exact, rel=2e-3)

    def test_quadrature(self, monkeypatch: pytest.MonkeyPatch) -> None:
        """The claimed error holds against a rule of twice as many points each way."""
        cell, other = equal_pairs(12, seed=13), unequal_pairs(6, seed=14)
        usual = [stiffness(one) for one in (cell, other)]
        monkeypatch.setattr(domain, "RADIAL_POINTS", 10)
        monkeypatch.setattr(domain, "AXIAL_POINTS", 12)
        monkeypatch.setattr(domain, "OUTER_PANELS", 6)
        for value, one in zip(usual, (cell, other), strict=True):
            assert value == pytest.approx(stiffness(one), rel=loads.RELATIVE_ERROR)


class TestLimits:
    def test_homogeneous_cylinder(self) -> None:
        cell = cells(
            radius_j=[1.0, 0.4],
            gap=[[1e-3], [0.5]],
            young_i=1.0,
            cylinder_radius=1.3,
            poisson_m=0.25,
        )
        assert stiffness(cell) == pytest.approx(np.pi * 1.3**2 / cell.length, rel=1e-5)

    @pytest.mark.parametrize(("radius_j", "curvature"), [(1.0, 0.5), (0.5, 1 / 3)])
    def test_lubrication(self, radius_j: float, curvature: float) -> None:
        """Rigid spheres on an incompressible film: 6 pi mu R*^2 / L_g."""
        gap = np.array([1e-4, 1e-5])
        cell = cells(gap=gap, radius_j=radius_j, young_i=np.inf, poisson_m=0.5)
        excess = stiffness(cell) / (6 * np.pi / 3 * curvature**2 / gap) - 1
        assert np.all(np.abs(excess) < [5e-3, 1e-3])

    @pytest.mark.parametrize("poisson", [0.0, 0.3])
    def test_logarithm(self, poisson: float) -> None:
        """Rigid spheres, compressible film: pi R M ln(1/L_g) with the oedometric modulus M."""
        cell = cells(gap=[1e-7, 1e-5], young_i=np.inf, poisson_m=poisson)
        modulus = (1 - poisson) / ((1 + poisson) * (1 - 2 * poisson))
        narrow, wide = stiffness(cell)
        assert (narrow - wide) / np.log(100) == pytest.approx(np.pi * modulus, rel=5e-3)

    def test_fsi_without_poisson_effect(self) -> None:
        """What FSI misses at nu_m = 0 and rigid particles stays bounded as both grow."""
        cell = cells(gap=[1e-7, 1e-5, 1e-3], young_i=np.inf, poisson_m=0.0)
        missing = stiffness(cell) - stiffness(cell, "fsi")
        assert np.all((missing > 0) & (missing < 0.6))
        assert np.ptp(missing) < 0.05


class TestLaws:
    def test_swapping_the_particles(self) -> None:
        cell = unequal_pairs(10, seed=15)
        assert stiffness(cell.swapped()) == pytest.approx(stiffness(cell), rel=1e-9)

    def test_dimensions(self) -> None:
        cell = unequal_pairs(4, seed=16)
        lengths = ("radius_i", "radius_j", "gap", "cylinder_radius")
        values = {
            name: value * (1e-3 if name in lengths else 1e7 if "young" in name else 1)
            for name, value in cell.as_dict().items()
        }
        assert stiffness(Cell.from_values(**values)) == pytest.approx(
            1e4 * stiffness(cell), rel=1e-9
        )

    def test_one_by_one_or_together(self) -> None:
        cell = cells(gap=[[1e-3], [0.1], [2.0]], young_i=[1.0, 30.0, np.inf], poisson_m=0.4)
        whole = stiffness(cell)
        assert whole.shape == (3, 3)
        flat = cell.ravel()
        for k in range(9):
            assert stiffness(flat.take([k])) == pytest.approx(whole.ravel()[k], rel=1e-9)

    def test_rigid_is_the_limit_of_stiff(self) -> None:
        for radius in (1.0, 0.6):
            cell = cells(
                gap=0.01, radius_j=radius, young_i=[1e12, np.inf], poisson_m=[[0.2], [0.5]]
            )
            stiff, rigid = stiffness(cell).T
            assert stiff == pytest.approx(rigid, rel=1e-6)
            assert np.all(stiff <= rigid * (1 + 1e-12))

    def test_near_incompressible_is_continuous(self) -> None:
        cell = cells(
            gap=[[1e-3], [0.1]], young_i=1e4, poisson_m=0.5 - np.array([1e-12, 1e-9, 1e-7, 0])
        )
        value = stiffness(cell)
        assert value[:, :3] == pytest.approx(value[:, 3:] * np.ones(3), rel=1e-3)


def test_extremes_are_right_or_flagged() -> None:
    cell = cells(
        gap=np.array([1e-8, 1e-4, 1.0, 1e3])[:, None, None],
        young_i=np.array([1e-8, 1e-2, 1.0, 1e4, 1e12])[:, None],
        poisson_m=[0.0, 0.3, 0.4999999, 0.5],
    )
    springs, status = ask(MODELS["film"], "normal", cell)
    assert np.all(np.isfinite(springs.stiffness) & (springs.stiffness > 0))
    lower = stiffness(cell, "generatrix")
    assert np.all(springs.stiffness >= lower * (1 - 2e-4))
    good = np.broadcast_to((cell.gap > 1e-5) & (cell.young_i >= 1), cell.shape)
    assert np.array_equal(status == Status.ok, good)


@pytest.mark.parametrize(
    ("name", "load"),
    [("film", "normal"), ("film", "torsion"), ("film", "shear"), ("film", "bending"),
     ("bounds", "normal"), ("bounds", "torsion")],
)  # fmt: skip
def test_gaps_too_small_for_any_computer_are_flagged(name: str, load: str) -> None:
    """The points of a plane's quadrature grow with the gap's logarithm squared."""
    cell = cells(gap=[1e-2, 1e-17, 1e-300, 1e-1], young_i=1e4, poisson_m=0.4)
    springs, status = ask(MODELS[name], load, cell)
    assert status.tolist() == [Status.ok, Status.not_computed, Status.not_computed, Status.ok]
    alone, _ = ask(MODELS[name], load, cell.ravel().take(np.array([0, 3])))
    np.testing.assert_allclose(springs.stiffness[[0, 3]], alone.stiffness, rtol=1e-12)
