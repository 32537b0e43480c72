"""Which model to take for a cell, a load and a wanted error, and why not the paper's."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from bondcell.cell import Cell
from bondcell.errors import InputError, UnsupportedLoad, Violation
from bondcell.models import MODELS
from bondcell.models.asked import ask
from bondcell.reference_options import DEFAULT_TOLERANCE
from bondcell.results.accuracy_map import LOADS, AccuracyMap, shipped_map
from bondcell.results.paper_verdict import paper_verdict
from bondcell.wording import listed, model_phrase, number, percent, quantity

REFERENCE = "fe"

ERRORS = (DEFAULT_TOLERANCE, 1.0)
"""Closed interval of the errors that may be wanted."""

ERROR_RANGE = f"a number in [{ERRORS[0]:g}, {ERRORS[1]:g}]"
"""The same in words."""

MOST_MEASURED = 20
"""Cells that may be solved by finite elements for an advice."""


@dataclass(frozen=True)
class Candidate:
    """What one model promises for the cells.

    Parameters
    ----------
    model
        Name in ``bondcell.MODELS``.
    expected_error
        Size of the relative error to expect at the worst of the cells; NaN where nothing is known.
    error_low, error_high
        Signed errors around: from the map's neighbouring points, or measured at the cells.
    seconds
        Time a cell [s].
    inside_range
        Whether all cells are in the model's own valid range.
    is_formula
        Whether it is made without the finite element reference.
    """

    model: str
    expected_error: float
    error_low: float
    error_high: float
    seconds: float
    inside_range: bool
    is_formula: bool

    def serves(self, wanted: float) -> bool:
        """Whether it is good enough, and known to be."""
        return self.inside_range and self.expected_error <= wanted


@dataclass(frozen=True)
class Advice:
    """The model to take; printed, the reasons in words.

    Parameters
    ----------
    model
        The cheapest model that serves; ``fe`` where no other is known to.
    expected_error, seconds, inside_range
        Of this model, see `Candidate`.
    formula
        The cheapest that serves among the models made without finite elements, empty if none.
    wanted, load, cells
        What was asked, and for how many cells.
    source
        Where the errors come from: ``map``, ``measured`` at the cells, or ``none``.
    paper
        How the paper's model ``fsi`` does here and why, in words.
    notes
        What else has to be known.
    candidates
        All models of the load, the cheapest first.
    """

    model: str
    expected_error: float
    seconds: float
    inside_range: bool
    formula: str
    wanted: float
    load: str
    cells: int
    source: str
    paper: str
    notes: tuple[str, ...]
    candidates: tuple[Candidate, ...]

    def __str__(self) -> str:
        name = model_phrase(self.model)
        where = "inside" if self.inside_range else "outside"
        said = {"map": "expected", "measured": "measured", "none": "by its tolerance"}
        lines = [
            f"Take {name} (model={self.model!r}): error {said[self.source]} "
            f"{percent(self.expected_error)}, wanted {percent(self.wanted)}; "
            f"{quantity(self.seconds, 's', 2)} a cell; {where} its valid range.",
        ]
        if self.model != self.formula and not _is_formula(self.model):
            formula = f"The cheapest formula that serves is {self.formula!r}."
            lines.append(formula if self.formula else "No formula is known to serve.")
        return "\n".join([*lines, self.paper, *self.notes])


def advise(
    study: Mapping[str, Any], error: float = 0.01, load: str = "normal", measure: bool = False
) -> Advice:
    """Which model to take for a cell, or for many at once.

    Parameters
    ----------
    study
        Inputs of the cell as a mapping or an ``xarray.Dataset``, SI units, by the names that
        `bondcell.evaluate` takes. Of many cells the worst one counts.
    error
        Wanted relative error against finite elements.
    load
        ``"normal"`` (between frictionless plates), ``"shear"``, ``"torsion"`` or ``"bending"``.
    measure
        Solve the cells by finite elements and compare, instead of looking at the map; at most
        `MOST_MEASURED` cells.

    Returns
    -------
    Advice
        The model with its expected error and cost, all candidates, and the reasons in words.

    Raises
    ------
    InputError
        Names every wrong input with its value and what is allowed.

    Notes
    -----
    The expected error of a model is its largest one at the neighbouring points of the shipped
    accuracy map, times a margin measured at random cells. The map is about equal pairs in a
    cylinder of their radius. Off the map nothing is known of a model's error, and the advice is
    ``fe``.

    Examples
    --------
    >>> base = {"radius_i": 7.5e-3, "gap": 5e-4, "young_i": 3e10, "poisson_i": 0.25}
    >>> advice = advise(base | {"young_m": 1.4e6, "poisson_m": 0.46}, error=0.01)
    >>> advice.model, advice.formula
    ('surrogate', 'film')
    """
    return advise_cell(_cell(study), error, load, measure)


def advise_cell(cell: Cell, error: float, load: str, measure: bool = False) -> Advice:
    """As `advise`, of a checked cell of any shape."""
    _check(cell, error, load, measure)
    shipped = shipped_map()
    reasons = sorted({reason for reason in shipped.why_outside(cell) if reason})
    if measure:
        candidates, source = _measured(shipped, cell, load), "measured"
    else:
        candidates, source = _from_map(shipped, cell, load), "none" if reasons else "map"
    serving = [found for found in candidates if found.serves(error)]
    chosen = serving[0] if serving else next(c for c in candidates if c.model == REFERENCE)
    formulas = [found.model for found in serving if found.is_formula]
    return Advice(
        model=chosen.model,
        expected_error=chosen.expected_error,
        seconds=chosen.seconds,
        inside_range=chosen.inside_range,
        formula=formulas[0] if formulas else "",
        wanted=error,
        load=load,
        cells=cell.ravel().gap.size,
        source=source,
        paper=paper_verdict(shipped, cell, load, error, _named(candidates, "fsi")),
        notes=tuple(_notes(reasons, measure, bool(serving), error)),
        candidates=tuple(candidates),
    )


def _cell(study: Mapping[str, Any]) -> Cell:
    if hasattr(study, "data_vars"):
        from bondcell.inputs import cell_from_study

        return cell_from_study(study)[0]  # type: ignore[arg-type]
    try:
        given = {str(name): study[name] for name in study}
    except (TypeError, LookupError):
        allowed = "a mapping of inputs, or an xarray.Dataset"
        raise InputError([Violation("study", type(study).__name__, allowed)]) from None
    return Cell.from_values(**given)


def _check(cell: Cell, error: float, load: str, measure: bool) -> None:
    if load not in LOADS:
        raise UnsupportedLoad([Violation("load", load, f"one of {', '.join(LOADS)}")])
    violations = []
    is_number = isinstance(error, int | float | np.number) and not isinstance(error, bool)
    if not (is_number and ERRORS[0] <= error <= ERRORS[1]):
        violations.append(Violation("error", error, ERROR_RANGE))
    if measure not in (True, False):
        violations.append(Violation("measure", measure, "True or False"))
    cells = cell.ravel().gap.size
    if measure and cells > MOST_MEASURED:
        allowed = f"at most {MOST_MEASURED} cells to be solved by finite elements"
        violations.append(Violation("measure", f"{cells} cells", allowed))
    if violations:
        raise InputError(violations)


def _from_map(shipped: AccuracyMap, cell: Cell, load: str) -> list[Candidate]:
    """Every model of the load with what the map says, the cheapest first."""
    count = cell.ravel().gap.size
    found = []
    for name in shipped.codes[load]:
        expected = shipped.expected(load, name, cell)
        bounds = float(expected.error.max()), float(expected.low.min()), float(expected.high.max())
        seconds = shipped.seconds(load, name, count)
        found.append(_candidate(name, load, cell, bounds, seconds))
    return sorted([*found, _reference(shipped, load, count)], key=lambda c: c.seconds)


def _measured(shipped: AccuracyMap, cell: Cell, load: str) -> list[Candidate]:
    """The same with errors measured at the cells themselves."""
    from bondcell.by_geometry import solve_points
    from bondcell.fem.reference import solve

    flat = cell.ravel()
    solved = solve_points(flat, solve, load=load)
    truth = solved.stiffness
    found = []
    for name in shipped.codes[load]:
        error = ask(MODELS[name], load, flat)[0].stiffness / truth - 1
        bounds = float(np.abs(error).max()), float(error.min()), float(error.max())
        seconds = shipped.seconds(load, name, truth.size)
        found.append(_candidate(name, load, cell, bounds, seconds))
    own = float(np.fmax(DEFAULT_TOLERANCE, np.max(solved.error_estimate)))
    reference = _reference(shipped, load, truth.size, math.nan if np.isnan(truth).any() else own)
    return sorted([*found, reference], key=lambda candidate: candidate.seconds)


def _candidate(
    name: str, load: str, cell: Cell, bounds: tuple[float, float, float], seconds: float
) -> Candidate:
    model = MODELS[name]
    holds = bool(model.holds(load, cell).all())
    if model.from_reference:  # it states an error of its own
        own = float(np.max(ask(model, load, cell)[0].relative_error))
        bounds = (float(np.fmax(bounds[0], own)), *bounds[1:])
    return Candidate(name, *bounds, seconds, holds, _is_formula(name))


def _reference(
    shipped: AccuracyMap, load: str, count: int, error: float = DEFAULT_TOLERANCE
) -> Candidate:
    seconds = shipped.seconds(load, REFERENCE, count)
    return Candidate(REFERENCE, error, -error, error, seconds, True, False)


def _is_formula(name: str) -> bool:
    return not (MODELS[name].is_reference or MODELS[name].from_reference)


def _named(candidates: Iterable[Candidate], model: str) -> Candidate | None:
    return next((found for found in candidates if found.model == model), None)


def _notes(reasons: list[str], measure: bool, served: bool, error: float) -> Iterable[str]:
    if reasons and not measure:
        yield (
            f"Off the accuracy map: {listed(reasons)}. No error is known of the formulas here; "
            "measure=True (--measure) solves the cell and compares them."
        )
    if not served:
        yield f"No model is known to stay within {number(error)} here; fe takes a tolerance."
