"""Faults of files: damaged batches are computed again, a disk that refuses loses nothing."""

import ctypes
import os
import resource
import subprocess
import sys
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
import yaml

from bondcell.errors import CannotWrite
from bondcell.jobs.batch_plan import plan
from bondcell.scenes.parsing import parse_scene
from bondcell.sealed_files import is_whole, seal
from bondcell.storage import read_dataset, write_dataset

SCENE = """\
title: Some points
cell: {radius_i: 7.5 mm, young_i: 30 GPa, young_m: 1 MPa, poisson_i: 0.25, poisson_m: 0.3}
sweep: {gap: [0.5 mm, 2 mm]}
models: [fsi]
reference: {tolerance: 1e-2}
"""
STUDY = "results/some/study.nc"
FINER = SCENE.replace("1e-2", "1e-3")


def batch_file(scene):
    name = plan(parse_scene(yaml.safe_load(scene))).needed[0]
    return f"results/some/batches/{name}.nc"


BATCH = batch_file(SCENE)


@pytest.fixture(scope="module")
def some(make_workspace, tmp_path_factory):
    """A workspace whose scene was computed, and what came out."""
    workspace = make_workspace(tmp_path_factory.mktemp("files"), some=SCENE)
    del workspace.environment["MODULES_FOLDER"]
    done = workspace.snakemake(STUDY)
    assert done.returncode == 0, done.stdout
    return workspace, read_dataset(workspace / STUDY)


def but_times(dataset):
    return dataset.drop_vars([name for name in dataset if "seconds" in name])


