"""Shear and bending: trial displacements of matrix and particles with one wave around the axis.

Both end planes are held, so no field but the lift is other than zero there. Fields are written as
in `one_wave`.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from bondcell.cell import FloatArray
from bondcell.models.film.domain import Domain, Geometry, domain
from bondcell.models.film.energies import Energies, placed
from bondcell.models.film.fields import film_coordinate, legendre
from bondcell.models.film.lateral_particles import distances, energy, flow_potentials, layers
from bondcell.models.film.one_wave import Field, quadratic_forms, strains, stream_strains
from bondcell.models.jets import Jet

FAMILIES = {
    "stream": {0: 5, 1: 5, 2: 2, 3: 2},
    "swirl": {0: 4, 1: 4},
    "alpha": {0: 5, 1: 5, 2: 2},
    "beta": {0: 6, 1: 6, 2: 3, 3: 3},
    "omega": {0: 6, 1: 6, 2: 3, 3: 3},
}
"""Family -> power of ``1 - 2 s`` -> number of functions of the film's thickness."""

BESIDE = {name: dict.fromkeys(range(4), 4) for name in ("stream", "swirl")}
"""The same for functions of r: beside a sphere is no film, and turning moves the matrix around."""

FLOWS = 5
"""Widths of the flows across the film."""


def shear_energies(geometry: Geometry, poisson_i: FloatArray, poisson_j: FloatArray) -> Energies:
    """Quadratic forms with a lift that moves particle j and its plane across the axis."""
    space = domain(geometry)
    s = _fraction(space)
    middle = geometry.radius_i + geometry.gap / 2
    q = (middle - space.z) * _step(s)
    lift = Field(None, s, None)
    return _energies(geometry, space, q, lift, (poisson_i, poisson_j))


def bending_energies(geometry: Geometry, poisson_i: FloatArray, poisson_j: FloatArray) -> Energies:
    """Quadratic forms with a lift that turns particle j and its plane about the plane's centre."""
    space = domain(geometry)
    s = _fraction(space)
    q = -(space.beside_j * geometry.radius_j * _step(s))
    lift = Field(None, -(space.height * s), -s)
    return _energies(geometry, space, q, lift, (poisson_i, poisson_j))


def _fraction(space: Domain) -> Jet:
    return space.above_i / (space.above_i + space.above_j)


def _step(s: Jet) -> Jet:
    return s * s * (3.0 - 2.0 * s)


def _energies(
    geometry: Geometry, space: Domain, stream: Jet, simple: Field, poisson: Sequence[FloatArray]
) -> Energies:
    r, s = space.r.value, _fraction(space)
    lift = stream_strains(stream, None, r)
    isochoric, other = _bubbles(space, geometry, s)
    currents, sides = [], []
    radii = (geometry.radius_i, geometry.radius_j)
    far = [distances(radius, geometry.film_radius) for radius in radii]
    for own, (z, fade) in enumerate(((space.z, 1.0 - s), (space.height, s))):
        # Seen from plane j the axis points the other way: omega and the potentials turn their sign.
        sign = 1.0 if own == 0 else -1.0
        currents.append(_currents(space.r, z, _step(fade), radii[own], far[own], sign))
        sides.append(_carried(space.r, z, fade, radii[own], sign))
    rows = [lift[:, None], _flows(space, geometry, s), isochoric, *currents]
    n = sum(part.shape[1] for part in rows)
    trial = np.concatenate([*rows, (strains(simple, r) - lift)[:, None], other, *sides], axis=1)
    shear, bulk = quadratic_forms(trial, space.weights / 2, n)
    blocks = [energy(radii[0], far[0], poisson[0], geometry.film_radius)]
    alike = np.array_equal(radii[0], radii[1]) and np.array_equal(poisson[0], poisson[1])
    blocks.append(
        blocks[0] if alike else energy(radii[1], far[1], poisson[1], geometry.film_radius)
    )
    count, width = currents[0].shape[1], sides[0].shape[1]
    places = [
        np.concatenate(
            [
                n - (2 - own) * count + np.arange(count),
                trial.shape[1] - (2 - own) * width + np.arange(width),
            ]
        )
        for own in (0, 1)
    ]
    moved, particles = placed(blocks, places, trial.shape[1])
    return Energies(shear, bulk, particles, n, moved)


