"""How many polynomial orders the particles may stay behind the matrix.

Particles that are much stiffer than the bond hold little of the energy: a part of about
``K / (E R)``, for a translation. Measured on random cells, every order less in the particles
multiplies their own error by ten, and at equal orders that error is ten times below the matrix's in
proportion to this part. So the particles may lag one order a decade. What they add is seen by the
ladder of orders like any other error.
"""

from __future__ import annotations

import numpy as np

from bondcell.cell import FloatArray
from bondcell.fem.cell_mesh import Geometry
from bondcell.fem.materials import Materials, shear_modulus
from bondcell.fem.strain import AXIAL
from bondcell.fem.structured import Load

LARGEST_LAG = 4
"""Beyond it little is left to save."""


def particle_lag(geometry: Geometry, materials: Materials, load: Load) -> int:
    """The lag that suits all points of a sweep, those with the softest particles deciding."""
    softest = np.minimum(
        materials.young_i * geometry.radius_i, materials.young_j * geometry.radius_j
    )
    with np.errstate(divide="ignore", invalid="ignore"):
        decades = -np.log10(_bond(geometry, materials, load) / softest)
    return int(np.clip(np.rint(np.nan_to_num(decades, nan=0.0).min()), 0, LARGEST_LAG))


def _bond(geometry: Geometry, materials: Materials, load: Load) -> FloatArray:
    """About how stiff the matrix between rigid particles is, for a translation [N/m].

    In the film ``h = L_g + r^2/D``, ``1/D = (1/R_i + 1/R_j)/2``, lines act in parallel with the
    oedometric modulus ``M``, unless the matrix flows sideways more easily, which held sides do not
    let it; the rest is about 3 E R::

        1/K = 1/(pi M D l) + 1/(3/2 pi mu D^2/L_g),   l = ln(1 + R_min^2/(D L_g))

    Shear and torsion it resists by ``pi mu D l``.
    """
    smallest = min(geometry.radius_i, geometry.radius_j)
    film = 2 / (1 / geometry.radius_i + 1 / geometry.radius_j)
    length = np.pi * film * np.log1p(smallest**2 / (film * geometry.gap))
    shear = shear_modulus(materials.young_m, materials.poisson_m)
    around = 3 * materials.young_m * geometry.cylinder_radius
    if load.whole.mode is not AXIAL and load.index == 0:
        return np.asarray(shear * length + around)
    poisson = materials.poisson_m
    softness = (1 + poisson) * (1 - 2 * poisson) / (1 - poisson) / materials.young_m
    is_free = not load.whole.held.get("lateral")
    sideways = is_free * geometry.gap / (1.5 * np.pi * shear * film**2)
    with np.errstate(divide="ignore"):
        return np.asarray(1 / (softness / length + sideways) + around)
