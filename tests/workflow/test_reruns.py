"""An edit makes run again what depends on it, and nothing else."""

import pytest

REPORT = {"report": 1}
FULL = {
    "collect": 1,
    "accuracy": 1,
    "stability": 1,
    "convergence_table": 1,
    "figures": 1,
    "report": 1,
}
BOTH = FULL | {"collect": 2, "figures": 2}

SOURCES = {
    "src/bondcell/report/sections.py": REPORT,
    "src/bondcell/report/templates/report.html.j2": REPORT,
    "src/bondcell/figures/curves.py": REPORT | {"figures": 2},
    "src/bondcell/jobs/batch_plan.py": {},
    "src/bondcell/cli/__init__.py": {},
    "src/bondcell/evaluate.py": BOTH | {"convergence": 1},
    "src/bondcell/fem/cell_mesh.py": FULL | {"reference": 3, "convergence": 1},
    "src/bondcell/fem/gmsh_mesh.py": FULL | {"convergence": 1},
    "src/bondcell/fem/reference.py": FULL | {"reference": 3},
    "src/bondcell/jobs/merge.py": BOTH,
    "src/bondcell/models/fsi.py": BOTH | {"convergence": 1},
    "src/bondcell/storage.py": BOTH | {"reference": 3, "convergence": 1},
}

SCENES = {
    "remark": ("title: All", "# a remark\ntitle: All", {}),
    "same gap in other words": ("gap: [0.5 mm", "gap: [5.0e-4", {}),
    "title": ("title: All there is", "title: All", FULL),
    "models": ("models: [fsi, generatrix]", "models: [fsi]", FULL | {"convergence": 1}),
    "tolerance": ("tolerance: 1e-2", "tolerance: 1e-3", FULL | {"reference": 3}),
    "orders": ("orders: [3, 4]", "orders: [3, 5]", FULL | {"convergence": 1}),
    "gap": ("gap: [0.5 mm", "gap: [0.6 mm", FULL | {"reference": 3}),
}


@pytest.fixture(scope="module")
def plans(workspace):
    edits = {file: (file, "", "") for file in SOURCES}
    edits |= {name: ("params/full.yaml", old, new) for name, (old, new, _) in SCENES.items()}
    edits["same source"] = ("src/bondcell/storage.py", "import", "import")
    edits["same scene"] = ("params/full.yaml", "title", "title")
    return workspace.plans(edits)


@pytest.mark.parametrize("file", SOURCES)
def test_edit_of_a_source(plans, file):
    assert plans[file] == SOURCES[file]


@pytest.mark.parametrize("name", SCENES)
def test_edit_of_a_scene(plans, name):
    assert plans[name] == SCENES[name][2]


def test_newer_files_of_the_same_content_change_nothing(plans):
    assert plans["same source"] == {}
    assert plans["same scene"] == {}


def test_edited_script_really_runs_with_what_follows_it(workspace):
    study = workspace / "results/full/study.nc"
    before = study.stat().st_mtime_ns
    workspace.append("workflow/scripts/accuracy.py", "\n# edited\n")
    done = workspace.snakemake()
    assert done.returncode == 0
    assert set(workspace.modules()) == {"snakemake", "accuracy", "report"}
    assert study.stat().st_mtime_ns == before
