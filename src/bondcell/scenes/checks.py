"""What must hold between the keys of a scene: completeness, contradictions, ranges, size."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from bondcell.cell import LONG_NAMES, REQUIRED, UNITS, Cell, FloatArray
from bondcell.errors import InputError, Violation
from bondcell.results.names import models_with
from bondcell.scenes.design_checks import design_violations
from bondcell.scenes.keys import KeyPath
from bondcell.scenes.likely_units import unlikely
from bondcell.scenes.names import covering
from bondcell.scenes.points import shaped
from bondcell.scenes.prony_checks import prony_violations
from bondcell.scenes.ranges import MOST_POINTS, Span
from bondcell.scenes.specimen_checks import specimen_violations
from bondcell.scenes.sweep import DERIVED, resolve_inputs

if TYPE_CHECKING:
    from bondcell.scenes.blocks import Case
    from bondcell.scenes.scene import Scene

_NEUTRAL = {name: 0.0 if UNITS[name] == "1" else 1.0 for name in UNITS}
"""Stands in for what is missing or wrong, so that the rest can be checked."""

ATLAS_AXES = ("gap_ratio", "modulus_ratio", "poisson_m")
"""Axes that an accuracy atlas is drawn over."""

_BASE = {"young_m": "young_i", "gap": "radius_i", "radius_j": "radius_i"}
"""Input set by a ratio -> the input the ratio refers to."""


def joint_violations(scene: Scene, bad: Collection[KeyPath]) -> Iterator[Violation]:
    """Everything that is wrong between keys, or with values once they are put together.

    Parameters
    ----------
    scene
        A scene whose wrong parts, if any, were left out.
    bad
        Paths of these parts: nothing is said about what follows from their absence.
    """
    yield from _request_violations(scene, bad)
    yield from _contradictory_axes(scene)
    wrong = {str(path[1]) for path in bad if path[0] in ("cell", "sweep") and len(path) > 1}
    wrong |= {DERIVED[name] for name in wrong if name in DERIVED}
    incomplete = ("cell",) in bad or ("sweep",) in bad or any(path[0] == "design" for path in bad)
    unsampled = scene.design is not None and not scene.design.is_complete
    incomplete = incomplete or unsampled
    given = scene.cell.given()
    yield from _range_violations(given, "cell.")
    spread = scene.sweep or scene.design
    asked = scene.has_points or spread or {("models",), ("reference",)} & set(bad)
    if asked and not incomplete and scene.specimen is None:
        axes = (*scene.axis_names, *_designed(scene))
        supplied = {*given, *axes, *(DERIVED[name] for name in axes if name in DERIVED), *wrong}
        for name in REQUIRED:
            if name not in supplied:
                yield _required(f"cell.{name}", name, "or swept")
    yield from _rigid_violations(scene, given, wrong, incomplete)
    if scene.points > MOST_POINTS:
        block = "sweep" if scene.sweep else "design"
        yield Violation(block, f"{scene.points} points", f"at most {MOST_POINTS} points")
    else:
        yield from _axis_violations(given, scene)
    yield from design_violations(scene, bad)
    yield from _case_violations(scene, given, wrong, incomplete)
    yield from prony_violations(scene, bad)
    yield from specimen_violations(scene)


def unit_warnings(scene: Scene) -> list[str]:
    """Values that are allowed, but whose unit was probably forgotten."""
    places: dict[str, Any] = {f"cell.{k}": v for k, v in scene.cell.given().items()}
    places |= {f"sweep.{name}": values for name, values in scene.axes.items()}
    ends = {name: np.array([span.start, span.stop]) for name, span in _spans(scene).items()}
    filled = ends or scene.samples
    places |= {f"{_design_block(scene)}.{name}": values for name, values in filled.items()}
    if scene.convergence:
        for name, case in scene.convergence.cases.items():
            places |= {f"convergence.cases.{name}.{k}": v for k, v in case.given().items()}
    found = {place: unlikely(place.rpartition(".")[2], values) for place, values in places.items()}
    return [f"{place} = {oddity}" for place, oddity in found.items() if oddity]


def _request_violations(scene: Scene, bad: Collection[KeyPath]) -> Iterator[Violation]:
    something = {("models",), ("reference",)} & set(bad)
    if (scene.sweep or scene.design) and not (scene.has_points or something):
        spread = "sweep" if scene.sweep else "design"
        yield Violation("models", None, f"at least one model, or a reference, for the {spread}")
    elif not (scene.has_points or _other_work(scene, bad) or something):
        words = "something to compute: models, reference, convergence or specimen"
        yield Violation("models", None, words)
    if scene.contributions and "fsi" not in scene.models and ("models",) not in bad:
        yield Violation("contributions", True, "true only with fsi among the models")
    block = scene.convergence
    ladder = block and (block.orders or block.gradings or block.sizes)
    if scene.convergence and not (ladder or any(path[0] == "convergence" for path in bad)):
        yield Violation(
            "convergence", None, "with orders or sizes (or gradings): a ladder to climb"
        )
    if scene.stability and scene.reference is None and ("reference",) not in bad:
        yield Violation("stability", True, "true only with a reference")
    yield from _atlas_violations(scene, bad)
    yield from _load_violations(scene)


def _other_work(scene: Scene, bad: Collection[KeyPath]) -> bool:
    """Whether there is something to do besides the points of a sweep."""
    wanted = scene.convergence or scene.specimen
    return bool(wanted) or any(path[0] in ("convergence", "specimen") for path in bad)


def _atlas_violations(scene: Scene, bad: Collection[KeyPath]) -> Iterator[Violation]:
    sources = {"models": scene.models, "reference": scene.reference, "sweep": scene.sweep}
    if not scene.atlas or any((name,) in bad for name in sources):
        return
    axes = set(ATLAS_AXES) <= {*scene.axis_names, *(str(path[-1]) for path in bad)}
    if not (axes and all(sources.values())):
        words = f"models, a reference and the axes {', '.join(ATLAS_AXES)}"
        yield Violation("atlas", True, f"true only with {words}")


def _load_violations(scene: Scene) -> Iterator[Violation]:
    """A model needs one of the loads, a load one that covers it, a condition the normal load."""
    loads = {*scene.loads, *(case.load for case in _cases(scene).values() if case.load)}
    for i, name in enumerate(scene.models):
        able = covering(loads)
        if name not in able:
            words = f"the load {' or '.join(scene.loads)}"
            known = ", ".join(other for other in able if other != "fe") or "none; leave it out"
            yield Violation(f"models.{i}", name, f"a model that covers {words}: {known}")
    for load in scene.loads if scene.has_points else ():
        if scene.reference is None and not models_with(scene, load):
            allowed = f"a load that one of the models covers; of {load} they know nothing"
            yield Violation("load", load, allowed)
    condition = "left out: only the load normal has boundary conditions"
    reference = scene.reference
    if reference and "normal" not in scene.loads and "bc" in reference.model_fields_set:
        yield Violation("reference.bc", ", ".join(reference.bc), condition)
    for name, case in _cases(scene).items():
        if case.bc and (case.load or scene.load) != "normal":
            yield Violation(f"convergence.cases.{name}.bc", case.bc, condition)


def _cases(scene: Scene) -> Mapping[str, Case]:
    return scene.convergence.cases if scene.convergence else {}


def _contradictory_axes(scene: Scene) -> Iterator[Violation]:
    blocks = dict.fromkeys(scene.axis_names, "sweep")
    for name in _designed(scene):
        if name in blocks:
            allowed = "another parameter: this one is an axis of the sweep"
            yield Violation(f"{_design_block(scene)}.{name}", f"beside sweep.{name}", allowed)
        blocks.setdefault(name, _design_block(scene))
    for ratio, name in DERIVED.items():
        if ratio in blocks and name in blocks:
            allowed = f"one of the axes {name} and {ratio}, not both: both set {name}"
            field = f"{blocks[ratio]}.{ratio}"
            yield Violation(field, f"beside {blocks[name]}.{name}", allowed)


def _design_block(scene: Scene) -> str:
    """Where a parameter of the design stands."""
    return "design.table" if scene.design and scene.design.table else "design.ranges"


def _designed(scene: Scene) -> tuple[str, ...]:
    return scene.design.names if scene.design else ()


def _rigid_violations(
    scene: Scene, given: Mapping[str, float], wrong: Collection[str], incomplete: bool
) -> Iterator[Violation]:
    """Rigid particles need a matrix of their own, and no other axis that sets their modulus."""
    swept = scene.sweep is not None and scene.sweep.has_rigid_ratio
    tabled = scene.design is not None and scene.design.has_rigid_ratio
    if not (swept or tabled):
        return
    if not ("young_m" in given or "young_m" in wrong or incomplete):
        yield _required("cell.young_m", "young_m", "beside the modulus ratio rigid")
    block = "sweep" if swept else "design.table"
    for name in ("young_i", "young_j"):
        if name in scene.axis_names or name in _designed(scene):
            allowed = f"finite ratios beside the axis {name}, which can say rigid itself"
            yield Violation(f"{block}.modulus_ratio", "rigid", allowed)


def _required(field: str, name: str, where: str) -> Violation:
    unit = "" if UNITS[name] == "1" else f" [{UNITS[name]}]"
    return Violation(field, None, f"the {LONG_NAMES[name]}{unit}: required here {where}")


def _axis_violations(given: Mapping[str, float], scene: Scene) -> Iterator[Violation]:
    """What is wrong with swept values; of ranges that a design fills every corner must be good."""
    ends = {name: np.array([s.start, s.stop]) for name, s in _spans(scene).items()}
    axes, samples = {**ends, **scene.axes}, {} if ends else scene.samples
    blocks = dict.fromkeys({**ends, **samples}, _design_block(scene))
    blocks |= dict.fromkeys(scene.axes, "sweep")
    usable = {name: axes[name] for name in axes if DERIVED.get(name) not in blocks}
    rows = {n: samples[n] for n in samples if DERIVED.get(n) not in blocks and n not in usable}
    on_axes = shaped(usable, rows)
    usable |= rows
    inputs = resolve_inputs({**_NEUTRAL, **given}, on_axes)
    ratios = {DERIVED[name]: name for name in usable if name in DERIVED}
    known = {*given, *usable, *ratios}
    found = list(_range_violations({k: v for k, v in inputs.items() if k in known}, ""))
    wrong = {violation.field for violation in found}
    for violation in found:
        name = violation.field
        if name in usable:
            yield Violation(f"{blocks[name]}.{name}", violation.value, violation.allowed)
        elif name not in ratios:
            yield Violation(f"cell.{name}", violation.value, violation.allowed)
        elif _BASE[name] not in wrong:
            field = f"{blocks[ratios[name]]}.{ratios[name]}"
            yield _ratio_violation(field, violation, inputs[name], on_axes[ratios[name]])


def _spans(scene: Scene) -> Mapping[str, Span]:
    return scene.design.spans() if scene.design else {}


def _ratio_violation(
    field: str, violation: Violation, derived: FloatArray, ratios: FloatArray
) -> Violation:
    """Blame the value of the ratio for the derived input that is out of range."""
    at = np.flatnonzero(derived.ravel() == violation.value)[0]
    value = np.broadcast_to(ratios, derived.shape).ravel()[at]
    allowed = f"one that puts {violation.field} in {violation.allowed}"
    gives = f"it gives {violation.field} = {violation.value:g}"
    return Violation(field, float(value), f"{allowed}; {gives}")


def _case_violations(
    scene: Scene, given: Mapping[str, float], wrong: Collection[str], incomplete: bool
) -> Iterator[Violation]:
    if scene.convergence is None:
        return
    for case, overrides in scene.convergence.cases.items():
        place = f"convergence.cases.{case}"
        values = {**given, **overrides.given()}
        for name in REQUIRED:
            if not (name in values or name in wrong or incomplete):
                yield _required(f"cell.{name}", name, f"or in {place}")
        for violation in _range_violations(values, ""):
            block = place if violation.field in overrides.given() else "cell"
            yield Violation(f"{block}.{violation.field}", violation.value, violation.allowed)


def _range_violations(values: Mapping[str, Any], prefix: str) -> Iterator[Violation]:
    """Violations that `Cell` finds, without those of values nobody gave."""
    filled = {**{name: _NEUTRAL[name] for name in REQUIRED}, **values}
    if "radius_i" not in values:
        filled.pop("cylinder_radius", None)
    try:
        Cell.from_values(**filled)
    except InputError as error:
        for violation in error.violations:
            if violation.field in values:
                field = prefix + violation.field
                yield Violation(field, violation.value, violation.allowed)
