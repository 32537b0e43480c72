"""What the help shows works: every example in it is run."""

import argparse
import re
import shlex

import pytest

from bondcell.cli import main, parser
from bondcell.storage import write_dataset


def commands():
    (found,) = (a for a in parser()._actions if isinstance(a, argparse._SubParsersAction))
    return found.choices


def examples(text):
    """Command lines of a help text, continued lines joined, remarks left out."""
    joined = re.sub(r"\\\n\s*", " ", text)
    lines = [line.strip() for line in joined.splitlines() if line.startswith("  bondcell ")]
    lines += re.findall(r"^example: (bondcell .*)$", joined, re.MULTILINE)
    return [line.split("  #")[0] for line in lines if "COMMAND" not in line]


ALL = {
    (name, line): line
    for name, command in {"": parser(), **commands()}.items()
    for line in examples(command.epilog or "")
}


def test_every_command_has_one():
    assert {name for name, _ in ALL} >= set(commands()) - {"models", "merge"}


@pytest.fixture
def results(synthetic, tmp_path, monkeypatch):
    """Files under the names that the examples use."""
    monkeypatch.chdir(tmp_path)
    scene = (
        '{"title": "x", "cell": {"radius_i": 1, "gap": 1, "young_i": 1, "poisson_i": 0, '
        '"young_m": 1, "poisson_m": 0}, "models": ["fsi"]}'
    )
    for folder in ("results/figure4", "other/figure4"):
        data = synthetic.figure4.assign_attrs(parameters=scene)
        write_dataset(data, tmp_path / folder / "study.nc")
    (tmp_path / "params").mkdir()
    (tmp_path / "params" / "x.yaml").write_text(scene.replace("1,", "1.0,"), encoding="utf-8")
    return tmp_path


PARSED_ONLY = ("prony", "extreme_loads", "merge", "bondcell report")
"""Examples on files that no made-up results stand for, or that another test runs."""


@pytest.mark.parametrize("line", dict.fromkeys(ALL.values()))
def test_examples_run(line, results, capsys):
    words = shlex.split(line)[1:]
    words = [
        str(path) for word in words for path in (results.glob(word) if "*" in word else [word])
    ]
    parser().parse_args(words)
    if not any(name in line for name in PARSED_ONLY):
        assert main(words) == 0, capsys.readouterr().err
