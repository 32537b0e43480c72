"""A scene's parameters as they were given, line by line."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any

from bondcell.cell import LONG_NAMES
from bondcell.wording import MEANINGS, SYMBOLS, listed, model_name, number

if TYPE_CHECKING:
    from bondcell.scenes.scene import Scene

Line = tuple[str, str]


def setup_lines(scene: Scene) -> list[Line]:
    """What was asked for: pairs of a name with its symbol and the value as given.

    Parameters
    ----------
    scene
        A scene.
    """
    given: dict[str, Any] = json.loads(scene.given_json)
    lines = [(_label(name), _value(value)) for name, value in given.get("cell", {}).items()]
    lines += [
        (f"{_label(name)}, swept", _axis(axis)) for name, axis in (given.get("sweep") or {}).items()
    ]
    lines += list(_design(scene))
    if scene.models:
        lines.append(("models", listed(model_name(name) for name in scene.models)))
    lines += list(_reference(scene))
    if scene.specimen is not None:
        return [*lines, *_specimen(given.get("specimen") or {})]
    lines.append(("load" if len(scene.loads) == 1 else "loads", listed(scene.loads)))
    lines += list(_prony(scene))
    lines += list(_convergence(scene, given.get("convergence") or {}))
    return lines


def _design(scene: Scene) -> Iterator[Line]:
    design = scene.design
    if design is None:
        return
    if design.table is not None:
        names = listed(_label(name) for name in design.values())
        yield "points", f"{design.count()} of the table {design.table}: {names}"
        return
    kind = {"sobol": "Sobol' sequence", "latin_hypercube": "Latin hypercube"}[design.kind or ""]
    parts = f" in {len(design.points)} hypercubes" if len(design.points) > 1 else ""
    yield "points", f"{design.count()}{parts}, {kind}, seed {design.seed}"
    for name, span in design.spans().items():
        spacing = "logarithmic" if span.spacing == "log" else "even"
        ends = f"{_value(span.start)} to {_value(span.stop)}"
        yield f"{_label(name)}, sampled", f"{ends}, {spacing}"


def _reference(scene: Scene) -> Iterator[Line]:
    if scene.reference is not None:
        conditions = f"{listed(scene.reference.bc)}; " if "normal" in scene.loads else ""
        tolerance = number(scene.reference.tolerance)
        yield "finite element reference", f"{conditions}relative tolerance {tolerance}"


def _specimen(given: Mapping[str, Any]) -> Iterator[Line]:
    for name, label in (("elastic", "elastic particles"), ("rigid", "rigid particles")):
        for walls, sizes in (given.get(name) or {}).items():
            yield f"solid, {label}, {walls} sides: element sizes over the gap", _axis(sizes)
    for name in ("lattices", "loadings", "walls"):
        if name in given:
            yield name, listed(str(word).replace("_", " ") for word in given[name])
    if "relaxation" in given:
        series = given["relaxation"]["series"]
        yield "relaxation times of the matrix", _axis(series["times"])
        yield "weights", _axis(series["weights"])


def _prony(scene: Scene) -> Iterator[Line]:
    block = scene.prony
    if block is None:
        return
    if block.materials:
        of_own = ", with their own moduli" if block.own_modulus else ", times and weights of them"
        yield "materials", f"{listed(block.materials)}{of_own}"
    if block.series:
        yield "series given", listed(block.series)
    if block.spectrum is not None:
        spectrum = block.spectrum
        words = (
            f"terms {_listed_numbers(spectrum.terms)}; decades "
            f"{_listed_numbers(spectrum.decades)}; share that relaxes "
            f"{_listed_numbers(spectrum.relaxing)}; weights {listed(spectrum.profile)}"
        )
        yield "generated series", words
    yield "what relaxes", listed(name.replace("_", " ") for name in block.conventions)
    ends = f"{number(block.times.start)} s to {number(block.times.stop)} s"
    yield "times", f"{block.times.points} from {ends}, logarithmic spacing"


def _convergence(scene: Scene, given: Mapping[str, Any]) -> Iterator[Line]:
    if scene.convergence is None:
        return
    for name in scene.cases():
        changes = given.get("cases", {}).get(name, {})
        words = ", ".join(f"{SYMBOLS.get(k, k)} = {_value(v)}" for k, v in changes.items())
        yield f"case {name.replace('_', ' ')}", words or "the cell above"
    if scene.convergence.orders:
        yield "orders p of the structured mesh", _listed_numbers(scene.convergence.orders)
    if scene.convergence.gradings:
        ratios = _listed_numbers(scene.convergence.gradings)
        yield "ratios of neighbouring elements of the structured mesh, order 4", ratios
    if scene.convergence.basis_order:
        yield "order p under the reduced basis", str(scene.convergence.basis_order)
    if scene.convergence.sizes:
        yield "relative element sizes of the triangles", _listed_numbers(scene.convergence.sizes)
    yield "timed repeats", f"{scene.convergence.repeats}, of which the median is given"


def _label(name: str) -> str:
    meaning = LONG_NAMES.get(name) or MEANINGS.get(name) or name.replace("_", " ")
    return f"{meaning} {SYMBOLS[name]}" if name in SYMBOLS else meaning


def _value(value: Any) -> str:
    return number(value, 12) if isinstance(value, int | float) else str(value)


def _axis(axis: Any) -> str:
    if isinstance(axis, Mapping):
        spacing = {"log": "logarithmic"}.get(axis.get("spacing", "linear"), "even")
        return (
            f"{axis['points']} values from {_value(axis['start'])} to {_value(axis['stop'])}, "
            f"{spacing} spacing"
        )
    return _listed_numbers(axis) if isinstance(axis, list | tuple) else _value(axis)


def _listed_numbers(values: Any) -> str:
    return ", ".join(_value(value) for value in values)
