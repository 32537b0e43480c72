"""Normal stiffness of two spheres bonded through a matrix: analytic models and their reference.

Everything below is loaded at its first use, so that ``import bondcell`` stays quick and a study
that meshes nothing imports no finite elements.

Examples
--------
>>> import bondcell
>>> bondcell.Status.ok.name
'ok'
"""

from __future__ import annotations

import sys
from importlib import import_module
from types import ModuleType
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from bondcell.advice import Advice, advise
    from bondcell.bond_tables import reduce_series, write_bond_table
    from bondcell.bonded_lattice import bonded_lattice
    from bondcell.errors import (
        BondcellError,
        DataError,
        InputError,
        MissingLibrary,
        SceneError,
        UnknownModel,
        UnsupportedLoad,
        Violation,
    )
    from bondcell.evaluate import evaluate
    from bondcell.lattice.solve import solve as solve_lattice
    from bondcell.models import MODELS
    from bondcell.prony.prony import Prony, PronyError
    from bondcell.prony_files import read_prony
    from bondcell.relaxation import dynamic_stiffness, relaxation, relaxation_series
    from bondcell.status import Status

    __version__: str

__all__ = [
    "MODELS",
    "Advice",
    "BondcellError",
    "DataError",
    "InputError",
    "MissingLibrary",
    "Prony",
    "PronyError",
    "SceneError",
    "Status",
    "UnknownModel",
    "UnsupportedLoad",
    "Violation",
    "__version__",
    "advise",
    "bonded_lattice",
    "dynamic_stiffness",
    "evaluate",
    "read_prony",
    "reduce_series",
    "relaxation",
    "relaxation_series",
    "solve_lattice",
    "write_bond_table",
]

_HOME = {
    "MODELS": "bondcell.models",
    "Advice": "bondcell.advice",
    "BondcellError": "bondcell.errors",
    "DataError": "bondcell.errors",
    "InputError": "bondcell.errors",
    "MissingLibrary": "bondcell.errors",
    "Prony": "bondcell.prony.prony",
    "PronyError": "bondcell.prony.prony",
    "SceneError": "bondcell.errors",
    "Status": "bondcell.status",
    "UnknownModel": "bondcell.errors",
    "UnsupportedLoad": "bondcell.errors",
    "Violation": "bondcell.errors",
    "advise": "bondcell.advice",
    "bonded_lattice": "bondcell.bonded_lattice",
    "dynamic_stiffness": "bondcell.relaxation",
    "evaluate": "bondcell.evaluate",
    "read_prony": "bondcell.prony_files",
    "reduce_series": "bondcell.bond_tables",
    "relaxation": "bondcell.relaxation",
    "relaxation_series": "bondcell.relaxation",
    "write_bond_table": "bondcell.bond_tables",
}

_OTHER_NAMES = {"solve_lattice": ("bondcell.lattice.solve", "solve")}


class _Package(ModuleType):
    """Keeps an import of a submodule from hiding the function of its name, as ``evaluate``."""

    def __setattr__(self, name: str, value: Any) -> None:
        if not (name in _HOME and isinstance(value, ModuleType)):
            super().__setattr__(name, value)


sys.modules[__name__].__class__ = _Package


def __getattr__(name: str) -> Any:
    if name == "__version__":
        value: Any = _version()
    elif name in _HOME:
        value = getattr(import_module(_HOME[name]), name)
    elif name in _OTHER_NAMES:
        home, own_name = _OTHER_NAMES[name]
        value = getattr(import_module(home), own_name)
    else:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})


def _version() -> str:
    from importlib.metadata import PackageNotFoundError, version

    try:
        return version("bondcell")
    except PackageNotFoundError:
        return "0+unknown"
