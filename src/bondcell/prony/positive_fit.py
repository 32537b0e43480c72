"""A rational function with positive terms through few accurate values.

``K(x) = k_0 + c x + sum m_l x/(1 + a_l x)``, all terms positive, is what the stiffness of any bond
is in a modulus of its matrix (`bank`). The greedy barycentric fit of Nakatsukasa, Sete and
Trefethen (AAA) finds such functions from values alone; its poles and residues are the terms. With
``k_0 = 0`` it is given ``K/x``, which says how the terms begin, else K itself.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.linalg

from bondcell.cell import FloatArray

CLOSE = 1e-13
"""Relative error at which more terms would only fit round-off."""

REAL = 1e-6
"""Imaginary part of a pole, relative, that round-off may leave."""


@dataclass(frozen=True)
class PositiveFit:
    """``K(x) = constant + bare x + sum strength x / (1 + softness x)``.

    Parameters
    ----------
    constant, bare
        ``k_0`` and ``c``, not negative.
    strength, softness
        ``m_l`` and ``a_l``, positive, shape (terms,).
    error
        Largest relative error at the values fitted.
    """

    constant: float
    bare: float
    strength: FloatArray
    softness: FloatArray
    error: float

    def __call__(self, x: FloatArray) -> FloatArray:
        """K(x), shape of x."""
        terms = self.strength * x[:, None] / (1 + self.softness * x[:, None])
        return np.asarray(self.constant + self.bare * x + terms.sum(axis=1))


def positive_fit(x: FloatArray, values: FloatArray, has_constant: bool) -> PositiveFit:
    """Fit ``values = K(x)``, positive, at ascending positive x.

    Parameters
    ----------
    x, values
        Shape (samples,).
    has_constant
        Whether ``k_0`` may differ from zero.

    Examples
    --------
    >>> x = np.geomspace(1e-3, 1, 9)
    >>> fit = positive_fit(x, 2 * x + 3 * x / (1 + 10 * x), has_constant=False)
    >>> round(fit.bare, 9), fit.strength.round(9), fit.softness.round(9)
    (2.0, array([3.]), array([10.]))
    """
    ratio = values if has_constant else values / x
    flat = float(ratio.mean())
    ends = (flat, 0.0) if has_constant else (0.0, flat)
    best = _measured(*ends, np.empty(0), np.empty(0), x, values)
    chosen = np.zeros(x.size, dtype=bool)
    guess = np.full(x.size, flat)
    for _ in range(x.size // 2):
        if best.error <= CLOSE:
            break
        misfit = np.where(chosen, 0.0, np.abs(guess / ratio - 1))
        chosen[misfit.argmax()] = True
        nodes, own, rest = x[chosen], ratio[chosen], ~chosen
        cauchy = 1 / (x[rest][:, None] - nodes)
        loewner = (ratio[rest][:, None] - own) * cauchy / ratio[rest][:, None]
        weights = np.linalg.svd(loewner)[2][-1]
        guess = ratio.copy()
        guess[rest] = (cauchy @ (weights * own)) / (cauchy @ weights)
        terms = _positive_terms(nodes, own, weights, has_constant)
        if terms is not None:
            fit = _measured(*terms, x, values)
            best = fit if fit.error < best.error else best
    return best


def _measured(
    constant: float,
    bare: float,
    strength: FloatArray,
    softness: FloatArray,
    x: FloatArray,
    values: FloatArray,
) -> PositiveFit:
    fit = PositiveFit(constant, bare, strength, softness, 0.0)
    error = float(np.abs(fit(x) / values - 1).max())
    return PositiveFit(constant, bare, strength, softness, error)


def _positive_terms(
    nodes: FloatArray, values: FloatArray, weights: FloatArray, has_constant: bool
) -> tuple[float, float, FloatArray, FloatArray] | None:
    """Terms of a barycentric form, None if one is not positive."""
    size = nodes.size
    arrow = np.zeros((size + 1, size + 1))
    arrow[0, 1:], arrow[1:, 0], arrow[1:, 1:] = weights, 1.0, np.diag(nodes)
    mass = np.eye(size + 1)
    mass[0, 0] = 0.0
    found = scipy.linalg.eigvals(arrow, mass)
    found = found[np.isfinite(found) & (np.abs(found) < 1e13 * nodes.max())]
    real = found.real
    if np.any(np.abs(found.imag) > REAL * np.abs(found)):
        return None
    apart = real[:, None] - nodes
    residues = (weights * values / apart).sum(axis=1) / -(weights / apart**2).sum(axis=1)
    order = np.argsort(real)
    poles, softness = real[order], -1 / real[order]
    if has_constant:
        # m x/(1 + a x) = m/a - (m/a^2)/(x + 1/a)
        constant = float((weights * values / nodes).sum() / (weights / nodes).sum())
        bare, strength = 0.0, -residues[order] / poles**2
    else:
        constant, bare = 0.0, float((weights * values).sum() / weights.sum())
        strength = -residues[order] / poles
    least = -1e-9 * float(values.max())
    if np.any(poles >= 0) or np.any(strength < 0) or bare < least or constant < 0:
        return None
    return constant, max(bare, 0.0), strength, softness
