"""What must hold between the prony block of a scene and its other keys."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterator
from typing import TYPE_CHECKING

import numpy as np

from bondcell.errors import Violation
from bondcell.relaxing_ranges import TIMES
from bondcell.results.names import result_names
from bondcell.scenes.keys import KeyPath
from bondcell.scenes.materials import Material
from bondcell.scenes.prony_block import MOST_SERIES, PronyBlock

if TYPE_CHECKING:
    from bondcell.scenes.scene import Scene

MOST_VALUES = 50_000_000
"""Most values of K(t) in a scene."""


def prony_violations(scene: Scene, bad: Collection[KeyPath]) -> Iterator[Violation]:
    """Everything that is wrong between the block and the rest.

    Parameters
    ----------
    scene
        A scene whose wrong parts, if any, were left out.
    bad
        Paths of these parts.
    """
    block = scene.prony
    if block is None:
        return
    something = {("models",), ("reference",)} & set(bad)
    if not (scene.has_points or something):
        yield Violation("prony", None, "beside models or a reference, whose bonds relax")
    if block.own_modulus:
        yield from _own_modulus_violations(scene, block)
    yield from _temperature_violations(block)
    yield from _spectrum_violations(block)
    yield from _size_violations(scene, block)
    names = [case.name for case in block.cases()]
    for name in (name for name, count in Counter(names).items() if count > 1):
        yield Violation(f"prony.series.{name}", name, "a name of its own: another series has it")
    known = [name for name in result_names(scene) if name == "fe" or not name.startswith("fe_")]
    for i, model in enumerate(() if something else block.bond.models):
        if model not in known:
            allowed = f"one of this scene's {', '.join(known)}"
            yield Violation(f"prony.bond.models.{i}", model, allowed)
    if block.methods is not None:
        yield from _method_violations(scene, block, names, bad)


def _own_modulus_violations(scene: Scene, block: PronyBlock) -> Iterator[Violation]:
    if not block.materials:
        yield Violation("prony.own_modulus", True, "true only with named materials")
    for name in ("young_m", "modulus_ratio"):
        if name in scene.axis_names:
            yield Violation("prony.own_modulus", True, f"false beside the axis {name}")


def _temperature_violations(block: PronyBlock) -> Iterator[Violation]:
    if block.temperatures and not block.materials:
        allowed = "left out without named materials: only they know a temperature"
        yield Violation("prony.temperatures", f"{block.temperatures[0]:g} K", allowed)
    for i, name in enumerate(block.materials if block.temperatures else ()):
        if not block.has_material(name):
            continue
        material = block.known_material(name)
        if not material.has_shift:
            allowed = "a material with the constants of a shift, where temperatures are asked for"
            yield Violation(f"prony.materials.{i}", name, allowed)
            continue
        for k, temperature in enumerate(block.temperatures):
            allowed = _wrong_shift(material, name, temperature)
            if allowed:
                yield Violation(f"prony.temperatures.{k}", f"{temperature:g} K", allowed)


def _wrong_shift(material: Material, name: str, temperature: float) -> str:
    """What temperatures are allowed if this one is not, else nothing."""
    assert material.temperature is not None
    if material.wlf is not None and temperature <= material.temperature - material.wlf.c_2:
        pole = material.temperature - material.wlf.c_2
        return f"above {pole:g} K, the pole of the shift of {name}"
    with np.errstate(over="ignore"):
        factor = material.shift(temperature)
    if not (TIMES[0] <= factor * min(material.times) and factor * max(material.times) <= TIMES[1]):
        return f"one where the times of {name} stay in [{TIMES[0]:g}, {TIMES[1]:g}] s"
    return ""


def _spectrum_violations(block: PronyBlock) -> Iterator[Violation]:
    spectrum = block.spectrum
    for k, decades in enumerate(spectrum.decades if spectrum else ()):
        assert spectrum is not None
        reach = 10.0 ** (decades / 2)
        if not (TIMES[0] <= spectrum.centre / reach and spectrum.centre * reach <= TIMES[1]):
            allowed = f"times around {spectrum.centre:g} s in [{TIMES[0]:g}, {TIMES[1]:g}] s"
            yield Violation(f"prony.spectrum.decades.{k}", decades, allowed)


def _size_violations(scene: Scene, block: PronyBlock) -> Iterator[Violation]:
    series = len(block.cases())
    if series > MOST_SERIES:
        yield Violation("prony.spectrum", f"{series} series", f"at most {MOST_SERIES} series")
    rows = series * len(block.conventions) * max(1, len(result_names(scene)))
    values = scene.points * rows * (block.times.points + 1)
    if values > MOST_VALUES:
        allowed = f"at most {MOST_VALUES} of points, models, series, conventions, times"
        yield Violation("prony", f"{values} values of K(t)", allowed)


def _method_violations(
    scene: Scene, block: PronyBlock, names: list[str], bad: Collection[KeyPath]
) -> Iterator[Violation]:
    assert block.methods is not None
    for i, name in enumerate(block.methods.series):
        if name not in names:
            allowed = f"a series of this scene: {', '.join(names)}"
            yield Violation(f"prony.methods.series.{i}", name, allowed)
    if scene.reference is None and ("reference",) not in bad:
        yield Violation("prony.methods", None, "beside a reference: they are its methods")
    given = {*scene.cell.given()}
    needed = [name for name in scene.swept_inputs if name not in given]
    for name in needed:
        allowed = "a value besides the axis: methods are compared on the cell itself"
        yield Violation(f"cell.{name}", None, allowed)
