"""The relaxation of a material as users give it: weights and times, and what they refer to."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from bondcell.cell import FloatArray
from bondcell.errors import InputError, Violation
from bondcell.prony.axis import checked_axis
from bondcell.prony.chain import Chain
from bondcell.prony.given_series import checked_series, normalised
from bondcell.relaxing_ranges import TIMES

REFERENCES = ("instantaneous", "long_term", "absolute")
"""What weights may be relative to."""


class PronyError(InputError):
    """A Prony series is wrong."""


class Prony:
    """Prony series of a matrix: ``G(t) = G_inf + sum G_k exp(-t/tau_k)``.

    Parameters
    ----------
    weights
        Shear weights g_k: ``G_k/G_0`` or ``G_k/G_inf``, or moduli [Pa], see `relative_to`.
    times
        Relaxation times tau_k [s], each in `TIMES`.
    relative_to
        ``"instantaneous"``: the study's matrix moduli are those at t = 0; ``"long_term"``: those at
        the end; ``"absolute"``: weights are moduli.
    long_term
        Long-term modulus [Pa], for absolute weights only.
    modulus
        Which modulus absolute weights are: ``"shear"`` or ``"young"``.
    bulk_weights, bulk_times
        A series of the bulk modulus of its own; left out, see the conventions of
        `bondcell.relaxation`.
    bulk_long_term
        Long-term bulk modulus [Pa], for absolute weights with a bulk series.

    Attributes
    ----------
    shear
        Shear series relative to the instantaneous modulus, a `Chain`.
    bulk
        The same of the bulk series, None without one.

    Raises
    ------
    PronyError
        Names every violation at once.

    Notes
    -----
    Equal times are merged and zero weights dropped. Relative to the instantaneous modulus the
    long-term share is ``1 - sum g_k``, rounded once; below `FLUID` it is round-off, and the
    material is a fluid, ``G_inf = 0`` exactly. Long-term shares smaller than that have to be given
    relative to the long-term modulus or absolute.

    Examples
    --------
    >>> prony = Prony(weights=[0.1] * 10, times=np.geomspace(1e-3, 1e6, 10))
    >>> prony.is_fluid, float(prony.shear.equilibrium)
    (True, 0.0)
    >>> Prony([1.0, 2.0], [1.0, 10.0], relative_to="long_term").shear.strengths
    array([0.25, 0.5 ])
    """

    shear: Chain
    bulk: Chain | None

    def __init__(
        self,
        weights: ArrayLike,
        times: ArrayLike,
        relative_to: str = "instantaneous",
        *,
        long_term: float | None = None,
        modulus: str = "shear",
        bulk_weights: ArrayLike | None = None,
        bulk_times: ArrayLike | None = None,
        bulk_long_term: float | None = None,
    ) -> None:
        bad: list[Violation] = []
        if relative_to not in REFERENCES:
            bad.append(Violation("relative_to", relative_to, f"one of {', '.join(REFERENCES)}"))
        if modulus not in ("shear", "young"):
            bad.append(Violation("modulus", modulus, "shear or young"))
        absolute = relative_to == "absolute"
        if not absolute and modulus != "shear":
            bad.append(Violation("modulus", modulus, "left out unless weights are absolute"))
        has_bulk = bulk_weights is not None or bulk_times is not None
        if has_bulk and modulus == "young":
            allowed = "left out where absolute weights are Young's moduli"
            bad.append(Violation("bulk_weights", bulk_weights, allowed))
        series: dict[str, tuple[Any, Any, Any]] = {"": (weights, times, long_term)}
        if has_bulk:
            series["bulk_"] = (bulk_weights, bulk_times, bulk_long_term)
        elif bulk_long_term is not None:
            bad.append(Violation("bulk_long_term", bulk_long_term, "left out without bulk_weights"))
        clean = {
            name: checked_series(name, relative_to, *given, violations=bad)
            for name, given in series.items()
        }
        if bad:
            raise PronyError(bad)
        self.relative_to, self.modulus = relative_to, modulus
        self.shear, self._scale = normalised(relative_to, *clean[""])
        self.bulk, self._bulk_scale = None, 1.0
        if has_bulk:
            self.bulk, self._bulk_scale = normalised(relative_to, *clean["bulk_"])

    @property
    def is_fluid(self) -> bool:
        """Whether the shear modulus relaxes to nothing."""
        return bool(self.shear.equilibrium == 0.0)

    @property
    def instantaneous_modulus(self) -> float | None:
        """Modulus at t = 0 of absolute weights [Pa], see ``modulus``; None for relative ones."""
        return self._scale if self.relative_to == "absolute" else None

    @property
    def instantaneous_bulk_modulus(self) -> float | None:
        """Bulk modulus at t = 0 of absolute weights [Pa]; None otherwise."""
        has = self.relative_to == "absolute" and self.bulk is not None
        return self._bulk_scale if has else None

    @property
    def growth(self) -> tuple[float, float]:
        """Shear and bulk modulus at t = 0 over the ones that the study's moduli stand for."""
        if self.relative_to == "long_term":
            return self._scale, self._bulk_scale
        return 1.0, 1.0

    def relaxation_modulus(self, time: ArrayLike) -> FloatArray:
        """``g(t) = G(t)/G_0``, shape (times,).

        Examples
        --------
        >>> Prony([0.5], [2.0]).relaxation_modulus([0.0, np.inf])
        array([1. , 0.5])
        """
        return self.shear.relaxation(checked_axis("time", time))

    def storage_modulus(self, frequency: ArrayLike) -> FloatArray:
        """``G'(w)/G_0`` at angular frequencies [rad/s]."""
        return np.asarray(self._dynamic(frequency).real)

    def loss_modulus(self, frequency: ArrayLike) -> FloatArray:
        """``G''(w)/G_0`` at angular frequencies [rad/s]."""
        return np.asarray(self._dynamic(frequency).imag)

    def loss_factor(self, frequency: ArrayLike) -> FloatArray:
        """``G''/G'`` at angular frequencies [rad/s]; inf for a fluid at rest.

        Examples
        --------
        >>> Prony([0.5], [2.0]).loss_factor([0.5]).round(4)
        array([0.3333])
        """
        complex_modulus = self._dynamic(frequency)
        with np.errstate(divide="ignore", invalid="ignore"):
            ratio = complex_modulus.imag / complex_modulus.real
        return np.where(complex_modulus.real > 0, ratio, np.inf if self.is_fluid else 0.0)

    def _dynamic(self, frequency: ArrayLike) -> NDArray[np.complex128]:
        return self.shear.dynamic(checked_axis("frequency", frequency))

    def shifted(self, factor: float) -> Prony:
        """The same material where every time is ``factor`` times as long, see `shift`."""
        number = isinstance(factor, int | float | np.number) and not isinstance(factor, bool)
        if not (number and np.isfinite(factor) and factor > 0):
            raise PronyError([Violation("factor", factor, "(0, inf), finite")])
        every = self.shear.times if self.bulk is None else [*self.shear.times, *self.bulk.times]
        for k, time in enumerate(every):
            if not TIMES[0] <= factor * time <= TIMES[1]:
                allowed = f"[{TIMES[0]:g}, {TIMES[1]:g}] s after the shift by {factor:g}"
                raise PronyError([Violation(f"times[{k}]", float(time), allowed)])
        other = object.__new__(Prony)
        other.__dict__.update(self.__dict__)
        other.shear = Chain(self.shear.equilibrium, self.shear.strengths, self.shear.times * factor)
        if self.bulk is not None:
            bulk = self.bulk
            other.bulk = Chain(bulk.equilibrium, bulk.strengths, bulk.times * factor)
        return other

    def __repr__(self) -> str:
        bulk = f", {self.bulk.count} bulk terms" if self.bulk is not None else ""
        kind = "fluid" if self.is_fluid else f"g_inf={float(self.shear.equilibrium):.6g}"
        return f"Prony({self.shear.count} terms, {kind}{bulk}, relative to {self.relative_to})"
