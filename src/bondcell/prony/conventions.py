"""How the matrix relaxes besides its shear modulus, and what its moduli are at both ends."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from bondcell.cell import Cell, FloatArray
from bondcell.errors import Violation
from bondcell.prony.chain import Chain
from bondcell.prony.prony import Prony, PronyError
from bondcell.prony.springs import in_series, side_by_side

CONVENTIONS = {
    "constant_bulk": "the shear modulus relaxes, the bulk modulus does not: poisson_m rises",
    "constant_poisson": "all moduli relax alike",
    "separate": "shear and bulk modulus relax by a series each",
}
"""Name -> meaning."""

AGREEMENT = 1e-6
"""Relative difference allowed between an absolute modulus and the study's."""


@dataclass(frozen=True)
class Relaxing:
    """A matrix that relaxes, in many raveled cells.

    Parameters
    ----------
    prony
        The series.
    convention
        One of `CONVENTIONS`.
    cell
        The cells at t = 0, raveled.
    """

    prony: Prony
    convention: str
    cell: Cell

    @classmethod
    def of(cls, cell: Cell, prony: Prony, convention: str | None) -> Relaxing:
        """Check, and find the cells at t = 0.

        Parameters
        ----------
        cell
            Raveled cells; their matrix moduli are what ``prony.relative_to`` says.
        prony
            The series.
        convention
            One of `CONVENTIONS`; None: ``separate`` with a bulk series, else ``constant_bulk``.

        Raises
        ------
        PronyError
            Names every violation.
        """
        chosen = convention or ("constant_bulk" if prony.bulk is None else "separate")
        bad = _violations(cell, prony, chosen)
        if bad:
            raise PronyError(bad)
        shear = cell.young_m / (2 * (1 + cell.poisson_m))
        growth, bulk_growth = prony.growth
        if chosen == "constant_poisson":
            return cls(prony, chosen, replace(cell, young_m=cell.young_m * growth))
        if chosen == "constant_bulk":
            bulk_growth = 1.0
        if growth == bulk_growth == 1.0:
            return cls(prony, chosen, cell)
        # mu/kappa = 3 (1 - 2 nu) / (2 (1 + nu)), which keeps its digits near nu = 1/2.
        ratio = 1.5 * (1 - 2 * cell.poisson_m) / (1 + cell.poisson_m) * (growth / bulk_growth)
        young = 3 * shear * growth / (1 + ratio / 3)
        start = replace(cell, young_m=young, poisson_m=(3 - 2 * ratio) / (6 + 2 * ratio))
        return cls(prony, chosen, start)

    @property
    def shear(self) -> FloatArray:
        """Shear modulus at t = 0 [Pa]."""
        return np.asarray(self.cell.young_m / (2 * (1 + self.cell.poisson_m)))

    @property
    def bulk_compliance(self) -> FloatArray:
        """``1/kappa`` at t = 0 [1/Pa], zero for an incompressible matrix."""
        return np.asarray(3 * (1 - 2 * self.cell.poisson_m) / self.cell.young_m)

    def at(self, shear_share: float, bulk_share: float = 1.0) -> Cell:
        """The cells with moduli relaxed to the given shares; a share of zero is a fluid.

        Under ``constant_poisson`` the shear's share is that of both.
        """
        if self.convention == "constant_poisson":
            return replace(self.cell, young_m=self.cell.young_m * shear_share)
        ratio = self.shear * shear_share * self.bulk_compliance / bulk_share
        young = 3 * self.shear * shear_share / (1 + ratio / 3)
        return replace(self.cell, young_m=young, poisson_m=(3 - 2 * ratio) / (6 + 2 * ratio))

    def states(self, time: FloatArray) -> list[Cell]:
        """The cells with the moduli of each time: what an elastic formula would be given."""
        shear = self.prony.shear.relaxation(time)
        bulk = self.prony.bulk.relaxation(time) if self.prony.bulk is not None else shear * 0 + 1
        return [self.at(float(g), float(k)) for g, k in zip(shear, bulk, strict=True)]

    def young_chain(self, shear: float, bulk_compliance: float) -> Chain:
        """E(t) of one matrix whose both moduli relax: ``1/E = 1/(3G) + 1/(9 kappa)`` [Pa]."""
        assert self.prony.bulk is not None
        three_g = self.prony.shear.times_factor(3 * shear)
        return in_series(three_g, self.prony.bulk.times_factor(9 / bulk_compliance))

    def oedometric_chain(self, shear: float, bulk_compliance: float) -> Chain:
        """``M = kappa + 4/3 G`` of one matrix [Pa]."""
        own = self.prony.shear.times_factor(4 / 3 * shear)
        if self.prony.bulk is not None:
            return side_by_side(self.prony.bulk.times_factor(1 / bulk_compliance), own)
        return replace(own, equilibrium=own.equilibrium + 1 / bulk_compliance)


def _violations(cell: Cell, prony: Prony, convention: str) -> list[Violation]:
    if not isinstance(convention, str) or convention not in CONVENTIONS:
        return [Violation("convention", convention, f"one of {', '.join(CONVENTIONS)}")]
    bad = []
    if (prony.bulk is None) == (convention == "separate"):
        allowed = "separate with a bulk series, another one without"
        bad.append(Violation("convention", convention, allowed))
    if convention == "separate" and np.any(cell.poisson_m == 0.5):
        allowed = "below 0.5: an infinite bulk modulus has nothing to relax"
        bad.append(Violation("poisson_m", 0.5, allowed))
    if prony.modulus == "young" and convention != "constant_poisson":
        allowed = "constant_poisson for weights that are Young's moduli"
        bad.append(Violation("convention", convention, allowed))
    for name, value in absolute_moduli(prony, cell.poisson_m).items():
        given = getattr(cell, name)
        wrong = np.abs(given - value) > AGREEMENT * np.abs(value)
        if np.any(wrong):
            wanted = np.broadcast_to(value, given.shape)[wrong][0]
            allowed = f"left out, or what the absolute weights add up to, {wanted:.9g}"
            bad.append(Violation(name, float(given[wrong][0]), allowed))
    return bad


def absolute_moduli(prony: Prony, poisson_m: FloatArray) -> dict[str, FloatArray]:
    """Inputs at t = 0 that absolute weights fix: ``young_m``, with a bulk series ``poisson_m``."""
    modulus = prony.instantaneous_modulus
    if modulus is None:
        return {}
    if prony.modulus == "young":
        return {"young_m": np.asarray(modulus)}
    bulk = prony.instantaneous_bulk_modulus
    if bulk is None:
        return {"young_m": 2 * modulus * (1 + np.asarray(poisson_m))}
    ratio = modulus / bulk
    poisson = (3 - 2 * ratio) / (6 + 2 * ratio)
    return {
        "young_m": np.asarray(2 * modulus * (1 + poisson)),
        "poisson_m": np.asarray(poisson),
    }
