"""Scenes edited at random: the loader says what is wrong, or accepts what can be planned."""

import warnings

import pytest
from edited_scenes import PARAMS, damaged_files, edited_scenes
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from bondcell.errors import SceneError
from bondcell.jobs.batch_plan import plan
from bondcell.scenes.parsing import load_scene

MANY = 10_000
FEW = 200
QUIET = [HealthCheck.too_slow, HealthCheck.data_too_large]


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    """Where a case is put, with the named materials beside it."""
    folder = tmp_path_factory.mktemp("params")
    (folder / "materials").symlink_to(PARAMS / "materials")
    return folder / "case.yaml"


MOST_PLANNED = 100_000
"""Points up to which a case is planned: every one of them is hashed."""


def refusal(path):
    """What is wrong with a file; if nothing is, its scene can be planned."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            scene = load_scene(path)
    except SceneError as error:
        return error
    assert scene.digest
    if scene.points <= MOST_PLANNED:
        assert all(batch.name for batch in plan(scene).new)
    return None


def check(path, content):
    path.write_bytes(content)
    if error := refusal(path):
        lines = str(error).splitlines()
        count = len(error.violations)
        assert len(lines) == (1 if count == 1 else count + 1)
        assert all(line.isprintable() for line in lines)


@settings(max_examples=FEW, deadline=None, suppress_health_check=QUIET)
@given(content=edited_scenes() | damaged_files())
def test_any_edit_of_a_shipped_scene_is_a_scene_or_a_scene_error(path, content):
    check(path, content)


@pytest.mark.slow
@settings(max_examples=MANY, deadline=None, suppress_health_check=QUIET)
@given(content=edited_scenes() | damaged_files() | st.binary(max_size=300))
def test_ten_thousand_edits_of_shipped_scenes(path, content):
    check(path, content)
