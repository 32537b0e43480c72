"""Bonds of the specimen's lattices from the bond cell's models."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import xarray as xr

from bondcell.evaluate import evaluate
from bondcell.lattice import specimen_geometry as given


@dataclass(frozen=True)
class Material:
    """Elastic constants of the specimen; the defaults are the paper's.

    Parameters
    ----------
    young_particle, young_matrix
        Young's moduli [Pa].
    poisson_particle, poisson_matrix
        Poisson's ratios.
    """

    young_particle: float = given.YOUNG_PARTICLE
    poisson_particle: float = given.POISSON_PARTICLE
    young_matrix: float = given.YOUNG_MATRIX
    poisson_matrix: float = given.POISSON_MATRIX

    def study(self) -> xr.Dataset:
        """The bond cell between two particles of the specimen."""
        return xr.Dataset(
            {
                "radius_i": given.RADIUS,
                "gap": given.GAP,
                "young_i": self.young_particle,
                "poisson_i": self.poisson_particle,
                "young_m": self.young_matrix,
                "poisson_m": self.poisson_matrix,
            }
        )


def bond_springs(material: Material, model: str) -> Mapping[str, float]:
    """Stiffnesses of one bond as `bondcell.lattice.bonds.bonds` takes them.

    Parameters
    ----------
    material
        The elastic constants.
    model
        ``fe`` gives all of them, another name in ``bondcell.MODELS`` the normal one.

    Notes
    -----
    The cell's bending stiffness and its coupling force F hold centre i and turn centre j:
    with the lever ``a = F / K_s`` of the shear force, ``K_b = K_bb + K_s a^2``; K_bb is what
    resists turning alone.
    """
    study = material.study()
    normal = float(evaluate(study, model=model, load="normal").stiffness)
    if model != "fe":
        return {"normal": normal}
    shear = float(evaluate(study, model="fe", load="shear").stiffness)
    bending = evaluate(study, model="fe", load="bending")
    torsion = float(evaluate(study, model="fe", load="torsion").stiffness)
    lever = abs(float(bending.coupling)) / shear
    length = 2 * given.RADIUS + given.GAP
    return {
        "normal": normal,
        "shear": shear,
        "bending": float(bending.stiffness) - shear * lever**2,
        "torsion": torsion,
        "pivot": 1 - lever / length,
    }


def wall_spring(young_matrix: float, distance: float, radius: float = given.RADIUS) -> float:
    """Spring between a sphere and a plane wall [N/m].

    Parameters
    ----------
    young_matrix
        Modulus of what is between them [Pa]; the shear modulus gives the spring along the wall.
    distance
        From the centre to the wall [m].
    radius
        Of the sphere [m].

    Notes
    -----
    Columns of matrix across the wall, all in parallel, over the sphere's shadow:
    ``K = integral of E 2 pi r dr / (D - sqrt(R^2 - r^2)) = 2 pi E (D log(D/(D-R)) - R)``.

    Examples
    --------
    >>> round(wall_spring(1.4e6, 17.25e-3))
    20600
    """
    if distance > 1e3 * radius:  # the difference of two equal numbers: its series instead
        return float(np.pi * young_matrix * radius**2 / distance)
    logarithm = -np.log1p(-radius / distance)
    return float(2 * np.pi * young_matrix * (distance * logarithm - radius))
