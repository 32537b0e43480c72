"""The command line: what it prints, its exit status, and what it says to bad input."""

import json
import os
import re
import signal
import subprocess
import sys
import time

import pytest

from bondcell import MODELS
from bondcell.cli import main
from bondcell.storage import write_dataset

BASE = {
    "--radius": "7.5e-3",
    "--gap": "5e-4",
    "--young-particle": "3e10",
    "--poisson-particle": "0.25",
    "--young-matrix": "1.4e6",
    "--poisson-matrix": "0.46",
}


def stiffness(*more: str, **changes: str | None) -> list[str]:
    """Words of ``bondcell stiffness`` at the base case, with changes."""
    options = BASE | {f"--{name.replace('_', '-')}": value for name, value in changes.items()}
    given = [word for pair in options.items() if pair[1] is not None for word in pair]
    return ["stiffness", *given, *more]


@pytest.fixture
def result(synthetic, tmp_path):
    return str(write_dataset(synthetic.figure4, tmp_path / "figure4" / "study.nc"))


def test_base_case(capsys):
    assert main(stiffness()) == 0
    out, err = capsys.readouterr()
    line = next(line for line in out.splitlines() if line.startswith("fsi"))
    assert re.match(
        r"fsi +84055\.131\d* N/m +\S+ \(evaluation of the formula\) +ok +\S+ [µm]?s", line
    )
    assert "k_int" in out
    assert err == ""


def test_units_give_the_same_number(capsys):
    main(stiffness("--json"))
    bare = json.loads(capsys.readouterr().out)
    words = stiffness(
        "--json",
        radius="7.5 mm",
        gap="0.5 mm",
        young_particle="30 GPa",
        young_matrix="1.4 MPa",
        poisson_matrix="46 %",
    )
    assert main(words) == 0
    written = json.loads(capsys.readouterr().out)
    assert written["inputs"] == bare["inputs"]
    assert written["results"][0]["stiffness"] == bare["results"][0]["stiffness"]


def test_json_tells_everything(capsys):
    assert main(stiffness("--json", "--model", "fsi", "--model", "general")) == 0
    document = json.loads(capsys.readouterr().out)
    assert document["unit"] == "N m-1"
    assert [entry["model"] for entry in document["results"]] == ["fsi", "general"]
    first = document["results"][0]
    assert first["stiffness"] == pytest.approx(84055.1310, rel=1e-8)
    assert first["status"] == "ok"
    assert set(first["parts"]) == {"k_i", "k_int", "k_j"}


def test_rigid_particles_and_unequal_ones(capsys):
    words = stiffness("--json", young_particle="rigid", radius_j="5 mm", poisson_particle_j="0.3")
    assert main([*words, "--young-particle-j", "1 GPa", "--cylinder-radius", "8 mm"]) == 0
    inputs = json.loads(capsys.readouterr().out)["inputs"]
    assert inputs["young_i"] == "inf"
    assert (inputs["radius_j"], inputs["young_j"], inputs["cylinder_radius"]) == (5e-3, 1e9, 8e-3)


def test_reference_agrees_with_the_known_value(capsys):
    assert main(stiffness("--model", "fe", "--tolerance", "1e-3", "--json")) == 0
    found = json.loads(capsys.readouterr().out)["results"][0]
    assert found["stiffness"] == pytest.approx(162460.7672, rel=1e-3)
    assert found["dof"] > 0
    assert found["error_estimate_kind"].startswith("discretisation")


def test_rotations_have_their_own_unit(capsys):
    assert main(stiffness("--model", "fe", "--load", "bending", tolerance="1e-4")) == 0
    out, _ = capsys.readouterr()
    assert re.search(r"^fe +[\d.]+ N m/rad ", out, re.MULTILINE)
    assert re.search(r"^  coupling +-[\d.]+ N/rad", out, re.MULTILINE)
    assert "load bending\n" in out
    assert main(stiffness("--model", "fe", "--load", "torsion", "--json", tolerance="1e-3")) == 0
    told = json.loads(capsys.readouterr().out)
    assert told["unit"] == "N m rad-1"
    assert told["fe_options"] == {"tolerance": 1e-3}
    assert told["results"][0]["way"] == "direct"
    assert told["results"][0]["coupling"] is None


