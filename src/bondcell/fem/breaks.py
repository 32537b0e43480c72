"""Where one-dimensional grids break: geometric growth from a small scale or away from a wall."""

from __future__ import annotations

import numpy as np
from scipy.optimize import brentq


def graded_breaks(scale: float, total: float, ratio: float, largest: float = np.inf) -> list[float]:
    """Break points in (0, total]: the first at ``scale``, then growing, then evenly spaced.

    Steps are equal in ``t(x) = ln x / ln ratio + x / largest``: neighbouring points stand in the
    ratio ``ratio`` while they are small, and ``largest`` apart once they are not.

    Parameters
    ----------
    scale
        First break point; none but ``total`` where it comes near it.
    total
        Last break point.
    ratio, largest
        See above; about, since the number of steps is whole.
    """

    def steps(x: float) -> float:
        return float(np.log(x) / np.log(ratio) + x / largest)

    if scale * 1.3 >= total:
        return [total]
    first, last = steps(scale), steps(total)
    count = max(1, round(last - first))
    inner = [
        brentq(lambda x, k=k: steps(x) - first - (last - first) * k / count, scale, total)
        for k in range(1, count)
    ]
    return [scale, *map(float, inner), total]


def stretch(start: float, stop: float, step: float, growth: float) -> list[float]:
    """Points after ``start`` up to ``stop`` with steps that grow geometrically from ``step``."""
    if stop <= start:
        return []
    sizes = [step]
    while sum(sizes) < stop - start:
        sizes.append(sizes[-1] * growth)
    scale = (stop - start) / sum(sizes)
    return [*(start + scale * float(c) for c in np.cumsum(sizes[:-1])), stop]
