"""Springs in series in 50 digits: the other side of the tests of relaxation."""

import mpmath as mp


def exact(value):
    return mp.mpf(float(value))


class Equation:
    """``1/b + x_inf = sum x_k tau_k / (T - tau_k)`` in mpmath."""

    def __init__(self, chain, compliance):
        self.b = exact(compliance)
        self.end = exact(chain.equilibrium)
        self.strengths = [exact(x) for x in chain.strengths]
        self.times = [exact(t) for t in chain.times]
        self.constant = 1 / self.b + self.end

    def excess(self, T):
        terms = (x * t / (T - t) for x, t in zip(self.strengths, self.times, strict=True))
        return self.constant - mp.fsum(terms)

    def slope(self, T):
        terms = (x * t / (T - t) ** 2 for x, t in zip(self.strengths, self.times, strict=True))
        return mp.fsum(terms)

    def root(self, k):
        """Root k: its distance from the nearer pole bisected in the logarithm, then Newton."""
        pole, sign = self.times[k], 1
        if k + 1 < len(self.times):
            half = (self.times[k + 1] - pole) / 2
            if self.excess(pole + half) < 0:
                pole, sign = self.times[k + 1], -1
        else:
            products = (x * t for x, t in zip(self.strengths, self.times, strict=True))
            half = mp.fsum(products) / self.constant
        low, high = mp.log(half) - 200, mp.log(half)
        while high - low > 1e-3:
            middle = (low + high) / 2
            too_far = self.excess(pole + sign * mp.exp(middle)) * sign > 0
            low, high = (low, middle) if too_far else (middle, high)
        offset = sign * mp.exp(low)
        for _ in range(6):
            offset -= self.excess(pole + offset) / self.slope(pole + offset)
        return pole + offset

    def series(self):
        """Equilibrium, roots and strengths."""
        roots = [self.root(k) for k in range(len(self.times))]
        strengths = [1 / (self.b**2 * T * self.slope(T)) for T in roots]
        return self.end / (1 + self.b * self.end), roots, strengths


def relaxation(series, time):
    end, roots, strengths = series
    return end + mp.fsum(
        k * mp.exp(-exact(time) / T) for T, k in zip(roots, strengths, strict=True)
    )


def worst(values, truth):
    """Largest relative error."""
    pairs = [(exact(v), t) for v, t in zip(values, truth, strict=True)]
    return max(float(abs(v - t) / t) if t else float(abs(v)) for v, t in pairs)
