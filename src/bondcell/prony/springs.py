"""A spring in series with a Maxwell chain is again a chain, and so are two chains in series.

The chain ``X`` with the compliance ``b`` of a spring before it, in the Laplace variable s:
``1/K = 1/X + b``. Its relaxation times are the roots of

``1/b + x_inf = sum x_k tau_k / (T - tau_k)``

[theory, section 4, with T = 1/w], one above each time of X, and each strength follows from the
slope there, ``1/(b^2 T_j sum x_k tau_k/(T_j - tau_k)^2)``.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from bondcell.cell import FloatArray
from bondcell.prony import secular
from bondcell.prony.chain import Chain, merged
from bondcell.prony.double_double import Pair, add, quotient, total, two_product, two_sum


def behind_spring(chain: Chain, compliance: ArrayLike) -> Chain:
    """Chains that result from springs in series with one chain.

    Parameters
    ----------
    chain
        One chain, times ascending and distinct, strengths positive (see `chain.merged`).
    compliance
        Compliance b of each spring in units of one over the chain's, not negative; 0 is rigid.
        Any shape.

    Returns
    -------
    Chain
        Shape of `compliance`, as many terms as the chain.

    Examples
    --------
    The check value of theory.md, a spring of 4:

    >>> chain = Chain(np.array(1.0), np.array([2.0, 3.0]), np.array([1.0, 10.0]))
    >>> result = behind_spring(chain, 1 / 4)
    >>> result.times.round(8), result.strengths.round(8), float(result.equilibrium)
    (array([ 1.23742672, 16.16257328]), array([0.36047333, 1.23952667]), 0.8)
    """
    b = np.asarray(compliance, dtype=float)
    flat = b.ravel()
    equilibrium = chain.equilibrium / (1 + flat * chain.equilibrium)
    strengths = np.tile(chain.strengths, (flat.size, 1))
    times = np.tile(chain.times, (flat.size, 1))
    # A compliance so small that it changes no digit would only overflow below.
    soft = flat * chain.instantaneous > 1e-25
    if soft.any() and chain.count:
        own = flat[soft]
        inverse = quotient((np.ones_like(own), np.zeros_like(own)), (own, np.zeros_like(own)))
        constant = add(inverse, (chain.equilibrium, np.zeros(())))
        roots = secular.solve(chain.times, two_product(chain.strengths, chain.times), constant)
        times[soft] = roots.value
        strengths[soft] = 1 / own[:, None] / own[:, None] / roots.value / roots.slope
    shape = (*b.shape, chain.count)
    return Chain(equilibrium.reshape(b.shape), strengths.reshape(shape), times.reshape(shape))


def in_series(one: Chain, other: Chain) -> Chain:
    """Two chains in series.

    Parameters
    ----------
    one, other
        Single chains, times ascending and distinct, strengths positive.

    Notes
    -----
    ``K = X - X^2/(X + Y)``: the times are the roots of ``X + Y = 0``, the strengths
    ``X(T)^2 / (T slope)``, where ``X(T) = x_inf - sum x_k tau_k/(T - tau_k)`` may cancel and is
    summed with twice the digits. A time that both have stays, with their strengths in series.

    Examples
    --------
    >>> chain = Chain(np.array(1.0), np.array([2.0]), np.array([5.0]))
    >>> half = in_series(chain, chain)
    >>> float(half.equilibrium), half.strengths, half.times
    (0.5, array([1.]), array([5.]))
    """
    both = one.equilibrium + other.equilibrium
    equilibrium = one.equilibrium * other.equilibrium / both if both > 0 else np.zeros(())
    common, at_one, at_other = np.intersect1d(one.times, other.times, return_indices=True)
    mine, yours = one.strengths[at_one], other.strengths[at_other]
    kept = mine * yours / (mine + yours)
    products = [two_product(chain.strengths, chain.times) for chain in (one, other)]
    poles = np.union1d(one.times, other.times)
    residues = np.zeros(poles.size), np.zeros(poles.size)
    for chain, product in zip((one, other), products, strict=True):
        at = np.searchsorted(poles, chain.times)
        sums = add((residues[0][at], residues[1][at]), product)
        residues[0][at], residues[1][at] = sums
    constant = two_sum(np.atleast_1d(one.equilibrium), np.atleast_1d(other.equilibrium))
    roots = secular.solve(poles, residues, constant)
    origin = poles[roots.pole[0]]
    at_roots = _value(one, products[0], origin, roots.offset[0])
    other_at_roots = _value(other, products[1], origin, roots.offset[0])
    # Equal and opposite at a root: the product loses less than either square.
    square = np.abs(at_roots * other_at_roots)
    strengths = square / (roots.value[0] * roots.slope[0])
    every = np.concatenate((strengths, kept)), np.concatenate((roots.value[0], common))
    return Chain(np.asarray(equilibrium), *merged(*every))


def _value(chain: Chain, products: Pair, origin: FloatArray, offset: FloatArray) -> FloatArray:
    """``x_inf - sum x_k tau_k / (T - tau_k)`` at ``T = origin + offset``."""
    zero = np.zeros((offset.size, 1))
    distance = add(two_sum(origin[:, None], -chain.times), (offset[:, None], zero))
    if not chain.count:
        return np.broadcast_to(chain.equilibrium, offset.shape)
    terms = total(quotient(products, distance))
    return add((chain.equilibrium, np.zeros(())), (-terms[0], -terms[1]))[0]


def side_by_side(*chains: Chain) -> Chain:
    """One chain that is the sum of single chains."""
    equilibrium = np.sum([chain.equilibrium for chain in chains], axis=0)
    strengths = np.concatenate([chain.strengths for chain in chains])
    times = np.concatenate([chain.times for chain in chains])
    return Chain(np.asarray(equilibrium), *merged(strengths, times))
