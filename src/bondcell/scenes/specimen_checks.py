"""What must hold between the specimen block of a scene and its other keys."""

from __future__ import annotations

from collections.abc import Iterator
from math import isinf
from typing import TYPE_CHECKING

from bondcell.errors import Violation
from bondcell.scenes.specimen_block import LARGEST_POISSON, SpecimenBlock
from bondcell.specimen.names import LOWEST

if TYPE_CHECKING:
    from bondcell.scenes.scene import Scene

MODULI = ("young_i", "poisson_i", "young_m", "poisson_m")
"""Inputs of the cell that the specimen takes; its geometry is the paper's."""

_ALONE = ("models", "reference", "sweep", "convergence", "prony")


def specimen_violations(scene: Scene) -> Iterator[Violation]:
    """Everything that is wrong between the block and the rest.

    Parameters
    ----------
    scene
        A scene whose wrong parts, if any, were left out.
    """
    block = scene.specimen
    if block is None:
        return
    for key in _ALONE:
        if getattr(scene, key):
            yield Violation(key, "beside specimen", "left out: the specimen is a scene of its own")
    given = scene.cell.given()
    for name, value in given.items():
        if name not in MODULI:
            allowed = "left out: the specimen's geometry is the paper's, its particles are alike"
            yield Violation(f"cell.{name}", value, allowed)
    poisson = given.get("poisson_m", 0.0)
    if block.needs_meshes and poisson > LARGEST_POISSON:
        allowed = f"at most {LARGEST_POISSON} where the specimen is meshed"
        yield Violation("cell.poisson_m", poisson, allowed)
    elastic = block.elastic or (block.finite_strain and "fe_elastic" in block.finite_strain.methods)
    if elastic and isinf(given.get("young_i", 0.0)):
        yield Violation("cell.young_i", "rigid", "a finite modulus beside elastic particles")
    yield from _relaxation_violations(block)


def _relaxation_violations(block: SpecimenBlock) -> Iterator[Violation]:
    wanted = block.relaxation
    if wanted is None or wanted.convention != "constant_bulk":
        return
    whole = sum(wanted.series.weights)
    long_term = wanted.series.relative_to == "long_term"
    left = 1 / (1 + whole) if long_term else 1 - whole
    if left < LOWEST:
        allowed = f"weights that leave at least {LOWEST:g} of the modulus at constant bulk modulus"
        yield Violation("specimen.relaxation.series", f"{left:g} left", allowed)
