"""What `bondcell validate` refuses Snakemake refuses as well, and nothing else; neither writes."""

import os
import shutil
import warnings

import pytest
from edited_scenes import PARAMS, damaged_files, edited_scenes
from hypothesis import HealthCheck, Phase, given, settings
from malformed_scenes import MALFORMED

from bondcell.scenes.validate import validate_file

EDITED = 100
TRICKS = (
    "results/../escaped/study.nc",
    "results/a/../../escaped/study.nc",
    "results/..%2fescaped/study.nc",
    "results/Escaped/study.nc",
    "results/a b/study.nc",
    "results/-x/study.nc",
    "../escaped/study.nc",
    "/tmp/escaped/study.nc",
    "results/{}/study.nc",
    "results/$(touch escaped)/study.nc",
)


@pytest.fixture(scope="module")
def empty(make_workspace, tmp_path_factory):
    """A workspace without scenes, and the files in it."""
    workspace = make_workspace(tmp_path_factory.mktemp("refused"))
    del workspace.environment["MODULES_FOLDER"]
    shutil.copytree(PARAMS / "materials", workspace / "params/materials")
    return workspace


def written(workspace):
    """Files of a workspace besides scenes and what Snakemake keeps for itself."""
    found = {path.relative_to(workspace.folder) for path in workspace.folder.rglob("*")}
    ours = {path for path in found if path.parts[0] not in ("params", ".snakemake")}
    return {path for path in ours if "__pycache__" not in path.parts}


def dry_runs(workspace, contents):
    """Name -> output of a dry run of the scene with that content."""
    for name, content in contents.items():
        (workspace / f"params/{name}.yaml").write_bytes(content)
    outputs = workspace.dry_runs([f"results/{name}/study.nc" for name in contents])
    return dict(zip(contents, outputs.values(), strict=True))


@pytest.mark.slow
def test_malformed_scenes_end_the_plan(empty):
    before = written(empty)
    contents = {name: content for name, (content, _) in MALFORMED.items()}
    for name, output in dry_runs(empty, contents).items():
        path = f"params/{name}.yaml"
        assert output.endswith("exit status 2\n"), (name, output)
        assert "Traceback" not in output
        for violation in validate_file(empty / path).violations:
            assert str(violation) in output, name
        assert path in output
    assert written(empty) == before


@pytest.mark.slow
def test_plan_and_validation_agree_on_edited_scenes(empty):
    before, contents = written(empty), {}

    @settings(
        max_examples=EDITED,
        derandomize=True,
        phases=[Phase.generate],
        suppress_health_check=list(HealthCheck),
    )
    @given(content=edited_scenes() | damaged_files())
    def gather(content):
        contents[f"edited_{len(contents)}"] = content

    gather()
    outputs = dry_runs(empty, contents)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        good = {name: not validate_file(empty / f"params/{name}.yaml")[0] for name in contents}
    assert 0.05 < sum(good.values()) / len(good) < 0.95
    for name, output in outputs.items():
        assert output.endswith(f"exit status {0 if good[name] else 2}\n"), (name, output)
    assert written(empty) == before


def test_names_cannot_leave_the_results(empty):
    before = written(empty)
    for name, output in empty.dry_runs(list(TRICKS)).items():
        assert output.endswith("exit status 1\n"), (name, output)
        assert "MissingRuleException" in output
    assert written(empty) == before
    assert not os.path.lexists(empty.folder.parent / "escaped")
    assert not os.path.lexists("/tmp/escaped")
