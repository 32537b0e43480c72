"""Points of a scene with one of its series: how their matrix relaxes, and from which modulus."""

from __future__ import annotations

import numpy as np
import xarray as xr

from bondcell.cell import Cell
from bondcell.prony.prony import Prony
from bondcell.scenes.prony_block import PronyBlock
from bondcell.scenes.series_cases import SeriesCase


def prony_of(block: PronyBlock, case: SeriesCase) -> Prony:
    """The series of a scene at its temperature."""
    prony = Prony(case.weights, case.times, case.relative_to)
    material = block.known_material(case.material) if case.material else None
    if material is None or case.temperature in (None, material.temperature):
        return prony
    assert case.temperature is not None
    return prony.shifted(material.shift(case.temperature))


def relaxing_study(cell: Cell, case: SeriesCase) -> xr.Dataset:
    """The points with the modulus that the material brings, if it does."""
    values = cell.as_dict()
    if case.young is not None:
        values = {**values, "young_m": np.full_like(values["young_m"], case.young)}
    return xr.Dataset({name: ("point", value) for name, value in values.items()})
