"""What the README shows works as shown."""

import re
from pathlib import Path

import numpy as np

from bondcell.scenes.parsing import load_scene
from bondcell.scenes.validate import validate_file

README = (Path(__file__).parents[2] / "README.md").read_text(encoding="utf-8")


def block(language: str) -> str:
    found = re.findall(rf"^```{language}\n(.*?)^```", README, flags=re.MULTILINE | re.DOTALL)
    assert len(found) == 1
    return found[0]


def test_scene(tmp_path):
    path = tmp_path / "thin_film.yaml"
    path.write_text(block("yaml"), encoding="utf-8")
    assert validate_file(path) == ((), ())
    assert load_scene(path).reference is not None


def test_python(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    names: dict = {}
    exec(block("python"), names)
    model, reference = names["out"], names["reference"]
    assert model.stiffness.dims == reference.stiffness.dims == ("gap",)
    assert np.all(model.stiffness < reference.stiffness)
    assert np.all(reference.status == 0)
    assert np.all(names["curve"].stiffness.diff("time") <= 0)
    assert np.all(names["few"].reduction_error < 1e-3)
    assert (tmp_path / "results" / "bond.csv").is_file()
    assert names["pushed"].reactions[2, 1] > 0
