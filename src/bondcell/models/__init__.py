"""Bond models by name.

Examples
--------
>>> for model in MODELS.values():
...     print(f"{model.name}: {model.title}")
fsi: fully sequential interface
general: general model, core and parallel bond
generatrix: generatrix lines
slices: plane slices
parallel_bond: parallel bond
cementation: cementation theory
film: film between elastic spheres
bounds: bounds from below and above
surrogate: interpolated finite elements
fe: finite elements
"""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from bondcell.models.bounds import BOUNDS
from bondcell.models.cementation import CEMENTATION
from bondcell.models.film import FILM
from bondcell.models.finite_elements import FE
from bondcell.models.fsi import FSI
from bondcell.models.general import GENERAL
from bondcell.models.generatrix import GENERATRIX
from bondcell.models.model import Model
from bondcell.models.parallel_bond import PARALLEL_BOND
from bondcell.models.slices import SLICES
from bondcell.models.surrogate import SURROGATE

MODELS: Mapping[str, Model] = MappingProxyType(
    {
        model.name: model
        for model in (
            FSI,
            GENERAL,
            GENERATRIX,
            SLICES,
            PARALLEL_BOND,
            CEMENTATION,
            FILM,
            BOUNDS,
            SURROGATE,
            FE,
        )
    }
)
"""Every model by the name that ``bondcell.evaluate`` takes."""
