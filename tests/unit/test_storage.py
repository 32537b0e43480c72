"""Files are written whole or not at all, and read whole or refused."""

import os
import subprocess
import sys

import netCDF4
import numpy as np
import pytest
import xarray as xr

from bondcell.errors import DataError
from bondcell.outputs import OUTPUTS, output_attributes
from bondcell.storage import read_dataset, replacing, write_dataset


@pytest.fixture
def dataset():
    rng = np.random.default_rng(1)
    attributes = output_attributes("normal")
    shape, dims = (2, 300), ("model", "gap")
    values = {
        "stiffness": rng.random(shape),
        "error_estimate": rng.random(shape),
        "status": rng.integers(0, 7, shape).astype(np.int8),
        "dof": rng.integers(0, 5000, shape),
        "seconds": rng.random(shape),
    }
    values["stiffness"][0, 3] = np.nan
    return xr.Dataset(
        {name: (dims, values[name], attributes[name]) for name in OUTPUTS} | {"young_m": 1.4e6},
        {"model": ["fsi", "fe"], "gap": ("gap", np.geomspace(1e-6, 1, 300), {"units": "m"})},
        {"title": "Überschrift", "parameters": '{"gap": "0.5 mm"}'},
    )


@pytest.fixture
def path(tmp_path, dataset):
    return write_dataset(dataset, tmp_path / "new" / "study.nc", {"convergence": dataset})


def test_round_trip_is_exact(path, dataset):
    for group in (None, "convergence"):
        back = read_dataset(path, group)
        xr.testing.assert_equal(back, dataset)
        assert back.status.dtype == np.int8
        assert {k: back.attrs[k] for k in dataset.attrs} == dataset.attrs
        np.testing.assert_array_equal(
            back.status.attrs["flag_values"], dataset.status.attrs["flag_values"]
        )


def test_file_follows_the_conventions_and_is_compressed(path):
    with netCDF4.Dataset(path) as file:
        assert file.Conventions == "CF-1.11"
        assert file.data_model == "NETCDF4"
        assert file["stiffness"].filters()["zlib"]
        assert file["stiffness"].filters()["fletcher32"]
        assert not hasattr(file["gap"], "_FillValue")
        assert np.isnan(file["stiffness"]._FillValue)


def test_same_content_same_bytes(tmp_path, dataset):
    one, two = (write_dataset(dataset, tmp_path / name) for name in ("one.nc", "two.nc"))
    assert one.read_bytes() == two.read_bytes()


def test_reading_leaves_the_file_free(path, dataset):
    before = read_dataset(path)
    write_dataset(dataset.isel(gap=slice(2)), path)
    assert before.sizes["gap"] == 300
    assert read_dataset(path).sizes["gap"] == 2


def test_failed_write_leaves_the_old_file_and_nothing_else(path, dataset):
    before = path.read_bytes()
    with pytest.raises((TypeError, ValueError)):
        write_dataset(dataset, path, {"broken": xr.Dataset({"bad": ("x", [{1: 2}])})})
    assert path.read_bytes() == before
    assert os.listdir(path.parent) == [path.name]


def test_killed_writer_leaves_no_half_file(tmp_path):
    code = (
        "import os, sys\nfrom bondcell.storage import replacing\n"
        "with replacing(sys.argv[1]) as temporary:\n"
        "    temporary.write_text('half')\n    os._exit(9)\n"
    )
    target = tmp_path / "study.nc"
    assert subprocess.run([sys.executable, "-c", code, str(target)], check=False).returncode == 9
    assert not target.exists()


def test_replacing_keeps_the_old_file_on_error(tmp_path):
    target = tmp_path / "table.csv"
    target.write_text("old")
    with pytest.raises(FileNotFoundError), replacing(target) as temporary:
        temporary.with_name("nowhere").rename(temporary)
    assert target.read_text() == "old"
    assert os.listdir(tmp_path) == ["table.csv"]


def test_missing_file_is_one_clear_error(tmp_path):
    with pytest.raises(DataError, match=r"nowhere\.nc.*an existing file"):
        read_dataset(tmp_path / "nowhere.nc")


def test_missing_group_is_one_clear_error(path):
    with pytest.raises(DataError, match="group = 'specimen'"):
        read_dataset(path, "specimen")


@pytest.mark.parametrize("fraction", [0.0, 0.001, 0.3, 0.9])
def test_half_written_file_is_refused(path, fraction):
    content = path.read_bytes()
    path.write_bytes(content[: int(len(content) * fraction)])
    with pytest.raises(DataError, match="a complete netCDF-4 file"):
        read_dataset(path)


def test_text_file_is_refused(tmp_path):
    file = tmp_path / "study.nc"
    file.write_text("scenes: [figure4]\n")
    with pytest.raises(DataError, match="a complete netCDF-4 file"):
        read_dataset(file)


def test_a_changed_bit_is_noticed_or_harmless(path, dataset):
    content = path.read_bytes()
    noticed = 0
    for seed in range(60):
        rng = np.random.default_rng(seed)
        damaged = bytearray(content)
        damaged[rng.integers(len(content))] ^= 1 << int(rng.integers(8))
        path.write_bytes(damaged)
        try:
            back = read_dataset(path)
        except DataError:
            noticed += 1
        else:
            xr.testing.assert_equal(back, dataset)
    assert noticed > 5
