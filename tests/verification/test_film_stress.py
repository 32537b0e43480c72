"""Trial stresses of the lower bound: equilibrium, boundary conditions, bound."""

import numpy as np
import pytest

from bondcell.cell import Cell, FloatArray
from bondcell.fem import reference
from bondcell.models import MODELS
from bondcell.models.film import domain, stress, stress_torsion
from bondcell.models.film.domain import Geometry
from bondcell.models.film.stress import RELATIVE_ERROR, stresses
from bondcell.models.jets import Jet

GEOMETRY = Geometry(*(np.array([[x]]) for x in (1.0, 0.6, 0.1, 1.4)), mirrored=False)


def bounds(cell: Cell, load: str = "normal") -> tuple[FloatArray, FloatArray, FloatArray]:
    springs = MODELS["bounds"].loads[load](cell)
    half = np.broadcast_to(springs.relative_error, cell.shape)
    return springs.parts["lower"], springs.parts["upper"], half


def test_stresses_balance_themselves() -> None:
    """Differences of the stresses of two functions: both equations of equilibrium."""

    def at(r: float, z: float) -> FloatArray:
        x, y = Jet.variables(np.array([r]), np.array([z]))
        q, p = (x * x + y).log() * y, (x * x * 0.3 + y * y).sqrt() * y
        return stresses(q, p, x.value)[:, 0]

    r, z, step = 0.7, 0.4, 1e-5
    by_r = (at(r + step, z) - at(r - step, z)) / (2 * step)
    by_z = (at(r, z + step) - at(r, z - step)) / (2 * step)
    s_rr, s_tt, s_zz, s_rz = at(r, z)
    assert by_r[0] + by_z[3] + (s_rr - s_tt) / r == pytest.approx(0, abs=1e-8)
    assert by_r[3] + by_z[2] + s_rz / r == pytest.approx(0, abs=1e-8)
    assert abs(s_zz) > 0.1


def sphere_traces(radius: float, angle: FloatArray, outside: bool) -> FloatArray:
    """Stresses of the traces on sphere i, fading into the matrix or into the particle."""
    r, z = Jet.variables(radius * np.sin(angle), radius * np.cos(angle))
    square = (r * r + z * z) * (1 / radius**2)
    phi = (square - 1.0) * (radius / 2)
    # To first order at the sphere, 1 - S is 1.
    fade = square * 0.0 + 1.0 if outside else square * square * (3.0 - 2.0 * square)
    if outside:
        fade = fade - phi * phi * 3.0
    return stress._traces(r, z, phi, fade, np.array([[radius]]), GEOMETRY)


@pytest.mark.parametrize("radius", [1.0, 0.6])
def test_tractions_pass_the_sphere(radius: float) -> None:
    angle = np.array([[0.01, 0.5, 1.2, 1.5]])
    sine, cosine = np.sin(angle), np.cos(angle)
    pulls = []
    for outside in (True, False):
        s_rr, _, s_zz, s_rz = sphere_traces(radius, angle, outside)
        pulls.append((s_rr * sine + s_rz * cosine, s_rz * sine + s_zz * cosine))
    for one, other in zip(*pulls, strict=True):
        assert one == pytest.approx(other, rel=1e-9, abs=1e-9)
        assert np.abs(one).max() > 0.1


def test_plates_have_no_friction_and_sides_are_free() -> None:
    r = np.array([[0.1, 0.5, 0.9, 1.4]])
    one = np.array([[1.0]])
    x, z = Jet.variables(r, np.zeros_like(r))
    square = x * x + z * z
    phi = (square - 1.0) * 0.5
    fade = square * square * (3.0 - 2.0 * square)
    for trial in (
        stress._traces(x, z, phi, fade, one, GEOMETRY),
        stress._lines(x, GEOMETRY),
    ):
        assert trial[3] == pytest.approx(np.zeros(trial[3].shape), abs=1e-12)
        assert trial[0, ..., -1] == pytest.approx(np.zeros(trial.shape[1:3]), abs=1e-12)


def test_the_first_stress_carries_a_unit_force() -> None:
    node, weight = np.polynomial.legendre.leggauss(40)
    r = (1.4 * (node + 1) / 2)[None]
    x, _ = Jet.variables(r, np.zeros_like(r))
    axial = stress._lines(x, GEOMETRY)[2]
    force = (axial * 2 * np.pi * r * weight * 0.7).sum(axis=-1)[:, 0]
    assert force[0] == pytest.approx(1.0, rel=1e-12)
    assert force[1:] == pytest.approx(np.zeros(force.size - 1), abs=1e-9)