def truncate(content):
    return content[: len(content) // 2]


def flip_a_bit(content):
    middle = len(content) // 2
    return content[:middle] + bytes([content[middle] ^ 1]) + content[middle + 1 :]


def test_damaged_batch_is_computed_again(some):
    workspace, before = some
    batch = workspace / BATCH
    assert is_whole(batch)
    batch.write_bytes(flip_a_bit(batch.read_bytes()))
    (workspace / STUDY).unlink()
    done = workspace.snakemake(STUDY)
    assert done.returncode == 0, done.stdout
    assert f"{BATCH} does not match its checksum: removed" in done.stdout
    assert is_whole(batch)
    xr.testing.assert_identical(but_times(read_dataset(workspace / STUDY)), but_times(before))


@pytest.mark.slow
def test_damaged_batch_of_a_finished_study_is_computed_again(some):
    workspace, before = some
    assert workspace.snakemake().returncode == 0
    for damage in (truncate, flip_a_bit):
        batch = workspace / BATCH
        batch.write_bytes(damage(batch.read_bytes()))
        planned = workspace.snakemake("--dry-run")
        assert f"{BATCH} does not match its checksum: it would be removed" in planned.stdout
        assert batch.exists()
        done = workspace.snakemake()
        assert done.returncode == 0, done.stdout
        assert f"{BATCH} does not match its checksum: removed" in done.stdout
        assert is_whole(batch)
        xr.testing.assert_identical(but_times(read_dataset(workspace / STUDY)), but_times(before))
        assert "Nothing to be done" in workspace.snakemake().stdout


@pytest.mark.slow
def test_damaged_study_is_collected_again(some):
    workspace, before = some
    study = workspace / STUDY
    for damage in (truncate, flip_a_bit):
        assert is_whole(study)
        study.write_bytes(damage(study.read_bytes()))
        done = workspace.snakemake(STUDY)
        assert done.returncode == 0, done.stdout
        assert f"{STUDY} does not match its checksum: removed" in done.stdout
        assert "finite elements" not in done.stdout
        xr.testing.assert_identical(but_times(read_dataset(study)), but_times(before))


@pytest.mark.parametrize("damage", [truncate, flip_a_bit, lambda content: content + b" "])
def test_any_change_breaks_the_seal(tmp_path, damage):
    path = tmp_path / "batch.nc"
    path.write_bytes(np.random.default_rng(1).bytes(3_000_000))
    seal(path)
    assert is_whole(path)
    path.write_bytes(damage(path.read_bytes()))
    assert not is_whole(path)


def test_short_and_empty_files_have_no_seal(tmp_path):
    path = tmp_path / "batch.nc"
    for content in (b"", b"\nsha256 ", b"CDF"):
        path.write_bytes(content)
        assert not is_whole(path)


def test_stale_temporary_files_are_removed_by_the_next_writer(tmp_path):
    (tmp_path / ".study.nc.4711.tmp").write_bytes(b"half of a file whose writer was killed")
    (tmp_path / ".other.nc.4711.tmp").write_bytes(b"of another file")
    write_dataset(xr.Dataset({"gap": 1.0}), tmp_path / "study.nc")
    assert sorted(os.listdir(tmp_path)) == [".other.nc.4711.tmp", "study.nc"]


FULL_DISK = """\
import resource, sys, numpy as np, xarray as xr
from bondcell.errors import CannotWrite
from bondcell.storage import write_dataset
data = xr.Dataset({"a": ("x", np.random.default_rng(0).random(3000))})
size = write_dataset(data, sys.argv[1], sealed=True).stat().st_size
for limit in [*range(0, size - 100, 1999), *range(size - 100, size, 7)]:
    resource.setrlimit(resource.RLIMIT_FSIZE, (limit, resource.RLIM_INFINITY))
    try:
        write_dataset(2 * data, sys.argv[1], sealed=True)
    except CannotWrite as error:
        assert "cannot be written: File too large" in str(error), error
    else:
        sys.exit(f"written with a limit of {limit} of {size} bytes")
"""


def test_a_disk_that_fills_up_anywhere_leaves_the_old_file_and_nothing_else(tmp_path):
    path = tmp_path / "batch.nc"
    subprocess.run([sys.executable, "-c", FULL_DISK, path], check=True)
    assert is_whole(path)
    assert os.listdir(tmp_path) == [path.name]
    assert read_dataset(path).a.max() < 1


@contextmanager
def small_disk(folder, kilobytes):
    """A file system of that size, while the block runs, where this process may mount one."""
    folder.mkdir(exist_ok=True)
    options = ["mount", "-t", "tmpfs", "-o", f"size={kilobytes}k", "tmpfs", str(folder)]
    if sys.platform != "linux" or subprocess.run(options, check=False).returncode:
        pytest.skip("a small disk is a tmpfs, and mounting one needs root on Linux")
    try:
        yield
    finally:
        # The netCDF library may keep a file open that it could not write.
        subprocess.run(["umount", "--lazy", str(folder)], check=True)


def test_a_small_disk_that_is_full_keeps_the_old_file(tmp_path):
    folder, random = tmp_path / "disk", np.random.default_rng(0)
    with small_disk(folder, 256):
        path = write_dataset(xr.Dataset({"a": ("x", random.random(1000))}), folder / "study.nc")
        before = path.read_bytes()
        with pytest.raises(CannotWrite, match=r"No space left on device \([\d.e-]+ MB are free"):
            write_dataset(xr.Dataset({"a": ("x", random.random(100_000))}), path)
        assert path.read_bytes() == before
        assert os.listdir(folder) == [path.name]


@pytest.mark.slow
def test_results_on_a_small_disk_are_refused_and_then_computed(make_workspace, tmp_path):
    workspace = make_workspace(tmp_path, some=SCENE)
    with small_disk(workspace / "results", 24):
        done = workspace.snakemake(STUDY)
        assert done.returncode == 1
        assert "No space left on device" in done.stdout
        assert "Traceback" not in done.stdout
        assert not list((workspace / "results").rglob("*.tmp"))
    done = workspace.snakemake(STUDY)
    assert done.returncode == 0, done.stdout
    assert is_whole(workspace / STUDY)


def without_room():
    """Files of this process and its children end at 8 kB, as on a full disk."""
    resource.setrlimit(resource.RLIMIT_FSIZE, (8192, resource.RLIM_INFINITY))


def without_override():
    """Let this process's children heed permissions even if they run as root."""
    drop_from_bounding_set, override, read_search = 24, 1, 2
    if sys.platform == "linux":
        for capability in (override, read_search):
            ctypes.CDLL(None).prctl(drop_from_bounding_set, capability, 0, 0, 0)


def permit(workspace, mode):
    results = (workspace / STUDY).parent
    for folder in (results, results / "batches", results / "batches/manifest"):
        if folder.exists():  # Snakemake clears a folder away whose only file failed
            folder.chmod(mode)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("fault", "reason"),
    [(without_room, "File too large"), (without_override, "Permission denied")],
    ids=["full", "read-only"],
)
def test_disk_that_refuses_is_said_and_nothing_is_lost(some, fault, reason):
    workspace, _ = some
    scene = workspace / "params/some.yaml"
    scene.write_text(FINER)
    study = (workspace / STUDY).read_bytes()
    permit(workspace, 0o755 if fault is without_room else 0o555)
    try:
        done = workspace.snakemake(STUDY, preexec_fn=fault)
    finally:
        permit(workspace, 0o755)
        scene.write_text(SCENE)
    assert done.returncode == 1
    assert reason in done.stdout
    assert Path(batch_file(FINER)).stem in done.stdout
    assert (workspace / STUDY).read_bytes() == study
    assert not list((workspace / "results").rglob("*.tmp"))


@pytest.mark.slow
def test_after_a_disk_that_refused_the_next_run_goes_on(some):
    workspace, before = some
    (workspace / STUDY).unlink()
    done = workspace.snakemake(STUDY)
    assert done.returncode == 0, done.stdout
    xr.testing.assert_identical(but_times(read_dataset(workspace / STUDY)), but_times(before))


def test_read_only_folder_is_one_clear_error(tmp_path):
    code = "import sys, xarray; from bondcell.storage import write_dataset\n"
    code += "write_dataset(xarray.Dataset({'gap': 1.0}), sys.argv[1])"
    tmp_path.chmod(0o555)
    command = [sys.executable, "-c", code, tmp_path / "study.nc"]
    done = subprocess.run(
        command, preexec_fn=without_override, capture_output=True, text=True, check=False
    )
    tmp_path.chmod(0o755)
    assert f"{CannotWrite.__name__}: {tmp_path}/study.nc cannot be written: " in done.stderr
    assert "Permission denied" in done.stderr
    assert os.listdir(tmp_path) == []
