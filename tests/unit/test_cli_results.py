"""Commands on files of results: show, compare, report; what they print, write and refuse."""

import csv
import io
import json
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from bondcell.cli import main
from bondcell.results.comparison import WITHOUT_ESTIMATE
from bondcell.storage import write_dataset


@pytest.fixture
def result(synthetic, tmp_path):
    return str(write_dataset(synthetic.figure4, tmp_path / "figure4" / "study.nc"))


@pytest.fixture
def several(synthetic, tmp_path):
    """A file with a further load and a group of another kind."""
    torsion = synthetic.maps.copy(deep=True)
    torsion["stiffness"].attrs |= {"units": "N m rad-1", "long_name": "torsion stiffness"}
    groups = {"torsion": torsion, "convergence": synthetic.convergence}
    return str(write_dataset(synthetic.maps, tmp_path / "several.nc", groups))


@pytest.mark.parametrize("suffix", ["png", "svg", "pdf"])
def test_plot(result, tmp_path, suffix, capsys):
    out = tmp_path / f"curves.{suffix}"
    assert main(["show", result, "--plot", "modulus_ratio", "stiffness", "-o", str(out)]) == 0
    begin = {"png": b"\x89PNG", "svg": b"<?xml", "pdf": b"%PDF"}[suffix]
    assert out.read_bytes().startswith(begin)
    assert "drawn" in capsys.readouterr().out


def test_plot_of_any_variable(several, tmp_path):
    from bondcell.cli.show import _drawing
    from bondcell.results.selection import narrowed
    from bondcell.storage import read_dataset

    data = narrowed(read_dataset(several, "torsion"), ["gap_ratio=1", "model=fe"])
    axes = _drawing(data, "modulus_ratio", "error_estimate").figure.axes[0]
    assert len(axes.lines) == data.sizes["poisson_m"]
    assert axes.get_xscale() == "log"
    np.testing.assert_array_equal(axes.lines[0].get_ydata(), 1e-7)
    out = tmp_path / "error.png"
    more = ["--group", "torsion", "--at", "gap_ratio=1", "--at", "model=fe"]
    assert main(["show", several, "--plot", "modulus_ratio", "seconds", "-o", str(out), *more]) == 0
    assert out.stat().st_size > 1000


def test_axis_that_begins_at_zero_is_spread(synthetic):
    from bondcell.figures.variable import draw_variable

    time = np.concatenate([[0], np.geomspace(1e-6, 1e6, 13)])
    data = xr.Dataset({"k": ("time", np.exp(-time))}, {"time": time})
    assert draw_variable(data, "time", "k").figure.axes[0].get_xscale() == "symlog"


def rows(text):
    return list(csv.DictReader(io.StringIO(text)))


def test_no_table_takes_the_place_of_its_study(result, tmp_path, capsys):
    before = Path(result).read_bytes()
    link = tmp_path / "link.csv"
    link.symlink_to(result)
    for out in (result, str(link)):
        assert main(["show", result, "--csv", "-o", out]) == 2
        assert "another file than those that are read" in capsys.readouterr().err
    assert Path(result).read_bytes() == before


def test_csv_holds_every_value(result, synthetic, tmp_path, capsys):
    assert main(["show", result, "--csv"]) == 0
    found = rows(capsys.readouterr().out)
    data = synthetic.figure4
    assert len(found) == data["stiffness"].size
    first = found[0]
    here = {name: float(first[name]) for name in ("modulus_ratio", "poisson_m")}
    value = data["stiffness"].sel(model=first["model"], **here).item()
    assert float(first["stiffness"]) == value
    assert {row["status"] for row in found} == {"ok", "diverges"}
    out = tmp_path / "points.csv"
    assert main(["show", result, "--csv", "-o", str(out)]) == 0
    assert rows(out.read_text()) == found


