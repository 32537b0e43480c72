"""Identities of a scene and of its parts: what changed, and so what has to be computed again."""

from __future__ import annotations

import hashlib
import json
from typing import TYPE_CHECKING, Any

import numpy as np

from bondcell.cell import Cell, FloatArray

if TYPE_CHECKING:
    from bondcell.scenes.scene import Scene


def everything(scene: Scene) -> str:
    """Digest of the parsed content: ``0.5 mm`` is ``5e-4``, the order of the axes counts."""
    content = scene.model_dump(exclude_none=True)
    if scene.prony:
        content["prony"] = [content["prony"], _prony_content(scene)]
    if scene.design:
        rows = scene.design.values() if scene.design.table else {}
        table = {name: _array(values) for name, values in rows.items()}
        content["design"] = [content["design"], table]
    if scene.sweep:
        content["sweep"] = [(name, content["sweep"][name]) for name in scene.axes]
    if scene.convergence:
        content["convergence"]["cases"] = list(content["convergence"]["cases"].items())
    return _digest(content)


def convergence(scene: Scene) -> str:
    """Digest of what the convergence study depends on."""
    block = scene.convergence
    if block is None:
        return _digest(None)
    cases = [(name, case.load, case.bc, _cell(case.cell)) for name, case in scene.cases().items()]
    ladders = [block.orders, block.gradings, block.sizes, block.basis_order]
    return _digest([cases, ladders, block.repeats, scene.models])


def prony(scene: Scene) -> str:
    """Digest of what relaxation depends on besides the points, the models and their options."""
    return _digest(_prony_content(scene))


def specimen(scene: Scene) -> str:
    """Digest of what the specimen's results depend on."""
    if scene.specimen is None:
        return _digest(None)
    return _digest([scene.cell.given(), scene.specimen.model_dump(mode="json")])


def methods(scene: Scene) -> str:
    """Digest of what the comparison of methods in time depends on."""
    if scene.prony is None or scene.prony.methods is None:
        return _digest(None)
    cell, block = scene.cell.given(), scene.prony.methods.model_dump()
    return _digest([cell, block, scene.load, list(scene.fe_names.values()), _prony_content(scene)])


def _prony_content(scene: Scene) -> Any:
    block = scene.prony
    if block is None:
        return None
    cases = [case.model_dump(mode="json") for case in block.cases()]
    axes = [_array(block.times.values()), _array(np.asarray(block.dynamic_frequencies))]
    shifts = [block.known_material(name).model_dump(include=_SHIFTS) for name in block.materials]
    return [cases, block.conventions, axes, shifts, block.checks]


_SHIFTS = {"temperature", "wlf", "arrhenius"}


def _cell(cell: Cell) -> dict[str, Any]:
    return {name: _array(values) for name, values in cell.as_dict().items()}


def _array(values: FloatArray) -> Any:
    little_endian = np.ascontiguousarray(values + 0.0, dtype="<f8")  # + 0.0: no negative zero
    return [values.shape, hashlib.sha256(little_endian.tobytes()).hexdigest()]


def _digest(content: Any) -> str:
    text = json.dumps(content, sort_keys=True, separators=(",", ":"))
    return hashlib.sha256(text.encode()).hexdigest()