def _carried(r: Jet, z: Jet, fade: Jet, radius: FloatArray, sign: float) -> FloatArray:
    """Strains of a particle's layers in the matrix: those of its surface, fading out."""
    across, along, fade = r.first_order(), z.first_order(), fade.first_order()
    shrink = radius * (1.0 / (across * across + along * along).sqrt())
    square = shrink * shrink
    local = layers(along * shrink, radius)
    carried = [field.times(fade, alpha=square, omega=shrink * sign) for field in local]
    return np.stack([strains(field, r.value) for field in carried], axis=1)


def _currents(
    r: Jet, z: Jet, fade: Jet, radius: FloatArray, far: FloatArray, sign: float
) -> FloatArray:
    """Strains of a particle's flows in the matrix, without divergence there as well.

    A potential goes on as ``2 f(x R/|x|) - f(x R^2/|x|^2)``, with the value and the slope that f
    has on the sphere, from points on the sphere and inside it only.
    """
    shrink = radius * (1.0 / (r * r + z * z).sqrt())
    square = shrink * shrink
    surface = flow_potentials(r * shrink, z * shrink, radius, far)
    inverted = flow_potentials(r * square, z * square, radius, far)
    rows = []
    for outer, inner in zip(surface, inverted, strict=True):
        q, p = (
            None if a is None or b is None else (2.0 * a - b) * fade * sign
            for a, b in zip(outer, inner, strict=True)
        )
        rows.append(stream_strains(q, p, r.value))
    return np.stack(rows, axis=1)


def _flows(space: Domain, geometry: Geometry, s: Jet) -> FloatArray:
    """Strains of fields without divergence that carry the film sideways.

    ``p = S g(r)``, ``q = S k(r)`` move nothing where S is 1 if ``k_r = -(r^4 g)_r/r^2``: ``g = 1``
    with ``k = -2 r^2``; and for widths c from the film's to the cylinder's ``g = 1/(r^2 + c^2)``,
    ``k = -r^2 g - ln(r^2 + c^2)`` and ``g = 1/(r^2 + c^2)^2``, ``k = 1/(r^2 + c^2) - r^2 g``.
    """
    r, step = space.r.value, _step(s)
    square = space.r * space.r
    strain = [stream_strains(-2.0 * square * step, step, r)]
    start = np.minimum(0.5 * geometry.film_radius, geometry.outer / 8)
    for power in np.linspace(0, 1, FLOWS):
        width = start * (2 * geometry.outer / start) ** power
        total = square + width**2
        g = 1.0 / total
        k = -(square * g) - (total * (1 / width**2)).log()
        strain.append(stream_strains(k * step, g * step, r))
        steep = g * g * width**2
        strain.append(stream_strains((g * width**2 - square * steep) * step, steep * step, r))
    return np.stack(strain, axis=1)


def _bubbles(space: Domain, geometry: Geometry, s: Jet) -> tuple[FloatArray, FloatArray]:
    """Strains of fields that vanish on both particles: without divergence, and the others."""
    across = space.r * space.r * (2 / geometry.outer**2) - 1.0
    rows: dict[str, list[FloatArray]] = {name: [] for name in FAMILIES}
    for coordinate, families in ((film_coordinate(space), FAMILIES), (across, BESIDE)):
        count = max(n for family in families.values() for n in family.values())
        table = legendre(coordinate.value, count)
        along = coordinate.compose(table.value, table.first, table.second)
        for name, counts in families.items():
            rows[name] += _family(name, counts, along, space, s)
    isochoric = np.concatenate([*rows["stream"], *rows["swirl"]], axis=1)
    other = np.concatenate([*rows["alpha"], *rows["beta"], *rows["omega"]], axis=1)
    return isochoric, other


def _family(
    name: str, counts: dict[int, int], along: Jet, space: Domain, s: Jet
) -> list[FloatArray]:
    """Strains of one family: for every power of ``1 - 2 s`` those of all functions along."""
    r, bubble, odd = space.r.value, s * (1.0 - s), 1.0 - 2.0 * s
    if name in ("stream", "swirl"):
        base = bubble * bubble
        base = base * space.span if name == "stream" else base
    else:
        base = (bubble * (1.0 / space.span) if name == "alpha" else bubble).first_order()
    strain: Callable[[Jet], FloatArray] = {
        "stream": lambda f: stream_strains(f, None, r),
        "swirl": lambda f: stream_strains(None, f, r),
        "alpha": lambda f: strains(Field(f, None, None), r),
        "beta": lambda f: strains(Field(None, f, None), r),
        "omega": lambda f: strains(Field(None, None, f), r),
    }[name]
    rows = []
    for power, count in counts.items():
        own = base
        for _ in range(power):
            own = own * odd
        rows.append(strain(own * Jet(along.parts[:, :count])))
    return rows