def test_diverging_model_gives_no_value_and_says_so(capsys, monkeypatch):
    from dataclasses import replace

    from bondcell.models.model import Springs

    silent = replace(MODELS["fsi"], loads={"normal": lambda cell: Springs(float("inf"))})
    monkeypatch.setattr("bondcell.cli.answers.MODELS", {"fsi": silent})
    assert main(stiffness()) == 1
    assert "no value" in capsys.readouterr().out
    assert main(stiffness("--json")) == 1
    assert json.loads(capsys.readouterr().out)["results"][0]["stiffness"] is None


BAD = {
    "gap zero": (stiffness(gap="0"), "--gap = 0.0"),
    "gap negative": (stiffness(gap="-1e-4"), "--gap = -0.0001"),
    "gap with negative exponent form": (stiffness(gap="-5e-4"), "--gap = -0.0005"),
    "radius nan": (stiffness(radius="nan"), "--radius = 'nan'"),
    "radius infinite": (stiffness(radius="inf"), "--radius = 'inf'"),
    "radius text": (stiffness(radius="big"), "--radius = 'big'"),
    "radius empty": (stiffness(radius=""), "--radius = ''"),
    "unit of another kind": (stiffness(radius="7.5 MPa"), "--radius = '7.5 MPa'"),
    "unknown unit": (stiffness(gap="0.5 foo"), "--gap = '0.5 foo'"),
    "expression": (stiffness(gap="1/2"), "--gap = '1/2'"),
    "modulus negative": (stiffness(young_matrix="-1 MPa"), "--young-matrix = -1000000.0"),
    "matrix rigid": (stiffness(young_matrix="inf"), "--young-matrix = 'inf'"),
    "particle modulus zero": (stiffness(young_particle="0"), "--young-particle = 0.0"),
    "poisson above": (stiffness(poisson_matrix="0.51"), "--poisson-matrix = 0.51"),
    "poisson -1": (stiffness(poisson_particle="-1"), "--poisson-particle = -1.0"),
    "poisson with unit": (stiffness(poisson_matrix="0.3 m"), "--poisson-matrix = '0.3 m'"),
    "cylinder too thin": (stiffness(cylinder_radius="7 mm"), "--cylinder-radius = 0.007"),
    "missing": (stiffness(gap=None), "--gap = None: allowed is the shortest distance"),
    "unknown model": (stiffness("--model", "fis"), "did you mean fsi?"),
    "unknown load": (stiffness(load="pull"), "--load = 'pull'"),
    "unknown bc": (stiffness("--model", "fe", bc="glued"), "--bc = 'glued'"),
    "load of no model": (stiffness("--load", "twist"), "is one of normal, shear, torsion, bending"),
    "load that the model lacks": (stiffness("--load", "shear"), "one of normal for the model fsi"),
    "bc of another load": (
        stiffness("--model", "fe", "--load", "shear", bc="clamped"),
        "concerns the load normal only",
    ),
    "tolerance": (stiffness("--model", "fe", tolerance="-1"), "--tolerance = '-1'"),
    "tolerance text": (stiffness("--model", "fe", tolerance="fine"), "--tolerance = 'fine'"),
    "unknown option": (stiffness("--radios", "1"), "--radios"),
    "abbreviated option": (stiffness("--young-m", "1"), "--young-m"),
    "no command": ([], "COMMAND"),
    "unknown command": (["stifness"], "stifness"),
    "option without value": (["stiffness", "--radius"], "--radius"),
    "missing result": (["show", "nowhere/study.nc"], "allowed is an existing file"),
    "missing scene": (["validate", "nowhere.yaml"], "nowhere.yaml"),
    "nothing to validate": (["validate"], "FILE"),
}


