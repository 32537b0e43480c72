"""Torsion, shear and bending of the film model against the reference, limits and closed forms."""

import numpy as np
import pytest

from bondcell.cell import Cell, FloatArray
from bondcell.fem import reference
from bondcell.models import MODELS
from bondcell.models.asked import ask
from bondcell.models.film import domain, lateral_particles
from bondcell.models.film.loads import RELATIVE_ERROR
from bondcell.models.film.one_wave import Field, strains, stream_strains
from bondcell.models.jets import Jet
from bondcell.status import Status

BASE = {"radius_i": 1.0, "young_m": 1.0, "poisson_i": 0.25}
LOADS = ("shear", "torsion", "bending")


def cells(**values: object) -> Cell:
    return Cell.from_values(**{**BASE, **values})


def stiffness(cell: Cell, load: str, model: str = "film") -> FloatArray:
    return MODELS[model].loads[load](cell).stiffness


def equal_pairs(count: int, seed: int) -> Cell:
    draw = np.random.default_rng(seed).uniform
    return cells(
        gap=10 ** draw(-4, 0, count),
        young_i=10 ** draw(2, 6, count),
        poisson_i=draw(0, 0.45, count),
        poisson_m=draw(0, 0.499, count),
    )


def unequal_pairs(count: int, seed: int) -> Cell:
    draw = np.random.default_rng(seed).uniform
    radius = 10 ** draw(-0.7, 0, count)
    return cells(
        radius_j=radius,
        gap=radius * 10 ** draw(-3, 0, count),
        young_i=10 ** draw(2, 6, count),
        young_j=10 ** draw(2, 6, count),
        poisson_j=draw(0, 0.45, count),
        poisson_m=draw(0, 0.499, count),
    )


@pytest.mark.parametrize(
    ("load", "largest"), [("shear", 0.02), ("torsion", 6e-3), ("bending", 0.02)]
)
class TestAccuracy:
    def test_equal_pairs(self, load: str, largest: float) -> None:
        cell = equal_pairs(32, seed=21)
        error = stiffness(cell, load) / stiffness(cell, load, "surrogate") - 1
        assert error.max() < largest
        assert np.median(error) < largest / 3
        assert error.min() > -1e-4

    def test_unequal_pairs(self, load: str, largest: float) -> None:
        cell = unequal_pairs(3, seed=22)
        parts = [
            reference.solve(cell.ravel().take([k]), load=load, tolerance=1e-4) for k in range(3)
        ]
        error = stiffness(cell, load) / np.concatenate([part.stiffness for part in parts]) - 1
        assert np.all((error > -2e-4) & (error < 1.5 * largest))


@pytest.mark.parametrize("load", ["shear", "bending"])
def test_soft_particles(load: str) -> None:
    """The held planes at the rim of particles as soft as the matrix are the hard part."""
    cell = cells(gap=[[1e-3], [0.2]], young_i=[1.0, 3.0, 30.0], poisson_i=0.4, poisson_m=0.1)
    error = stiffness(cell, load) / stiffness(cell, load, "surrogate") - 1
    assert np.all((error > -2e-4) & (error < 0.06))


@pytest.mark.parametrize("load", LOADS)
class TestLaws:
    def test_swapping_the_particles(self, load: str) -> None:
        """Bending turns plane j alone, so it is no law of bending between unequal particles."""
        cell = cells(
            gap=0.03, radius_j=1.0 if load == "bending" else 0.6, young_i=1e3, poisson_m=0.4
        )
        assert stiffness(cell.swapped(), load) == pytest.approx(stiffness(cell, load), rel=1e-8)

    def test_rigid_is_the_limit_of_stiff(self, load: str) -> None:
        cell = cells(gap=0.01, radius_j=0.7, young_i=[1e13, np.inf], poisson_m=0.3)
        stiff, rigid = stiffness(cell, load)
        assert stiff == pytest.approx(rigid, rel=1e-5)

    def test_dimensions(self, load: str) -> None:
        power = 1 if load == "shear" else 3
        small = Cell.from_values(
            radius_i=7.5e-3, gap=7.5e-5, young_i=7e9, young_m=7e6, poisson_i=0.25, poisson_m=0.3
        )
        unit = stiffness(cells(gap=0.01, young_i=1e3, poisson_m=0.3), load)
        assert stiffness(small, load) == pytest.approx(7e6 * 7.5e-3**power * unit, rel=1e-9)

    def test_quadrature(self, load: str, monkeypatch: pytest.MonkeyPatch) -> None:
        cell = cells(gap=[1e-3, 0.3], radius_j=[1.0, 0.5], young_i=1e3, poisson_m=0.4)
        usual = stiffness(cell, load)
        monkeypatch.setattr(domain, "RADIAL_POINTS", 10)
        monkeypatch.setattr(domain, "AXIAL_POINTS", 10)
        monkeypatch.setattr(lateral_particles, "DEPTH_POINTS", 12)
        assert usual == pytest.approx(stiffness(cell, load), rel=RELATIVE_ERROR)

    def test_flags(self, load: str) -> None:
        cell = cells(gap=[0.1, 1e-7, 10.0], young_i=1e4, poisson_m=0.3)
        _, status = ask(MODELS["film"], load, cell)
        long = Status.ok if load == "torsion" else Status.not_computed
        assert status.tolist() == [Status.ok, Status.outside_valid_range, long]
        _, status = ask(MODELS["film"], load, cells(gap=0.1, young_i=[1e3, np.inf], poisson_m=0.5))
        limp = Status.ok if load == "torsion" else Status.outside_valid_range
        assert status.tolist() == [limp, Status.ok]


