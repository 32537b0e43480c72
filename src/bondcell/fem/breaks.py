"""Where one-dimensional grids break: geometric growth from a small scale or away from a wall."""

from __future__ import annotations

import numpy as np


def graded_breaks(scale: float, ratio: float) -> list[float]:
    """Break points in (0, 1], geometric with about ``ratio``, the first one near ``scale``."""
    if scale * 1.5 >= 1:
        return [1.0]
    count = max(1, round(np.log(1 / scale) / np.log(ratio)))
    return [float(scale ** (1 - k / count)) for k in range(count)] + [1.0]


def stretch(start: float, stop: float, step: float, growth: float) -> list[float]:
    """Points after ``start`` up to ``stop`` with steps that grow geometrically from ``step``."""
    if stop <= start:
        return []
    sizes = [step]
    while sum(sizes) < stop - start:
        sizes.append(sizes[-1] * growth)
    scale = (stop - start) / sum(sizes)
    return [*(start + scale * float(c) for c in np.cumsum(sizes[:-1])), stop]
