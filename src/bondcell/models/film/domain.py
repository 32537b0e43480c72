"""Quadrature over the matrix of a cell and the smooth coordinates in which its fields are written.

A line parallel to the axis meets the lower surface (sphere i, or plane z = 0 beside it) and the
upper one. Coordinates made of the spheres' own equations stay smooth where the spheres turn
vertical, at their feet; the fraction of a line's length would not, and its strain energy diverges.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.polynomial.legendre import leggauss

from bondcell.cell import FloatArray
from bondcell.models.jets import Jet

PANEL_RATIO = 3.6
"""Largest ratio of neighbouring panels' angles between the scale of the gap and the foot."""

RADIAL_POINTS, AXIAL_POINTS = 6, 6
"""Gauss points across a panel and along half a line; errors below 1e-4, see the tests."""

CORNER_POINTS = 2
"""Added along half a line where a sphere's foot lies inside the cell."""

OUTER_PANELS = 4
"""Panels over the larger sphere beside the smaller one, and over the annulus."""


@dataclass(frozen=True)
class Geometry:
    """Cells of one kind, lengths over the largest radius, arrays of shape (cells, 1).

    Parameters
    ----------
    radius_i, radius_j, gap, outer
        ``R_i``, ``R_j``, ``L_g``, ``R_c``.
    mirrored
        Whether only the lower half is integrated, counted twice.
    """

    radius_i: FloatArray
    radius_j: FloatArray
    gap: FloatArray
    outer: FloatArray
    mirrored: bool

    @property
    def length(self) -> FloatArray:
        """``L = R_i + R_j + L_g``."""
        return self.radius_i + self.radius_j + self.gap

    @property
    def film_radius(self) -> FloatArray:
        """Width of the film, ``a = sqrt(2 R* L_g)``, ``1/R* = 1/R_i + 1/R_j``."""
        return np.sqrt(2 * self.gap / (1 / self.radius_i + 1 / self.radius_j))


@dataclass(frozen=True)
class Domain:
    """Points of the matrix and coordinates there, jets of shape (cells, points).

    Parameters
    ----------
    weights
        ``2 pi r dr dz``.
    r, z
        Cylindrical coordinates; particle i is centred at z = 0, particle j at z = L.
    height
        ``L - z``.
    beside_i, beside_j
        ``phi = (|x|^2 - R^2)/(2 R)`` of each sphere, the distance from it to first order.
    above_i, above_j
        The same, but 0 on the end plane beside the sphere as well.
    span
        ``H = phi_i + phi_j``, the thickness of the film to first order.
    """

    weights: FloatArray
    r: Jet
    z: Jet
    height: Jet
    beside_i: Jet
    beside_j: Jet
    above_i: Jet
    above_j: Jet
    span: Jet


def domain(geometry: Geometry, points: tuple[int, int] | None = None) -> Domain:
    """Points, weights and coordinates.

    Parameters
    ----------
    geometry
        Cells of one kind.
    points
        Gauss points across a panel and along half a line, `RADIAL_POINTS` and `AXIAL_POINTS` if
        not given.

    Notes
    -----
    ``above = 2 phi z/(phi + z + sqrt(phi^2 + z^2))`` vanishes with phi and with z, and equals phi
    to first order at the sphere: Rvachev's conjunction.
    """
    across, half = points or (RADIAL_POINTS, AXIAL_POINTS)
    radius, measure = _radii(geometry, across)
    low, up = (_surface(radius, own) for own in (geometry.radius_i, geometry.radius_j))
    thickness = geometry.gap + low.dip + up.dip
    # Where a sphere meets its end plane inside the cell, fields have a corner.
    cornered = np.any(geometry.outer > np.minimum(geometry.radius_i, geometry.radius_j))
    half += CORNER_POINTS * int(cornered)
    node, weight = leggauss(half if geometry.mirrored else 2 * half)
    fraction, share = (node + 1) / 2, weight / 2
    if geometry.mirrored:
        if cornered:
            fraction, share = fraction**2, share * 2 * fraction
        fraction = fraction / 2
    elif cornered:
        crowding = 6 * fraction * (1 - fraction)
        fraction, share = fraction**2 * (3 - 2 * fraction), share * crowding

    def spread(values: FloatArray) -> FloatArray:
        return np.repeat(values, fraction.size, axis=-1)

    def along(values: FloatArray, factors: FloatArray) -> FloatArray:
        return np.asarray((values[..., None] * factors).reshape(*values.shape[:-1], -1))

    from_low, from_up = along(thickness, fraction), along(thickness, 1 - fraction)
    below, above = spread(low.height), spread(up.height)
    r, z = Jet.variables(spread(radius), below + from_low)
    zt = (geometry.length - z).with_value(above + from_up)
    beside_i = _beside(r, z, geometry.radius_i, spread(low.excess) + from_low * (below + z.value))
    beside_j = _beside(r, zt, geometry.radius_j, spread(up.excess) + from_up * (above + zt.value))
    return Domain(
        weights=along(2 * np.pi * radius * measure * thickness, share),
        r=r,
        z=z,
        height=zt,
        beside_i=beside_i,
        beside_j=beside_j,
        above_i=_conjunction(beside_i, z),
        above_j=_conjunction(beside_j, zt),
        span=beside_i + beside_j,
    )