def test_a_homogeneous_cylinder_twists_uniformly() -> None:
    cell = cells(
        gap=[0.01, 2.0, 50.0], radius_j=0.7, young_i=1.0, cylinder_radius=1.2, poisson_m=0.25
    )
    exact = np.pi / 2 * 1.2**4 / 2.5 / cell.length
    assert stiffness(cell, "torsion") == pytest.approx(exact, rel=1e-5)


@pytest.mark.parametrize(
    ("load", "poisson", "slope"),
    [("shear", 0.0, 1.0), ("shear", 0.5, 1.0), ("bending", 0.3, 1.0), ("bending", 0.5, 1.6)],
)
def test_logarithms(load: str, poisson: float, slope: float) -> None:
    """Rigid spheres: pi mu R ln(1/L_g) of sliding, and 0.6 pi mu R^3 more in a film shut in.

    Sliding: mu/h over the film. Turning moves the wedge like a closing ``psi r cos t``; Reynolds'
    equation for h = r^2/R has the pressure ``1.2 mu psi (R/r)^3 cos t``, whose work is ``1.2 pi``
    times the logarithm of the film's width, sqrt(L_g R).
    """
    cell = cells(gap=[1e-7, 1e-5], young_i=np.inf, poisson_m=poisson)
    narrow, wide = stiffness(cell, load)
    measured = (narrow - wide) / np.log(100) * 2 * (1 + poisson) / np.pi
    assert measured == pytest.approx(slope, rel=1e-2)


@pytest.mark.parametrize("load", LOADS)
def test_base_case(load: str) -> None:
    exact = {"shear": 29585.863, "torsion": 0.52187948, "bending": 2.58039356}[load]
    cell = cells(radius_i=7.5e-3, gap=5e-4, young_i=3e10, young_m=1.4e6, poisson_m=0.46)
    assert stiffness(cell, load) == pytest.approx(exact, rel=5e-3)
    assert stiffness(cell, load) > exact


class TestStrains:
    R, Z = np.array([0.7]), np.array([1.2])

    def parts(self) -> tuple[Jet, Jet, Jet, Jet]:
        r, z = Jet.variables(self.R, self.Z)
        q = (r * r + z).log() * z
        return r, z, q, (r * r * 0.3 + z * z).sqrt()

    def test_flows_without_divergence(self) -> None:
        """alpha, beta, omega of the potentials, by their own strains."""
        _, _, q, p = self.parts()

        def slope(f: Jet, order: tuple[int, int, int]) -> Jet:
            value, d_r, d_z = (f.parts[k] for k in order)
            none = np.zeros_like(value)
            return Jet(np.stack([value, d_r, d_z, none, none, none]))

        r = self.R
        value = 4 * p.parts[0] + r * p.parts[1] + q.parts[1] / r
        d_r = 5 * p.parts[1] + r * p.parts[3] + q.parts[3] / r - q.parts[1] / r**2
        d_z = 4 * p.parts[2] + r * p.parts[4] + q.parts[4] / r
        none = np.zeros_like(value)
        omega = Jet(np.stack([value, d_r, d_z, none, none, none]))
        field = Field(-slope(p, (2, 4, 5)), -slope(q, (2, 4, 5)), omega)
        expected = strains(field, r)
        got = stream_strains(q, None, r) + stream_strains(None, p, r)
        assert got == pytest.approx(expected, rel=1e-12)
        assert got[:3].sum() == pytest.approx(0.0, abs=1e-13)

    def test_rigid_motions(self) -> None:
        _, z = Jet.variables(self.R, self.Z)
        one = z * 0.0 + 1.0
        for field in (Field(None, one, None), Field(None, z, -one)):
            assert strains(field, self.R) == pytest.approx(np.zeros((6, 1)), abs=1e-15)
