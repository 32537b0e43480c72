"""Which block of a scene stands at which path: for hints on keys that do not exist."""

from __future__ import annotations

from bondcell.scenes.blocks import Case, CellInputs, Convergence, Reference
from bondcell.scenes.design import Design, Ranges
from bondcell.scenes.fields import Block
from bondcell.scenes.prony_block import BondTable, Methods, PronyBlock
from bondcell.scenes.ranges import Range, Span
from bondcell.scenes.series_cases import Spectrum
from bondcell.scenes.specimen_block import (
    Ladders,
    SpecimenBlock,
    SpecimenFiniteStrain,
    SpecimenRelaxation,
)
from bondcell.scenes.sweep import Sweep
from bondcell.scenes.time_fields import FrequencySpan, Terms, TimeSpan
from bondcell.scenes.violations import KeyPath

_BLOCKS: dict[str, type[Block]] = {
    "cell": CellInputs,
    "reference": Reference,
    "convergence": Convergence,
    "sweep": Sweep,
    "design": Design,
    "prony": PronyBlock,
    "specimen": SpecimenBlock,
}

_OF_SPECIMEN: dict[str, type[Block]] = {
    "elastic": Ladders,
    "rigid": Ladders,
    "relaxation": SpecimenRelaxation,
    "finite_strain": SpecimenFiniteStrain,
    "series": Terms,
    "times": TimeSpan,
}

_OF_PRONY: dict[str, type[Block]] = {
    "series": Terms,
    "spectrum": Spectrum,
    "times": TimeSpan,
    "frequencies": FrequencySpan,
    "bond": BondTable,
    "methods": Methods,
}


def block_of(path: KeyPath) -> type[Block] | None:
    """The block at a path, None for the scene itself.

    Examples
    --------
    >>> block_of(("sweep", "gap")).__name__, block_of(()) is None
    ('Range', True)
    """
    if not path:
        return None
    if len(path) == 1:
        return _BLOCKS[str(path[0])]
    if path[0] == "prony":
        return _OF_PRONY[str(path[1])]
    if path[0] == "specimen":
        return _OF_SPECIMEN[str(path[-1])]
    if path[0] == "design":
        return Ranges if len(path) == 2 else Span
    return Range if path[0] == "sweep" else Case
