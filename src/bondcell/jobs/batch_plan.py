"""How many jobs a scene is cut into: an explicit cost model, jobs of a useful size."""

from __future__ import annotations

from collections.abc import Mapping
from math import ceil, prod
from typing import TYPE_CHECKING

from bondcell.cell import GEOMETRY
from bondcell.jobs.batch import ANALYTIC, REFERENCE, RELAXATION, Batch
from bondcell.results.names import all_variants, models_with

if TYPE_CHECKING:
    from bondcell.scenes.scene import Scene

JOB_SECONDS = 40.0
"""Work a job should have at most: far more than the second or two that its start costs."""

WORTH_A_JOB = 3.0
"""Analytic work below this is done where the scene is collected: no job of its own [s]."""

SECONDS_PER_ANALYTIC_POINT = 2e-5
"""Cost of one analytic model at one point, mean of quick and slow models [s]."""

LARGEST_ANALYTIC_BATCH = 1_000_000
"""Points of an analytic batch at most: bounds the memory of its job, some 50 bytes a model."""

SECONDS_PER_GEOMETRY = 0.5
"""Cost of meshing and assembling the finite element ladder of one geometry [s]."""

SECONDS_PER_STATE = 0.015
"""Cost of solving the ladder at one set of moduli of an assembled geometry [s]."""

SECONDS_PER_RELAXING_MODEL = 0.02
"""Cost of one series of one model under one convention [s], some more of each point."""

SECONDS_PER_RELAXING_STATE = 0.4
"""Cost of the reference's reduced model of one point and convention [s]."""

GEOMETRY_AXES = (*GEOMETRY, "gap_ratio", "radius_ratio")
"""Axes that change the mesh; along all others only the moduli change."""


def plan(scene: Scene) -> list[Batch]:
    """The batches of a scene's sweep, from the lengths of its axes alone.

    Parameters
    ----------
    scene
        Without a reference no finite element batch is planned; an analytic one only where there
        is enough to do.
    """
    sizes = {name: len(values) for name, values in scene.axes.items()}
    batches = []
    for load in scene.loads:
        method = ANALYTIC if load == scene.load else f"{ANALYTIC}_{load}"
        batches += analytic_batches(scene.points, len(models_with(scene, load)), method)
    return batches + reference_batches(sizes, all_variants(scene)) + relaxation_batches(scene)


def relaxation_batches(scene: Scene) -> list[Batch]:
    """Batches of relaxation, of models and of the reference under each load; a geometry is whole.

    Parameters
    ----------
    scene
        Without its prony block there are none.
    """
    block = scene.prony
    if block is None:
        return []
    axes = {name: len(values) for name, values in scene.axes.items()}
    geometries = prod(size for name, size in axes.items() if name in GEOMETRY_AXES)
    series = len(block.cases()) * len(block.conventions)
    ends = len({round(case.relaxing_share, 12) for case in block.cases()})
    found = []
    for load in scene.loads:
        models = len(models_with(scene, load))
        if models:
            one = models * SECONDS_PER_RELAXING_MODEL * series
            seconds = one * (1 + scene.points / 50) * (1 + block.checks / 10)
            found += _split(f"{RELAXATION}_models_{load}", geometries, seconds)
        if scene.reference is not None:
            states = scene.points * ends * len(block.conventions)
            seconds = states * SECONDS_PER_RELAXING_STATE * (1 + block.checks / 10)
            found += _split(f"{RELAXATION}_fe_{load}", geometries, seconds)
    return found


def analytic_batches(points: int, models: int, method: str = ANALYTIC) -> list[Batch]:
    """Batches of the analytic models; none where they are quicker than a job starts.

    Examples
    --------
    >>> analytic_batches(points=500, models=6)
    []
    >>> [batch.name for batch in analytic_batches(points=500_000, models=6)]
    ['analytic_1of2', 'analytic_2of2']
    """
    seconds = points * models * SECONDS_PER_ANALYTIC_POINT
    if seconds < WORTH_A_JOB:
        return []
    return _split(method, points, seconds, at_least=ceil(points / LARGEST_ANALYTIC_BATCH))


def reference_batches(sizes: Mapping[str, int], variants: tuple[str, ...]) -> list[Batch]:
    """Batches of the finite element reference; a geometry is never split.

    Parameters
    ----------
    sizes
        Axis -> number of its values.
    variants
        Boundary conditions of the normal load and other loads, each solved for itself.

    Examples
    --------
    >>> batches = reference_batches({"gap_ratio": 40, "poisson_m": 50}, ("roller",))
    >>> [batch.name for batch in batches]
    ['fe_roller_1of2', 'fe_roller_2of2']
    """
    geometries = prod(size for name, size in sizes.items() if name in GEOMETRY_AXES)
    states = prod(size for name, size in sizes.items() if name not in GEOMETRY_AXES)
    seconds = geometries * (SECONDS_PER_GEOMETRY + states * SECONDS_PER_STATE)
    return [
        batch
        for variant in variants
        for batch in _split(f"{REFERENCE}_{variant}", geometries, seconds)
    ]


def _split(method: str, items: int, seconds: float, at_least: int = 1) -> list[Batch]:
    parts = max(at_least, min(items, ceil(seconds / JOB_SECONDS)))
    return [Batch(method, part, parts) for part in range(1, parts + 1)]
