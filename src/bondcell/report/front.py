"""The first screen: main findings in figures, three of them in words, one interactive figure."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from bondcell.report.findings import Finding
from bondcell.report.interactive.cost_chart import cost_chart
from bondcell.report.interactive.cost_points import cost_points
from bondcell.report.interactive.figure import InteractiveFigure
from bondcell.report.scene_figures import TIME
from bondcell.report.sections import Section
from bondcell.results.view import analytic_names, reference_names

TOPICS = (
    "series model",
    "best formula",
    "particles",
    "cost",
    "lattice",
    "shortcut",
    "relaxation",
    "extremes",
    "printed",
    "ranking",
    "lower bound",
    "checks",
    "methods",
    "reduced basis",
)
"""What matters most to a reader comes first."""

HEADLINES, SENTENCES = 6, 3
"""Most findings on the first screen as figures, and in words."""

Shown = tuple[Section, Finding]


@dataclass(frozen=True)
class Front:
    """What stands on the first screen.

    Parameters
    ----------
    headlines
        Findings with their sections.
    sentences
        The first of them in words.
    chief
        The interactive figure with its section, None where no scene has one.
    cost
        Error against run time of models and finite elements together.
    """

    headlines: list[Shown]
    sentences: list[str]
    chief: tuple[Section, InteractiveFigure] | None
    cost: InteractiveFigure | None


def front(sections: Sequence[Section]) -> Front:
    """Choose what stands on the first screen.

    Parameters
    ----------
    sections
        The page's sections in order.
    """
    shown = headlines(sections)
    sentences = [finding.brief or finding.text for _, finding in shown[:SENTENCES]]
    return Front(shown, sentences, _chief(sections), _cost(sections))


def headlines(sections: Iterable[Section]) -> list[Shown]:
    """Findings for the first screen: of each topic the one that comes first on the page.

    Parameters
    ----------
    sections
        The page's sections in order.
    """
    first: dict[str, Shown] = {}
    for section in sections:
        for finding in section.findings:
            if finding.key:
                first.setdefault(finding.topic, (section, finding))
    if "best formula" in first:
        first.pop("ranking", None)  # it ranks some formulas, in a part of what the other covers
    known = [topic for topic in TOPICS if topic in first]
    others = [topic for topic in first if topic not in TOPICS]
    return [first[topic] for topic in (*known, *others)][:HEADLINES]


def _chief(sections: Sequence[Section]) -> tuple[Section, InteractiveFigure] | None:
    """The figure that compares most models over most axes."""
    found = [
        (section, section.interactive[0])
        for section in sections
        if section.interactive and _is_compared(section)
    ]
    return max(found, key=lambda pair: _breadth(pair[1]), default=None)


def _is_compared(section: Section) -> bool:
    """Whether its figure shows errors of models over a sweep."""
    return section.ladders is None and any(
        reference_names(study) and analytic_names(study) for study in section.loads.values()
    )


def _breadth(figure: InteractiveFigure) -> int:
    return len(figure.choices) * len(figure.switches)


def _cost(sections: Sequence[Section]) -> InteractiveFigure | None:
    """Models over the first atlas beside the ladders of the first convergence study."""
    atlas = next((section.loads for section in sections if section.is_atlas), None)
    ladders = next((s.ladders for s in sections if s.ladders is not None), None)
    if atlas is None or ladders is None:
        return None  # each by itself stands in its own section
    return cost_chart(
        cost_points(atlas, ladders),
        "cost",
        "Load",
        "Error against run time. A model: its median error over all cells of the atlas, the line "
        "up to its largest inside its stated range, and its time a point of that sweep. Finite "
        "elements of the atlas: their own estimate. Ladders: finite elements on one cell by "
        "itself, set-up and mesh included, against their finest level.",
        against={"seconds": TIME},
    )