def equal_pairs(count: int, seed: int) -> Cell:
    draw = np.random.default_rng(seed).uniform
    return Cell.from_values(
        radius_i=1.0,
        gap=10 ** draw(-3, 0, count),
        young_i=10 ** draw(0, 7, count),
        young_m=1.0,
        poisson_i=draw(0, 0.45, count),
        poisson_m=np.where(draw(size=count) < 0.1, 0.5, draw(0, 0.5, count)),
    )


def unequal_pairs(count: int, seed: int) -> Cell:
    draw = np.random.default_rng(seed).uniform
    radius = 10 ** draw(-0.7, 0, count)
    return Cell.from_values(
        radius_i=1.0,
        radius_j=radius,
        gap=radius * 10 ** draw(-3, 0, count),
        cylinder_radius=np.where(draw(size=count) < 0.5, 1.0, draw(1, 3, count)),
        young_i=10 ** draw(0, 7, count),
        young_j=10 ** draw(0, 7, count),
        young_m=1.0,
        poisson_i=draw(0, 0.45, count),
        poisson_j=draw(0, 0.45, count),
        poisson_m=np.where(draw(size=count) < 0.1, 0.5, draw(0, 0.5, count)),
    )


def test_equal_pairs() -> None:
    cell = equal_pairs(60, seed=41)
    lower, upper, half = bounds(cell)
    exact = MODELS["surrogate"].loads["normal"](cell).stiffness
    assert np.all(lower <= exact * (1 + 4e-5))
    assert np.all(exact * (1 - 4e-5) <= upper)
    assert np.median(half) < 2e-3
    assert half.max() < 0.06


def test_unequal_pairs() -> None:
    cell = unequal_pairs(8, seed=42)
    parts = [reference.solve(cell.ravel().take([k]), tolerance=1e-4) for k in range(8)]
    exact = np.concatenate([part.stiffness for part in parts])
    lower, upper, half = bounds(cell)
    assert np.all(lower <= exact)
    assert np.all(exact <= upper)
    assert np.median(half) < 0.02


def test_base_case() -> None:
    cell = Cell.from_values(
        radius_i=7.5e-3, gap=5e-4, young_i=3e10, young_m=1.4e6, poisson_i=0.25, poisson_m=0.46
    )
    lower, upper, half = bounds(cell)
    assert lower < 162460.7672 < upper
    assert half < 1.2e-3


def test_a_homogeneous_cylinder_is_exact() -> None:
    cell = Cell.from_values(
        radius_i=1.0,
        radius_j=[1.0, 0.4],
        gap=[[1e-3], [0.5]],
        young_i=1.0,
        young_m=1.0,
        cylinder_radius=1.3,
        poisson_i=0.25,
        poisson_m=0.25,
    )
    lower, _, _ = bounds(cell)
    exact = np.pi * 1.3**2 / cell.length
    assert np.all(lower <= exact)
    assert lower == pytest.approx(exact, rel=1.1 * RELATIVE_ERROR)


def test_quadrature(monkeypatch: pytest.MonkeyPatch) -> None:
    """The claimed error holds against a rule of more points each way."""
    cells = (equal_pairs(5, seed=43), unequal_pairs(3, seed=44))
    usual = [bounds(cell)[0] for cell in cells]
    monkeypatch.setattr(stress, "MATRIX_POINTS", (14, 13))
    monkeypatch.setattr(domain, "OUTER_PANELS", 6)
    monkeypatch.setattr(stress, "DEPTH_POINTS", 16)
    for value, cell in zip(usual, cells, strict=True):
        assert value == pytest.approx(bounds(cell)[0], rel=RELATIVE_ERROR)


def test_rigid_is_the_limit_of_stiff() -> None:
    cell = Cell.from_values(
        radius_i=1.0,
        radius_j=[[1.0], [0.6]],
        gap=0.02,
        young_i=[1e12, np.inf],
        young_m=1.0,
        poisson_i=0.25,
        poisson_m=0.45,
    )
    stiff, rigid = bounds(cell)[0].T
    assert stiff == pytest.approx(rigid, rel=1e-6)


