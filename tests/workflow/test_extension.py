"""A study that grows or shrinks: only new points are computed, old files stay as they are."""

import os

import numpy as np
import pytest
import xarray as xr

from bondcell.jobs.manifest import read_manifest
from bondcell.storage import read_dataset

SCENE = """\
title: It grows
cell: {radius_i: 7.5 mm, young_i: 30 GPa, poisson_i: 0.25, poisson_m: 0.3}
sweep: {gap: [0.5 mm, 2 mm], modulus_ratio: [10, 1e4]}
models: [fsi]
reference: {tolerance: 1e-2}
load: [normal, torsion]
"""
STUDY = "results/grows/study.nc"
BATCHES = "results/grows/batches"


class Growing:
    """A workspace, and what its last run did."""

    def __init__(self, workspace):
        self.workspace = workspace
        self.folder = workspace / BATCHES

    def run(self, *changes):
        """Compute the scene with words changed; points that each job computed, and the study."""
        text = SCENE
        for old, new in changes:
            assert old in text
            text = text.replace(old, new)
        self.workspace.write("params/grows.yaml", text)
        before = self.files()
        done = self.workspace.snakemake(STUDY)
        assert done.returncode == 0, done.stdout
        assert {name: content for name, content in self.files().items() if name in before} == before
        new = [read_dataset(self.folder / name) for name in self.files().keys() - before.keys()]
        points = sorted((str(batch["model"].values[0]), batch.sizes["point"]) for batch in new)
        return points, read_dataset(self.workspace / STUDY)

    def files(self):
        """Name -> bytes and time of every batch."""
        found = sorted(self.folder.glob("*.nc"))
        return {path.name: (path.read_bytes(), path.stat().st_mtime_ns) for path in found}


@pytest.fixture(scope="module")
def growing(make_workspace, tmp_path_factory):
    workspace = make_workspace(tmp_path_factory.mktemp("grows"), grows=SCENE)
    del workspace.environment["MODULES_FOLDER"]
    growing = Growing(workspace)
    points, _ = growing.run()
    assert points == [("fe_roller", 4), ("fe_torsion", 2 * 2)]
    return growing


def values(study):
    return study.drop_vars("seconds")


def test_another_gap_instead_of_one_computes_its_points_alone(growing):
    points, study = growing.run(("gap: [0.5 mm, 2 mm]", "gap: [3 mm, 5e-4]"))
    assert points == [("fe_roller", 2), ("fe_torsion", 2)]
    assert (study["status"].sel(model="fe") == 0).all()
    assert study["gap"].values.tolist() == [3e-3, 5e-4]


@pytest.mark.slow
def test_an_added_gap_computes_its_points_alone(growing):
    points, study = growing.run(("gap: [0.5 mm, ", "gap: [0.5 mm, 1 mm, "))
    assert points == [("fe_roller", 2), ("fe_torsion", 2)]
    assert (study["status"].sel(model="fe") == 0).all()
    assert study["gap"].values.tolist() == [5e-4, 1e-3, 2e-3]


@pytest.mark.slow
def test_removed_and_turned_points_compute_nothing(growing):
    turned = (
        "gap: [0.5 mm, 2 mm], modulus_ratio: [10, 1e4]",
        "modulus_ratio: [10000], gap: [2 mm, 5e-4]",
    )
    points, study = growing.run(turned)
    assert points == []
    assert study["stiffness"].dims == ("model", "modulus_ratio", "gap")
    assert (study["status"] == 0).all()
    assert (np.diff(study["stiffness"].sel(model="fe").values) > 0).all()


@pytest.mark.slow
def test_another_way_to_say_a_gap_is_the_same_point(growing):
    _, whole = growing.run()
    points, study = growing.run(("gap: [0.5 mm, 2 mm]", "gap_ratio: [0.06666666666666667, 1]"))
    assert points == [("fe_roller", 2), ("fe_torsion", 2)]  # a gap of one radius is new
    same = study["stiffness"].isel(gap_ratio=0), whole["stiffness"].isel(gap=0)
    np.testing.assert_array_equal(*same)


@pytest.mark.slow
def test_a_condition_or_a_load_computes_its_own_rows_alone(growing):
    points, study = growing.run(("{tolerance", "{bc: [confined, roller], tolerance"))
    assert points == [("fe_confined", 4)]
    assert study["model"].values.tolist() == ["fsi", "fe", "fe_roller"]
    assert (study["stiffness"].sel(model="fe") > study["stiffness"].sel(model="fe_roller")).all()
    points, _ = growing.run(("load: [normal, torsion]", "load: [torsion, normal]"))
    assert points == []
    points, _ = growing.run(("tolerance: 1e-2", "tolerance: 1e-3"))
    assert points == [("fe_roller", 4), ("fe_torsion", 4)]


@pytest.mark.slow
def test_a_lost_or_damaged_manifest_is_written_again(growing):
    points, whole = growing.run()
    entries = {entry.name for entry in read_manifest(growing.folder)}
    files = sorted((growing.folder / "manifest").iterdir())
    files[0].unlink()
    files[1].write_bytes(files[1].read_bytes()[:-100])
    (growing.workspace / STUDY).unlink()
    points, study = growing.run()
    assert points == []
    assert {entry.name for entry in read_manifest(growing.folder)} == entries
    xr.testing.assert_equal(values(study), values(whole))


def test_what_only_looks_records_nothing(growing):
    growing.workspace.write("params/grows.yaml", SCENE.replace("2 mm", "4 mm"))
    before = sorted(os.listdir(growing.folder / "manifest"))
    planned = growing.workspace.snakemake("--dry-run", STUDY)
    assert "reference        2" in planned.stdout
    assert sorted(os.listdir(growing.folder / "manifest")) == before


@pytest.mark.slow
def test_forced_runs_compute_the_same_again(growing):
    _, whole = growing.run()
    growing.workspace.write("params/grows.yaml", SCENE.replace("[10, 1e4]", "[10]"))
    done = growing.workspace.snakemake("--forceall", STUDY)
    assert done.returncode == 0, done.stdout
    study = read_dataset(growing.workspace / STUDY)
    np.testing.assert_array_equal(study["stiffness"], whole["stiffness"].isel(modulus_ratio=[0]))
