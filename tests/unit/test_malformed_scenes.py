"""Malformed scene files: one error that names all that is wrong, exit status 2, nothing written."""

import os
import time

import pytest
from malformed_scenes import GOOD, MALFORMED

from bondcell.cli import main
from bondcell.scenes.validate import validate_file

SECONDS = 20.0
"""Processor time that any of them may take; the slowest takes 2 s."""


def test_there_are_many_and_they_are_not_alike():
    assert len(MALFORMED) >= 60
    assert len({content for content, _ in MALFORMED.values()}) == len(MALFORMED)


def test_what_they_were_made_from_is_good(tmp_path):
    (tmp_path / "scene.yaml").write_text(GOOD)
    assert validate_file(tmp_path / "scene.yaml") == ((), ())


@pytest.mark.parametrize("name", MALFORMED)
def test_malformed_file(name, tmp_path, monkeypatch, capsys):
    content, fields = MALFORMED[name]
    monkeypatch.chdir(tmp_path)
    path = tmp_path / "scene.yaml"
    path.write_bytes(content)
    started = time.process_time()
    status = main(["validate", path.name])
    assert time.process_time() - started < SECONDS
    printed = capsys.readouterr()
    lines = printed.err.splitlines()
    assert (status, printed.out) == (2, "")
    assert len(lines) == len(fields)
    for line in lines:
        assert line.startswith("scene.yaml: ")
        assert ": allowed is " in line
        assert line.isprintable()
        assert len(line) < 1000
    assert {violation.field for violation in validate_file(path).violations} == fields
    assert os.listdir(tmp_path) == ["scene.yaml"]
    assert path.read_bytes() == content