def test_table_of_chosen_points(several, capsys):
    words = ["--at", "model=fe", "--at", "poisson_m=46 %", "--at", "gap_ratio=1"]
    assert main(["show", several, "--table", "--variable", "stiffness", *words]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[0].split("  ")[0] == "modulus_ratio"
    assert "stiffness [N/m]" in lines[0]
    assert len(lines) == 8


def test_single_point_as_table(synthetic, tmp_path, capsys):
    path = str(write_dataset(synthetic.point.isel(model=0), tmp_path / "one.nc"))
    assert main(["show", path, "--csv", "--variable", "stiffness"]) == 0
    assert len(rows(capsys.readouterr().out)) == 1


def test_contents_as_json(several, capsys):
    assert main(["show", several, "--json"]) == 0
    document = json.loads(capsys.readouterr().out)
    assert list(document["groups"]) == ["/", "/torsion", "/convergence"]
    variables = document["groups"]["/"]["variables"]
    assert variables["stiffness"]["units"] == "N m-1"
    assert variables["poisson_m"]["values"] == [0, 0.25, 0.46]
    assert sum(variables["status"]["points_by_flag"].values()) == 3 * 7 * 7 * 3


def test_models_and_validate_as_json(tmp_path, capsys):
    assert main(["models", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["fsi"]["loads"] == ["normal"]
    bad = tmp_path / "bad.yaml"
    bad.write_text("title: x\nmodels: [fis]\n")
    assert main(["validate", "--json", str(bad)]) == 2
    said = json.loads(capsys.readouterr().out)[str(bad)]
    assert not said["valid"]
    assert all({"field", "value", "allowed"} == set(one) for one in said["violations"])


def changed(result, tmp_path, change):
    data = xr.load_dataset(result)
    change(data)
    return str(write_dataset(data, tmp_path / "changed.nc"))


def test_same_files_compare_equal(several, capsys):
    assert main(["compare", several, several]) == 0
    assert capsys.readouterr().out.startswith("the same: ")


def within(data):
    fe = data["stiffness"].sel(model="fe")
    data["stiffness"].loc[{"model": "fe"}] = fe * (1 + 1.5e-7)  # estimates: 1e-7 of both


def beyond(data):
    data["stiffness"].loc[{"model": "fe", "poisson_m": 0.46, "modulus_ratio": 1e6}] *= 1 + 3e-7


def other_flag(data):
    data["status"][{"model": 0, "modulus_ratio": 3}] = 4


def lost(data):
    data["stiffness"][{"model": 0, "modulus_ratio": 3, "poisson_m": 0}] = np.nan


def other_time(data):
    data["seconds"] *= 7
    data["dof"] += 1


def other_input(data):
    data["radius_i"] *= 1 + 2 * WITHOUT_ESTIMATE


CHANGES = {
    "within the estimates": (within, 0, "the same"),
    "beyond them": (beyond, 1, r"stiffness +1 +325 +3e-07 .*model=fe, modulus_ratio=1e\+06"),
    "a flag": (other_flag, 1, r"status +2 .*ok +solver_failed"),
    "a value lost": (lost, 1, r"stiffness +1 .*inf"),
    "times": (other_time, 0, "the same"),
    "an input": (other_input, 1, "radius_i +1"),
}


@pytest.mark.parametrize(("change", "status", "said"), CHANGES.values(), ids=CHANGES)
def test_compare(result, tmp_path, capsys, change, status, said):
    other = changed(result, tmp_path, change)
    for words in ([result, other], [other, result]):
        assert main(["compare", *words]) == status
    assert re.search(said, capsys.readouterr().out.replace("solver_failed  ok", "ok solver_failed"))


def test_compare_as_json(result, tmp_path, capsys):
    other = changed(result, tmp_path, beyond)
    assert main(["compare", result, other, "--json"]) == 1
    document = json.loads(capsys.readouterr().out)
    assert not document["same"]
    (one,) = [one for one in document["variables"] if one["differs"]]
    assert (one["variable"], one["beyond"], one["where"]["model"]) == ("stiffness", 1, "fe")
    assert one["largest"] == pytest.approx(3e-7, rel=1e-3)
    assert one["allowed"] == pytest.approx(2e-7, rel=1e-3)


def test_compare_a_grid_with_a_design(result, synthetic, tmp_path, capsys):
    """An axis of one file is a coordinate along the samples of the other."""
    scattered = synthetic.figure4.isel(poisson_m=[0, 1, 0]).rename(poisson_m="sample")
    poisson = ("sample", scattered["sample"].values)
    scattered = scattered.assign_coords(sample=[0, 1, 2], poisson_m=poisson)
    design = str(write_dataset(scattered, tmp_path / "design.nc"))
    for pair in ([result, design], [design, result]):
        assert main(["compare", *pair]) == 1
        assert "sample" in capsys.readouterr().out


def test_compare_other_points(synthetic, result, tmp_path, capsys):
    fewer = write_dataset(synthetic.figure4.isel(modulus_ratio=slice(3)), tmp_path / "fewer.nc")
    assert main(["compare", result, str(fewer)]) == 1
    assert "22 values in the first file only" in capsys.readouterr().out


def test_report(synthetic, tmp_path, capsys):
    parameters = {
        "title": "One",
        "cell": {"radius_i": 7.5e-3, "gap": 5e-4, "young_i": 3e10, "poisson_i": 0.25,
                 "young_m": 1.4e6, "poisson_m": 0.46},
        "models": ["fsi"],
    }  # fmt: skip
    one = synthetic.point.sel(model=["fsi", "fe"]).assign_attrs(parameters=json.dumps(parameters))
    write_dataset(one, tmp_path / "results" / "one" / "study.nc")
    page = tmp_path / "page.html"
    assert main(["report", str(tmp_path / "results"), "-o", str(page)]) == 0
    assert "1 scenes: one" in capsys.readouterr().out
    assert page.read_text(encoding="utf-8").lstrip().startswith("<!")
    assert main(["report", str(tmp_path / "results")]) == 0
    assert (tmp_path / "results" / "report.html").is_file()


BAD = {
    "plot without file": (["--plot", "modulus_ratio", "stiffness"], "-o = None"),
    "plot to a text": (["--plot", "poisson_m", "seconds", "-o", "out.txt"], "-o = 'out.txt'"),
    "no folder": (["--plot", "gap", "dof", "-o", "/nowhere/at/all.png"], "existing folder"),
    "no such variable": (["--plot", "poisson_m", "stifness", "-o", "a.png"], "--plot Y = "),
    "no such axis": (["--plot", "gapp", "stiffness", "-o", "a.png"], "--plot X = 'gapp'"),
    "axis without extent": (["--plot", "gap", "stiffness", "-o", "a.png"], "--plot X = 'gap'"),
    "too many lines": (["--plot", "poisson_m", "dof", "-o", "a.png"], "at most 12 lines"),
    "one word": (["--plot", "poisson_m"], "expected 2 arguments"),
    "two wishes": (["--csv", "--json"], "not allowed with"),
    "no such position": (["--csv", "--at", "poisson_m=0.3"], "a value of poisson_m: 0, 0.46"),
    "no such model": (["--csv", "--at", "model=fis"], "a value of model: fsi"),
    "no axis of that name": (["--csv", "--at", "gapp=1"], "AXIS=VALUE with one of the axes"),
    "position without value": (["--csv", "--at", "model"], "AXIS=VALUE"),
    "position of another kind": (["--csv", "--at", "poisson_m=1 mm"], "a value of poisson_m"),
    "no such column": (["--csv", "--variable", "stifness"], "did you mean stiffness?"),
    "no such group": (["--csv", "--group", "torsion"], "it has none"),
    "output of an overview": (["-o", "x.png"], "an option of --plot and --csv"),
    "position of an overview": (["--at", "model=fe"], "for --plot, --table and --csv"),
    "column of a plot": (
        ["--plot", "poisson_m", "dof", "-o", "a.png", "--variable", "dof"],
        "for --table and --csv",
    ),
}


@pytest.mark.parametrize(("more", "said"), BAD.values(), ids=BAD)
def test_bad_show(result, tmp_path, monkeypatch, more, said, capsys):
    monkeypatch.chdir(tmp_path)
    assert main(["show", result, *more]) == 2
    out, err = capsys.readouterr()
    assert said in err
    assert out == ""
    assert [path.name for path in tmp_path.iterdir()] == ["figure4"]


def test_bad_comparisons(result, synthetic, tmp_path, capsys):
    folder = tmp_path / "folder"
    folder.mkdir()
    text = tmp_path / "text.nc"
    text.write_text("no netCDF")
    empty = write_dataset(xr.Dataset(), tmp_path / "empty.nc")
    for other in (folder, text, empty, tmp_path / "missing.nc"):
        assert main(["compare", result, str(other)]) == 2
        out, err = capsys.readouterr()
        assert (out, "Traceback" in err) == ("", False)
        assert str(other) in err


def test_bad_reports(result, tmp_path, capsys):
    empty = tmp_path / "empty"
    empty.mkdir()
    foreign = tmp_path / "foreign" / "scene"
    foreign.mkdir(parents=True)
    (foreign / "study.nc").write_text("no netCDF")
    for words, said in (
        ([tmp_path / "nowhere"], "an existing folder"),
        ([empty], "study.nc"),
        ([tmp_path, "-o", "page.txt"], ".html"),
        ([tmp_path, "-o", tmp_path / "no" / "page.html"], "existing folder"),
        ([foreign.parent], "netCDF"),
    ):
        assert main(["report", *map(str, words)]) == 2
        out, err = capsys.readouterr()
        assert said in err
        assert (out, "Traceback" in err) == ("", False)


def test_reader_of_a_table_that_goes_away(result):
    line = f"'{sys.executable}' -m bondcell show '{result}' --csv | head -n 1"
    done = subprocess.run(["sh", "-c", line], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.startswith("model,modulus_ratio,poisson_m,stiffness,")
