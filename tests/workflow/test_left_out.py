"""What a shipped scene does not ask for is not planned, not imported and not solved."""

import shutil

import pytest
import xarray as xr
import yaml
from edited_scenes import PARAMS, SCENES
from small_scenes import SMALL

import bondcell

NEEDS = {
    "analytic": lambda scene: "models" in scene,  # only where they are much work
    "reference": lambda scene: "reference" in scene,
    "relaxation_models": lambda scene: "prony" in scene and "models" in scene,
    "relaxation_fe": lambda scene: "prony" in scene and "reference" in scene,
    "relaxation_methods": lambda scene: "methods" in scene.get("prony", {}),
    "convergence": lambda scene: "convergence" in scene,
    "specimen_part": lambda scene: "specimen" in scene,
    "specimen_elastic": lambda scene: "elastic" in scene.get("specimen", {}),
    "collect": lambda scene: True,
    "accuracy": lambda scene: "models" in scene and "reference" in scene,
    "accuracy_over_time": lambda scene: {"prony", "models", "reference"} <= set(scene),
    "stability": lambda scene: "stability" in scene,
    "relaxation_stability": lambda scene: "checks" in scene.get("prony", {}),
    "convergence_table": lambda s: "convergence" in s or "methods" in s.get("prony", {}),
    "bond_series": lambda scene: "prony" in scene,
    "atlas_tables": lambda scene: "atlas" in scene,
    "specimen_vtk": lambda scene: "specimen" in scene,
    "specimen_field_vtk": lambda scene: "elastic" in scene.get("specimen", {}),
    "figures": lambda scene: True,
    "report": lambda scene: True,
}
"""Rule -> whether a scene, as it is written, asks for its jobs."""


@pytest.fixture(scope="module")
def shipped(make_workspace, tmp_path_factory):
    """A workspace with the shipped scenes, one of which is the study."""
    workspace = make_workspace(tmp_path_factory.mktemp("shipped"))
    shutil.copytree(PARAMS, workspace / "params", dirs_exist_ok=True)
    workspace.write("params/study.yaml", "scenes: [smoke]\n")
    return workspace


def test_plans_of_the_shipped_scenes(shipped):
    edits = {name: ("params/study.yaml", "[smoke]", f"[{name}]") for name in SCENES}
    for name, planned in shipped.plans(edits).items():
        wanted = {rule for rule, asked in NEEDS.items() if asked(SCENES[name])}
        assert wanted - {"analytic"} <= set(planned) <= wanted, name


PACKAGES = ("skfem", "gmsh", "pyamg", "matplotlib", "altair", "vl_convert", "jinja2")
PARTS = ("fem", "prony", "solid", "lattice")
SPECIMEN_TOO = {"lattice"}
"""Scenes of a specimen share the scripts that collect and draw: its geometry, in milliseconds."""


def allowed(script, scene):
    """Heavy packages, and parts of bondcell, that a script may load for a scene."""
    meshed = {"gmsh"} if scene.get("convergence", {}).get("sizes") else set()
    series = {"prony"} if "prony" in scene else set()
    return {
        "reference": {"skfem", "fem"},
        "convergence": {"skfem", "fem", *meshed},
        "relaxation_models": {"prony"},
        "relaxation_fe": {"skfem", "fem", "prony"},
        "relaxation_methods": {"skfem", "fem", "prony"},
        "specimen_part": {*PACKAGES[:3], *PARTS},
        "collect": series | SPECIMEN_TOO,
        "bond_series": {"prony"},
        "figures": {"matplotlib", *series, *SPECIMEN_TOO},
        "specimen_vtk": {"lattice", "solid", "fem"},  # to mesh nothing, but to write elements
        "specimen_field_vtk": {"lattice", "solid", "fem"},
    }.get(script, set())


def heavy(modules):
    """What of `PACKAGES` and `PARTS` is among the names of modules."""
    found = {name.split(".")[0] for name in modules} & set(PACKAGES)
    return found | {
        part for part in PARTS if any(m.startswith(f"bondcell.{part}.") for m in modules)
    }


@pytest.mark.slow
def test_jobs_of_the_shipped_scenes_load_what_they_need(shipped):
    """Each scene is cut down to a few points, but asks for the same kinds of work."""
    for name, scene in SMALL.items():
        shipped.write(f"params/{name}.yaml", yaml.safe_dump(scene, sort_keys=False))
    shipped.write("params/study.yaml", yaml.safe_dump({"scenes": sorted(SMALL)}))
    done = shipped.snakemake()
    assert done.returncode == 0, done.stdout
    loaded = shipped.modules_of_scenes()
    for name, scene in SMALL.items():
        scripts = {script for of_scene, script in loaded if of_scene == name}
        assert {"collect", "figures"} < scripts
        for script in scripts:
            more = heavy(loaded[name, script]) - allowed(script, scene)
            assert not more, (name, script, more)
    reports = [modules for (_, script), modules in loaded.items() if script == "report"]
    assert reports
    assert not heavy(set().union(*reports)) & {"skfem", "gmsh", "pyamg", "fem", "solid"}


def test_a_symmetric_pair_solves_half():
    """A pair that differs by one part in a million has nearly twice the unknowns."""
    cell = {"radius_i": 7.5e-3, "gap": 5e-4, "young_i": 3e10, "poisson_i": 0.25}
    matrix = {"young_m": 1.4e6, "poisson_m": 0.46}
    other = {"young_j": 3e10 * (1 + 1e-6)}
    alike, unlike = (
        bondcell.evaluate(xr.Dataset(cell | matrix | more), model="fe", tolerance=1e-3)
        for more in ({}, other)
    )
    assert alike.order == unlike.order
    assert 1.8 < float(unlike.dof / alike.dof) < 2.2
    assert abs(float(unlike.stiffness / alike.stiffness) - 1) < 1e-5