@pytest.mark.parametrize(("words", "said"), BAD.values(), ids=BAD)
def test_bad_input(words, said, capsys):
    assert main(words) == 2
    out, err = capsys.readouterr()
    assert said in err
    assert "Traceback" not in err
    assert out == ""


def test_all_violations_at_once_one_a_line(capsys):
    words = stiffness(
        "--model", "fis", gap="-1", radius="x", poisson_matrix="0.7", young_matrix=None
    )
    assert main([*words, "--bc", "glued"]) == 2
    lines = capsys.readouterr().err.splitlines()
    assert len(lines) == 6
    for option, line in zip(
        ("--radius", "--gap", "--young-matrix", "--poisson-matrix", "--model", "--bc"),
        lines,
        strict=True,
    ):
        assert line.startswith(f"bondcell: {option} = ")


def test_suspicious_units_warn_but_work(capsys):
    assert main(stiffness(radius="7.5", gap="0.5", young_matrix="1.4")) == 0
    err = capsys.readouterr().err
    assert "--radius = 7.5 m: beyond 1 m" in err
    assert "--young-matrix = 1.4 Pa: below 100 Pa" in err
    assert len(err.splitlines()) == 2  # not again for the defaults that repeat the radius


def test_option_of_the_reference_without_reference_warns(capsys):
    assert main(stiffness("--bc", "clamped")) == 0
    assert "concern the model fe only" in capsys.readouterr().err


@pytest.mark.parametrize("words", [["--help"], ["--version"], ["stiffness", "--help"], ["models"]])
def test_information(words, capsys):
    assert main(words) == 0
    out, err = capsys.readouterr()
    assert out.strip()
    assert err == ""


def test_models_lists_every_model(capsys):
    main(["models"])
    out = capsys.readouterr().out
    assert all(re.search(rf"^{name}: ", out, re.MULTILINE) for name in MODELS)


GOOD_SCENE = """
title: One cell
cell: {radius_i: 7.5 mm, gap: 0.5 mm, young_i: 30 GPa, poisson_i: 0.25, young_m: 1.4 MPa,
  poisson_m: 0.46}
models: [fsi]
"""


def test_validate_several_files(tmp_path, capsys):
    good, bad, odd = (tmp_path / name for name in ("good.yaml", "bad.yaml", "odd.yaml"))
    good.write_text(GOOD_SCENE)
    bad.write_text(GOOD_SCENE.replace("0.46", "0.6").replace("0.5 mm", "-1 mm"))
    odd.write_text(GOOD_SCENE.replace("7.5 mm", "7.5"))
    assert main(["validate", str(good)]) == 0
    assert capsys.readouterr() == (f"{good}: valid\n", "")
    assert main(["validate", str(bad), str(good), str(odd)]) == 2
    out, err = capsys.readouterr()
    assert out.splitlines() == [f"{good}: valid", f"{odd}: valid"]
    assert "poisson_m" in err
    assert "gap" in err
    assert "beyond 1 m" in err


def test_show(result, capsys):
    assert main(["show", result]) == 0
    out = capsys.readouterr().out
    assert re.search(r"modulus_ratio +25 values +1 to 1e6", out)
    assert re.search(r"cementation .* ok 25, diverges 25", out)
    assert re.search(r"fsi +fe +48 % .* E_i/E_m = 1e6, ν_m = 0.46 +50", out)


def test_show_a_single_point(synthetic, tmp_path, capsys):
    path = write_dataset(synthetic.point, tmp_path / "study.nc")
    assert main(["show", str(path)]) == 0
    words = ["--plot", "model", "stiffness", "-o", str(tmp_path / "bars.svg")]
    assert main(["show", str(path), *words]) == 0
    assert (tmp_path / "bars.svg").stat().st_size > 1000