def _beside(r: Jet, z: Jet, radius: FloatArray, square: FloatArray) -> Jet:
    """``phi``; `square` is ``|x|^2 - R^2`` without cancellation."""
    phi = (r * r + z * z) * (0.5 / radius)
    return phi.with_value(square * (0.5 / radius))


def _conjunction(a: Jet, b: Jet) -> Jet:
    return 2 * a * b / (a + b + (a * a + b * b).sqrt())


@dataclass(frozen=True)
class _Surface:
    """End of the lines: height over the end plane, its distance from the pole, ``r^2 - R^2``."""

    height: FloatArray
    dip: FloatArray
    excess: FloatArray


def _surface(radius: FloatArray, own: FloatArray) -> _Surface:
    square = (own - radius) * (own + radius)
    height = np.sqrt(np.maximum(square, 0))
    dip = np.where(square > 0, radius**2 / (own + height), own)
    return _Surface(height, dip, np.maximum(-square, 0))


def panel_count(film_radius: FloatArray) -> FloatArray:
    """Panels between the scale of the film, relative to the smaller sphere, and the foot."""
    ratio = np.log(np.pi / 2 / np.minimum(film_radius, 0.5)) / np.log(PANEL_RATIO)
    return np.maximum(np.ceil(ratio), 2)


def gauss(borders: FloatArray, points: int) -> tuple[FloatArray, FloatArray]:
    """Gauss points and weights on panels, borders (..., panels + 1) -> (..., panels * points)."""
    node, weight = leggauss(points)
    half = np.diff(borders)[..., None] / 2
    middle = (borders[..., 1:] + borders[..., :-1])[..., None] / 2
    shape = (*borders.shape[:-1], -1)
    return (middle + half * node).reshape(shape), (half * weight).reshape(shape)


def graded_angles(start: FloatArray) -> FloatArray:
    """Borders of panels from the pole to the foot: one as wide as ``start``, then growing ones."""
    start = np.minimum(start, 0.5)
    count = int(panel_count(start).max())
    growth = (np.pi / 2 / start) ** np.linspace(0, 1, count + 1)
    return np.concatenate((np.zeros_like(start), start * growth), axis=-1)


def _radii(geometry: Geometry, points: int) -> tuple[FloatArray, FloatArray]:
    """Radii of the lines and ``dr``: over the smaller sphere, beside it, over the annulus."""
    small = np.minimum(geometry.radius_i, geometry.radius_j)
    large = np.maximum(geometry.radius_i, geometry.radius_j)
    angle, width = gauss(graded_angles(geometry.film_radius / small), points)
    radii, widths = [small * np.sin(angle)], [small * np.cos(angle) * width]
    steps = np.linspace(0, 1, OUTER_PANELS + 1) ** 2
    if np.any(large > small):
        rim = np.arcsin(small / large)
        angle, width = gauss(rim + (np.pi / 2 - rim) * steps, points)
        radii.append(large * np.sin(angle))
        widths.append(large * np.cos(angle) * width)
    if np.any(geometry.outer > large):
        radius, width = gauss(large + (geometry.outer - large) * steps, points)
        radii.append(radius)
        widths.append(width)
    return np.concatenate(radii, axis=-1), np.concatenate(widths, axis=-1)
