"""The sources a module rests on are those that importing it loads."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

from bondcell.sources import PACKAGE, script_sources, source_files

LOADED = """
import importlib, json, sys
importlib.import_module(sys.argv[1])
names = [name for name in sys.modules if name.startswith("bondcell.")]
print(json.dumps([sys.modules[name].__file__ for name in names]))
"""


@pytest.mark.parametrize(
    "module",
    [
        "bondcell.storage",
        "bondcell.evaluate",
        "bondcell.jobs.reference_batch",
        "bondcell.report",
    ],
)
def test_sources_are_the_loaded_files(module):
    done = subprocess.run(
        [sys.executable, "-c", LOADED, module], capture_output=True, text=True, check=True
    )
    assert source_files(module) == sorted(map(Path, json.loads(done.stdout)))


def test_evaluate_rests_on_no_finite_elements_but_the_reference_does():
    fem = PACKAGE / "fem"
    assert not any(path.is_relative_to(fem) for path in source_files("bondcell.evaluate"))
    reference = source_files("bondcell.jobs.reference_batch")
    assert fem / "reference.py" in reference
    assert PACKAGE / "models" / "fsi.py" not in reference


def test_script(tmp_path):
    script = tmp_path / "script.py"
    script.write_text(
        "import numpy\nimport bondcell.status\nfrom bondcell import errors\n"
        "def later():\n    from bondcell import storage\n"
    )
    assert [path.name for path in script_sources(script)] == ["errors.py", "status.py"]
