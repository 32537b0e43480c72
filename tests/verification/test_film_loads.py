"""Torsion, shear and bending of the film model against the reference, limits and closed forms."""

import numpy as np
import pytest

from bondcell.cell import Cell, FloatArray
from bondcell.fem import reference
from bondcell.models import MODELS
from bondcell.models.asked import ask
from bondcell.models.film import domain, lateral, lateral_particles
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
    ("load", "largest"), [("shear", 6e-3), ("torsion", 6e-3), ("bending", 6e-3)]
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
        assert np.all((error > -1e-4) & (error < 2 * largest))


@pytest.mark.parametrize("load", ["shear", "bending"])
def test_soft_particles(load: str) -> None:
    """The held planes at the rim of particles as soft as the matrix are the hard part."""
    cell = cells(gap=[[1e-3], [0.2]], young_i=[1.0, 3.0, 30.0], poisson_i=0.4, poisson_m=0.1)
    error = stiffness(cell, load) / stiffness(cell, load, "surrogate") - 1
    assert np.all((error > -1e-4) & (error < 0.025))


@pytest.mark.parametrize("load", ["shear", "bending"])
@pytest.mark.parametrize("poisson_m", [0.4999, 0.5])
def test_particles_give_way_to_an_incompressible_matrix(load: str, poisson_m: float) -> None:
    """Held as rigid they would be up to four times too stiff."""
    cell = cells(
        gap=[[1e-4], [1e-2], [0.5]], young_i=[10.0, 1e2, 1e4], poisson_i=0.3, poisson_m=poisson_m
    )
    error = stiffness(cell, load) / stiffness(cell, load, "surrogate") - 1
    assert np.all((error > -1e-4) & (error < 0.025))
    rigid = cells(gap=1e-4, young_i=np.inf, poisson_m=poisson_m)
    assert stiffness(rigid, load) > 2 * stiffness(cell, load)[0, 0]


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
        assert status.tolist() == [Status.ok, Status.ok]


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


class TestParticleFlows:
    """A particle's flow and its continuation have the same potentials and slopes on the sphere."""

    RADIUS, FAR = np.array([[0.7]]), np.array([0.05, 0.2, 0.35])[:, None, None]

    def at(self, distance: float) -> tuple[Jet, Jet]:
        angle = np.array([[0.02, 0.4, 1.0, 1.5]])
        return Jet.variables(distance * np.sin(angle), distance * np.cos(angle))

    def test_they_go_on_smoothly(self) -> None:
        r, z = self.at(0.7)
        own = lateral_particles.flow_potentials(r, z, self.RADIUS, self.FAR)
        shrink = self.RADIUS * (1.0 / (r * r + z * z).sqrt())
        square = shrink * shrink
        surface = lateral_particles.flow_potentials(r * shrink, z * shrink, self.RADIUS, self.FAR)
        inverted = lateral_particles.flow_potentials(r * square, z * square, self.RADIUS, self.FAR)
        for inside, a, b in zip(own, surface, inverted, strict=True):
            for f, g, h in zip(inside, a, b, strict=True):
                if f is not None:
                    assert (2.0 * g - h).parts[:3] == pytest.approx(f.parts[:3], rel=1e-9, abs=1e-9)

    def test_they_rest_on_the_end_plane_and_keep_their_volume(self) -> None:
        r, z = Jet.variables(np.array([[0.1, 0.6, 2.0]]), np.zeros((1, 3)))
        for q, p in lateral_particles.flow_potentials(r, z, self.RADIUS, self.FAR):
            for f in (q, p):
                if f is not None:
                    assert f.parts[:3] == pytest.approx(np.zeros((3, 1, 3)), abs=1e-14)
        r, z = self.at(1.1)
        rows = lateral._currents(r, z, z * 0.0 + 1.0, self.RADIUS, self.FAR, 1.0)
        size = np.abs(rows).max()
        assert rows[:3].sum(axis=0) == pytest.approx(np.zeros(rows.shape[1:]), abs=1e-12 * size)

    def test_least_energy_over_the_last_fields(self) -> None:
        root = np.random.default_rng(1).normal(size=(2, 7, 7))
        matrix = root @ root.swapaxes(-1, -2)
        reduced = lateral_particles._without_last(matrix.copy(), 3)
        exact = np.linalg.inv(np.linalg.inv(matrix)[:, :4, :4])
        assert reduced == pytest.approx(exact, rel=1e-8)
