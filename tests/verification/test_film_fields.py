"""Fields of the film model: equilibrium in the particles, divergence, continuity."""

import numpy as np
import pytest

from bondcell.models.film import particles
from bondcell.models.film.domain import Geometry, domain
from bondcell.models.film.fields import fields
from bondcell.models.film.particles import COUNT, SOURCES, Traces, distances, energy, traces

RADIUS, POISSON = np.array([[0.8]]), np.array([[0.3]])
FAR = np.geomspace(0.05, 0.8, SOURCES).reshape(-1, 1, 1)


def at(r: float, z: float) -> list[np.ndarray]:
    """The particle's fields at one point, (quantity, field)."""
    groups = particles._fields(np.array([[r]]), np.array([[z]]), RADIUS + FAR, POISSON)
    rows = [np.concatenate([np.ravel(group[k]) for group in groups]) for k in range(5)]
    assert rows[0].size == COUNT
    return rows


def test_particle_fields_balance_themselves() -> None:
    """Differences of the stresses, hoop stress by Hooke's law: both equations of equilibrium."""
    r, z, step = 0.4, 0.3, 1e-5

    def slope(k: int, along_r: bool) -> np.ndarray:
        shift = (step, 0.0) if along_r else (0.0, step)
        return (at(r + shift[0], z + shift[1])[k] - at(r - shift[0], z - shift[1])[k]) / (2 * step)

    u_r, _, s_rr, s_zz, s_rz = at(r, z)
    mu = 1 / (2 * 1.3)
    hoop = s_rr + 2 * mu * (u_r / r - slope(0, True))
    radial = slope(2, True) + slope(4, False) + (s_rr - hoop) / r
    axial = slope(4, True) + slope(3, False) + s_rz / r
    size = np.abs(s_zz) + np.abs(s_rz) + 1
    assert np.all(np.abs(radial) / size < 1e-6)
    assert np.all(np.abs(axial) / size < 1e-6)


def test_particle_fields_keep_the_end_plane() -> None:
    _, axial, _, _, shear = at(0.4, 0.0)
    assert axial == pytest.approx(np.zeros(COUNT), abs=1e-14)
    assert shear == pytest.approx(np.zeros(COUNT), abs=1e-12)


def test_energy_of_uniform_strain() -> None:
    """u = (-nu r, z): E/2 per volume of the hemisphere; (r, 0): plane strain against the plate."""
    form = energy(RADIUS, FAR, POISSON, np.array([[0.1]]))[0]
    volume = 2 / 3 * np.pi * 0.8**3
    stretch = np.zeros(COUNT)
    stretch[:2] = 1, 0.5 - 0.3
    assert stretch @ form @ stretch == pytest.approx(volume, rel=1e-6)
    assert form[1, 1] == pytest.approx(2 / (1.3 * 0.4) * volume, rel=1e-6)
    assert np.linalg.eigvalsh(form).min() > -1e-9 * np.abs(form).max()


def surface(angle: np.ndarray) -> Traces:
    return traces(1 - np.cos(angle), RADIUS, FAR, POISSON)


def test_traces_are_the_fields() -> None:
    angle = np.array([[0.3, 1.2]])
    trace = surface(angle)
    for k in range(2):
        r, z = 0.8 * np.sin(angle[0, k]), 0.8 * np.cos(angle[0, k])
        u_r, u_z, *_ = at(r, z)
        assert trace.axial.value[:, 0, k] == pytest.approx(u_z, rel=1e-12, abs=1e-14)
        assert trace.radial.value[:, 0, k] * r == pytest.approx(u_r, rel=1e-12, abs=1e-14)


def test_flux_is_what_passes_through_the_cap() -> None:
    end = 1.1
    node, weight = np.polynomial.legendre.leggauss(60)
    angle = (end * (node + 1) / 2)[None]
    trace = surface(angle)
    outward = trace.axial.value * np.cos(angle) + 0.8 * trace.radial.value * np.sin(angle) ** 2
    flux = (outward * np.sin(angle) * 0.8**2 * weight * end / 2).sum(axis=-1)[:, 0]
    expected = flux / (0.8 * np.sin(end)) ** 2
    assert surface(np.array([[end]])).flux.value[:, 0, 0] == pytest.approx(expected, rel=1e-10)


@pytest.mark.parametrize("mirrored", [True, False])
def test_strains_of_the_matrix(mirrored: bool) -> None:
    radius_j = 1.0 if mirrored else 0.6
    numbers = (np.array([[x]]) for x in (1.0, radius_j, 0.1, 1.0 if mirrored else 1.4))
    geometry = Geometry(*numbers, mirrored=mirrored)
    space = domain(geometry)
    sides = ((geometry.radius_i, space.z), (geometry.radius_j, space.height))
    every = []
    for radius, z in sides:
        length = np.hypot(space.r.value, z.value)
        far = distances(radius, geometry.film_radius)
        every.append(traces(1 - z.value / length, radius, far, POISSON))
    trial = fields(space, geometry, *every)
    divergence = np.abs(trial.isochoric[:3].sum(axis=0))
    assert np.all(divergence <= 1e-9 * (1 + np.abs(trial.isochoric).sum(axis=0)))
    assert np.isfinite(trial.other).all()
    volume = np.pi * (geometry.outer**2 * geometry.length).item() - 2 / 3 * np.pi * (
        1 + radius_j**3
    )
    assert space.weights.sum() == pytest.approx(volume, rel=1e-6)
    continued = COUNT if mirrored else 2 * COUNT
    assert trial.isochoric.shape[1] == trial.first + continued + 1