def test_many_materials_or_few() -> None:
    """Reduction lowers the lower bound, by no more than its tolerance."""
    ratio = np.geomspace(1, 1e8, 25)[:, None]
    cell = Cell.from_values(
        radius_i=1.0,
        gap=0.05,
        young_i=ratio,
        young_m=1.0,
        poisson_i=0.25,
        poisson_m=np.linspace(0, 0.49, 25),
    )
    together = bounds(cell)[0].ravel()
    some = np.arange(0, 625, 31)
    alone = bounds(cell.ravel().take(some))[0]
    assert np.all(together[some] <= alone * (1 + 1e-7))
    assert together[some] == pytest.approx(alone, rel=1.1e-5)


@pytest.mark.parametrize("load", ["normal", "torsion"])
def test_the_ends_do_not_cross(load: str) -> None:
    """Long and short gaps, one material and rigid particles, nu = 1/2 everywhere and nu_m = 0."""
    cell = Cell.from_values(
        radius_i=1.0,
        radius_j=[1.0, 0.5],
        gap=np.array([1e-6, 1e-2, 1.0, 2.9, 50.0])[:, None],
        young_i=np.array([1.0, 1e3, np.inf])[:, None, None],
        young_m=1.0,
        poisson_i=0.5,
        poisson_m=np.array([0.0, 0.5])[:, None, None, None],
    )
    lower, upper, _ = bounds(cell, load)
    assert np.all((lower > 0) & (lower <= upper))


class TestTorsion:
    def test_equal_pairs(self) -> None:
        cell = equal_pairs(40, seed=45)
        lower, upper, half = bounds(cell, "torsion")
        exact = MODELS["surrogate"].loads["torsion"](cell).stiffness
        assert np.all(lower <= exact * (1 + 4e-5))
        assert np.all(exact * (1 - 4e-5) <= upper)
        assert half.max() < 4e-3

    def test_unequal_pairs(self) -> None:
        cell = unequal_pairs(6, seed=46)
        parts = [
            reference.solve(cell.ravel().take([k]), load="torsion", tolerance=1e-5)
            for k in range(6)
        ]
        exact = np.concatenate([part.stiffness for part in parts])
        lower, upper, half = bounds(cell, "torsion")
        assert np.all(lower <= exact)
        assert np.all(exact <= upper)
        assert np.median(half) < 5e-3

    def test_stresses_balance_themselves(self) -> None:
        """``(r^2 s_rt)_r/r^2 + (s_zt)_z = 0``."""

        def at(r: float, z: float) -> FloatArray:
            x, y = Jet.variables(np.array([r]), np.array([z]))
            return stress_torsion._shear((x * x + y).log() * y, x.value)[:, 0]

        r, z, step = 0.7, 0.4, 1e-5
        by_r = (at(r + step, z) - at(r - step, z)) / (2 * step)
        by_z = (at(r, z + step) - at(r, z - step)) / (2 * step)
        assert by_r[0] + 2 * at(r, z)[0] / r + by_z[1] == pytest.approx(0, abs=1e-8)
        assert abs(by_z[1]) > 0.1

    def test_a_homogeneous_cylinder_is_exact(self) -> None:
        cell = Cell.from_values(
            radius_i=1.0,
            radius_j=[1.0, 0.4],
            gap=0.05,
            young_i=1.0,
            young_m=1.0,
            cylinder_radius=1.3,
            poisson_i=0.25,
            poisson_m=0.25,
        )
        lower, _, _ = bounds(cell, "torsion")
        exact = np.pi / 2 * 1.3**4 / 2.5 / cell.length
        assert np.all(lower <= exact)
        assert lower == pytest.approx(exact, rel=1.1 * RELATIVE_ERROR)

    def test_quadrature(self, monkeypatch: pytest.MonkeyPatch) -> None:
        cells = (equal_pairs(4, seed=47), unequal_pairs(3, seed=48))
        usual = [bounds(cell, "torsion")[0] for cell in cells]
        monkeypatch.setattr(stress_torsion, "MATRIX_POINTS", (14, 13))
        monkeypatch.setattr(domain, "OUTER_PANELS", 6)
        monkeypatch.setattr(stress, "DEPTH_POINTS", 16)
        for value, cell in zip(usual, cells, strict=True):
            assert value == pytest.approx(bounds(cell, "torsion")[0], rel=RELATIVE_ERROR)
