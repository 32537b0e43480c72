"""A gmsh session that leaves no trace: no signal handler, no option and no model stays behind."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from threading import RLock
from types import ModuleType

from bondcell.errors import MissingLibrary

SYSTEM_PACKAGES = "libglu1-mesa libgl1 libxft2 libxinerama1 libxcursor1 libgomp1"
"""Debian packages with the libraries that the gmsh wheel links to."""

REPRODUCIBLE: Mapping[str, float] = {
    "General.Terminal": 0,
    "General.NumThreads": 1,
    "Mesh.MaxNumThreads1D": 1,
    "Mesh.MaxNumThreads2D": 1,
    "Mesh.MaxNumThreads3D": 1,
    "Mesh.RandomSeed": 1,
    "Mesh.RandomFactor": 1e-9,
    "Mesh.MeshSizeFactor": 1,
    "Mesh.MeshSizeMin": 0,
    "Mesh.MeshSizeMax": 1e22,
    "Mesh.MeshSizeFromPoints": 0,
    "Mesh.MeshSizeFromCurvature": 0,
    "Mesh.MeshSizeExtendFromBoundary": 0,
    "Mesh.RecombineAll": 0,
    "Mesh.SaveAll": 0,
}
"""Options set in every session: silent, one thread, sizes from the size field alone.

More than one thread gives meshes that differ from run to run. The random factor perturbs the points
of the triangulation; it is kept small since gaps may be small as well.
"""

_one_at_a_time = RLock()


def load_gmsh() -> ModuleType:
    """Import gmsh.

    Raises
    ------
    MissingLibrary
        gmsh is not installed, or a system library it links to is absent.
    """
    try:
        import gmsh
    except ImportError as error:
        raise MissingLibrary("gmsh is not installed: pip install gmsh") from error
    except OSError as error:
        raise MissingLibrary(
            f"gmsh needs a system library ({error}); as root on Debian or Ubuntu: "
            f"apt-get install -y --no-install-recommends {SYSTEM_PACKAGES}"
        ) from error
    return gmsh  # type: ignore[no-any-return, unused-ignore]


@contextmanager
def gmsh_model(name: str, options: Mapping[str, float]) -> Iterator[ModuleType]:
    """Give gmsh with an empty current model; afterwards gmsh is as it was found.

    Parameters
    ----------
    name
        Name of the model.
    options
        Options besides `REPRODUCIBLE`.

    Notes
    -----
    gmsh is one global state: sessions of several threads wait for each other, and a session inside
    a caller's own gmsh session puts the caller's model, view of it and options back.
    """
    gmsh = load_gmsh()
    wanted = {**REPRODUCIBLE, **options}
    with _one_at_a_time:
        if gmsh.isInitialized():
            with _as_guest(gmsh, wanted), _own_model(gmsh, name):
                yield gmsh
            return
        gmsh.initialize([], readConfigFiles=False, run=False, interruptible=False)
        try:
            _set_options(gmsh, wanted)
            with _own_model(gmsh, name):
                yield gmsh
        finally:
            gmsh.finalize()


@contextmanager
def _own_model(gmsh: ModuleType, name: str) -> Iterator[None]:
    gmsh.model.add(name)
    try:
        yield
    finally:
        gmsh.model.remove()


@contextmanager
def _as_guest(gmsh: ModuleType, wanted: Mapping[str, float]) -> Iterator[None]:
    model = gmsh.model.getCurrent()
    options = {name: gmsh.option.getNumber(name) for name in wanted}
    try:
        _set_options(gmsh, wanted)
        yield
    finally:
        _set_options(gmsh, options)
        gmsh.model.setCurrent(model)


def _set_options(gmsh: ModuleType, values: Mapping[str, float]) -> None:
    for name, value in values.items():
        gmsh.option.setNumber(name, value)
