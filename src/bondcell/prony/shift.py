"""Time-temperature shift: a warmer material passes through the same relaxation sooner.

``tau(T) = a_T tau(T_0)``.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from bondcell.cell import FloatArray
from bondcell.errors import InputError, Violation

GAS_CONSTANT = 8.31446261815324
"""Molar gas constant [J/(mol K)], exact since the SI of 2019."""


def wlf(temperature: ArrayLike, reference: float, c_1: float, c_2: float) -> FloatArray:
    """Shift factor of Williams, Landel and Ferry, ``log10 a_T = -c_1 (T - T_0)/(c_2 + T - T_0)``.

    Parameters
    ----------
    temperature, reference
        T and T_0 [K], or both in degrees Celsius: only differences count.
    c_1
        Dimensionless constant, positive.
    c_2
        Temperature constant [K], positive.

    Raises
    ------
    InputError
        A constant is not positive, or a temperature lies at or below ``T_0 - c_2``, where the
        formula has its pole.

    Examples
    --------
    >>> wlf([20.0, 30.0], 20.0, 17.44, 51.6).round(6)
    array([1.      , 0.001475])
    """
    change = np.asarray(temperature, dtype=float) - reference
    bad = [
        Violation(name, value, "(0, inf), finite")
        for name, value in (("c_1", c_1), ("c_2", c_2))
        if not (np.isfinite(value) and value > 0)
    ]
    if not np.all(np.isfinite(change)):
        bad.append(Violation("temperature", temperature, "finite"))
    elif not bad and np.any(change <= -c_2):
        low = float(np.min(change)) + reference
        bad.append(Violation("temperature", low, f"above reference - c_2 = {reference - c_2:g}"))
    if bad:
        raise InputError(bad)
    return np.asarray(10.0 ** (-c_1 * change / (c_2 + change)))


def arrhenius(temperature: ArrayLike, reference: float, activation_energy: float) -> FloatArray:
    """Shift factor of Arrhenius, ``ln a_T = (E_a/R) (1/T - 1/T_0)``.

    Parameters
    ----------
    temperature, reference
        T and T_0 [K], positive.
    activation_energy
        E_a [J/mol], not negative.

    Raises
    ------
    InputError
        A temperature is not positive, or the energy negative.

    Examples
    --------
    >>> arrhenius([293.15, 303.15], 293.15, 1e5).round(4)
    array([1.    , 0.2584])
    """
    kelvin = np.asarray(temperature, dtype=float)
    bad = [
        Violation(name, value, "(0, inf) K, finite")
        for name, value in (("temperature", kelvin), ("reference", np.asarray(reference)))
        if not np.all(np.isfinite(value) & (value > 0))
    ]
    if not (np.isfinite(activation_energy) and activation_energy >= 0):
        bad.append(Violation("activation_energy", activation_energy, "[0, inf) J/mol, finite"))
    if bad:
        raise InputError(bad)
    inverse = (reference - kelvin) / (kelvin * reference)
    return np.asarray(np.exp(activation_energy / GAS_CONSTANT * inverse))