def test_show_a_convergence_study(synthetic, tmp_path, capsys):
    groups = {"convergence": synthetic.convergence}
    path = write_dataset(synthetic.point.sel(model=["fsi"]), tmp_path / "study.nc", groups)
    assert main(["show", str(path)]) == 0
    out = capsys.readouterr().out
    assert re.search(r"base +structured +6 +0.0025 to 1.5e-8 +864 +360 ms", out)
    assert re.search(r"base +fsi +1 +0.48 +- +100 ns", out)


def test_half_written_result(result, tmp_path, capsys):
    cut = tmp_path / "cut.nc"
    with open(result, "rb") as whole:
        cut.write_bytes(whole.read()[:5000])
    assert main(["show", str(cut)]) == 2
    assert "a complete netCDF-4 file" in capsys.readouterr().err


def test_file_of_something_else(synthetic, tmp_path, capsys):
    path = write_dataset(synthetic.figure4[["gap"]], tmp_path / "other.nc")
    assert main(["show", str(path)]) == 2
    assert "stiffness(model, axes...)" in capsys.readouterr().err


def test_result_without_numbers(synthetic, tmp_path, capsys):
    study = synthetic.figure4
    text = study.assign(stiffness=study.stiffness.astype(str))
    path = write_dataset(text, tmp_path / "text.nc")
    assert main(["show", str(path)]) == 2
    assert "stiffness(model, axes...)" in capsys.readouterr().err


def test_terminal_that_cannot_print_greek():
    done = subprocess.run(
        command(*stiffness()),
        capture_output=True,
        check=True,
        env={**os.environ, "PYTHONIOENCODING": "ascii", "PYTHONUTF8": "0"},
    )
    assert b"84055.131" in done.stdout


def command(*words: str) -> list[str]:
    return [sys.executable, "-m", "bondcell", *words]


def test_as_a_module_and_what_it_imports():
    code = (
        "import sys; from bondcell.cli import main; status = main(sys.argv[1:]); "
        "heavy = {'gmsh', 'matplotlib', 'netCDF4', 'pandas', 'pint', 'pydantic', 'skfem'}; "
        "heavy.add('xarray'); "
        "print(sorted(heavy & {name.split('.')[0] for name in sys.modules})); sys.exit(status)"
    )
    done = subprocess.run(
        [sys.executable, "-c", code, *stiffness()], capture_output=True, text=True, check=True
    )
    assert done.stdout.splitlines()[-1] == "[]"
    done = subprocess.run(command(*stiffness(gap="0")), capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout) == (2, "")


def test_reader_that_goes_away():
    line = " ".join(f"'{word}'" for word in command("models"))
    done = subprocess.run(
        ["sh", "-c", f"{line} | head -n 1"], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0
    assert done.stdout.startswith("fsi")
    assert done.stderr == ""


def test_interrupt():
    # A shell that runs its commands in the background lets them ignore interrupts.
    code = "import bondcell.cli as cli, bondcell.cli.stiffness as s, signal, time; \
signal.signal(signal.SIGINT, signal.default_int_handler); \
s.run = lambda _: (print('running', flush=True), time.sleep(60)); import sys; sys.exit(cli.main())"
    running = subprocess.Popen(
        [sys.executable, "-c", code, *stiffness()],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    assert running.stdout.readline() == "running\n"
    time.sleep(0.1)
    running.send_signal(signal.SIGINT)
    _, err = running.communicate(timeout=30)
    assert running.returncode == 130
    assert err == "bondcell: interrupted\n"


def test_a_model_out_of_its_range_says_where_it_holds(capsys):
    words = stiffness("--model", "surrogate", "--model", "film", radius_j="5 mm")
    assert main(words) == 1
    out = capsys.readouterr().out
    assert f"surrogate is not_computed. It holds for: {MODELS['surrogate'].valid_range}" in out
    assert "film is" not in out


def test_the_surrogate_states_its_error_to_the_finite_elements(capsys):
    assert main(stiffness("--model", "surrogate", "--load", "bending")) == 0
    assert "(to the finite elements)" in capsys.readouterr().out
