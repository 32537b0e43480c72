"""The documentation: its code runs, its reference covers the code, its links are well formed."""

import argparse
import importlib.util
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path
from urllib.parse import urlsplit

import matplotlib as mpl
import pytest

import bondcell
from bondcell.cli import parser
from bondcell.results.variables import groups
from bondcell.scenes.schema import scene_json_schema
from bondcell.scenes.validate import validate_file
from bondcell.storage import write_dataset

ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"
PAGES = sorted(DOCS.glob("*.md"))
TEXTS = [*PAGES, *(ROOT / name for name in ("README.md", "CONTRIBUTING.md", "CHANGELOG.md"))]
QUICK_NOTEBOOKS = ("results", "accuracy")


def blocks(path: Path, language: str) -> list[str]:
    """Fenced blocks of a language, or code cells of a notebook."""
    fence = re.escape("{code-cell} python") if language == "cell" else language
    text = path.read_text(encoding="utf-8")
    found = re.findall(rf"^```{fence}\n(.*?)^```", text, flags=re.MULTILINE | re.DOTALL)
    return [re.sub(r"\A(:\w+:.*\n)+", "", block) for block in found]


def with_code(language: str) -> list[Path]:
    return [path for path in PAGES if blocks(path, language)]


@pytest.fixture
def results(synthetic, tmp_path):
    """Results of the two scenes that the notebook on results reads."""
    about = {"scene": "figure4", "source": "bondcell", "source_revision": "none"}
    about |= {"machine": "made up", "cores": "1"}
    write_dataset(synthetic.figure4.assign_attrs(about), tmp_path / "results/figure4/study.nc")
    groups = {"convergence": synthetic.convergence}
    write_dataset(synthetic.point, tmp_path / "results/smoke/study.nc", groups)
    return tmp_path


@pytest.mark.parametrize("path", with_code("python"), ids=lambda path: path.stem)
def test_examples(path, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    names: dict = {}
    for block in blocks(path, "python"):
        exec(compile(block, str(path), "exec"), names)


@pytest.mark.parametrize(
    "path",
    [
        pytest.param(path, marks=() if path.stem in QUICK_NOTEBOOKS else pytest.mark.slow)
        for path in with_code("cell")
    ],
    ids=lambda path: path.stem,
)
def test_notebooks(path, results, monkeypatch):
    monkeypatch.chdir(results)
    names: dict = {}
    with mpl.rc_context({"backend": "agg"}):
        for block in blocks(path, "cell"):
            exec(compile(block, str(path), "exec"), names)


def test_there_is_code_to_run():
    assert {"quickstart", "prony", "extending"} <= {path.stem for path in with_code("python")}
    assert {"results", "physics", "accuracy"} <= {path.stem for path in with_code("cell")}


@pytest.mark.parametrize("path", with_code("yaml"), ids=lambda path: path.stem)
def test_scenes(path, tmp_path):
    for number, block in enumerate(blocks(path, "yaml")):
        scene = tmp_path / f"scene_{number}.yaml"
        scene.write_text(block, encoding="utf-8")
        assert validate_file(scene) == ((), ())


def test_commands_exist():
    (commands,) = (a for a in parser()._actions if isinstance(a, argparse._SubParsersAction))
    targets = set(
        re.findall(r"^([a-z][\w-]*):", (ROOT / "Makefile").read_text(), flags=re.MULTILINE)
    )
    for path in TEXTS:
        text = "\n".join(blocks(path, "sh"))
        assert set(re.findall(r"\bbondcell ([a-z]+)", text)) <= set(commands.choices), path
        assert set(re.findall(r"^make ([a-z][\w-]*)", text, flags=re.MULTILINE)) <= targets, path
        for words in re.findall(r"\bbondcell ([a-z]+)((?:[^\n#\\]|\\\n)*)", text):
            options = set(re.findall(r"(?<= )--[a-z][a-z-]*", words[1]))
            known = {o for a in commands.choices[words[0]]._actions for o in a.option_strings}
            assert options <= known, path


@pytest.fixture(scope="module")
def pages():
    spec = importlib.util.spec_from_file_location("reference_pages", DOCS / "reference_pages.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_reference_covers_the_code(pages, tmp_path):
    paths = {path.stem: path.read_text(encoding="utf-8") for path in pages.write_pages(tmp_path)}
    for name in set(bondcell.__all__) - {"MODELS", "__version__"}:
        assert re.search(rf":: bondcell\.{name}$", paths["api"], re.MULTILINE), name
    for name, model in bondcell.MODELS.items():
        assert f"## {name}\n" in paths["models"]
        assert pages.cell(model.valid_range) in paths["models"]
    for group in groups():
        for variable in group.variables:
            assert f"| `{variable.name}` |" in paths["variables"]
    schema = scene_json_schema()
    for block in (schema, *schema["$defs"].values()):
        for key in block.get("properties", {}):
            assert f"| `{key}` |" in paths["scene_keys"], key
    (commands,) = (a for a in parser()._actions if isinstance(a, argparse._SubParsersAction))
    for name, command in commands.choices.items():
        assert f"## bondcell {name}\n" in paths["cli"]
        for action in command._actions:
            assert all(option in paths["cli"] for option in action.option_strings)


def test_pages_are_written_only_when_they_change(pages, tmp_path):
    first = {path: path.stat().st_mtime_ns for path in pages.write_pages(tmp_path)}
    assert {path: path.stat().st_mtime_ns for path in pages.write_pages(tmp_path)} == first


def test_external_links_are_well_formed():
    """By their form alone: no test follows one."""
    for path in TEXTS:
        for link in re.findall(r"\bhttps?://[^\s<>)\"'`\]]+", path.read_text(encoding="utf-8")):
            parts = urlsplit(link.rstrip(".,;"))
            assert parts.scheme == "https", link
            assert re.fullmatch(r"(?!localhost)[a-z0-9-]+(\.[a-z0-9-]+)+", parts.netloc), link


@pytest.mark.parametrize("path", TEXTS, ids=lambda path: path.stem)
def test_internal_links_lead_somewhere(path, pages, tmp_path):
    made = {Path("reference") / page.name for page in pages.write_pages(tmp_path)}
    text = re.sub(r"^```.*?^```", "", path.read_text("utf-8"), flags=re.MULTILINE | re.DOTALL)
    for link in re.findall(r"\]\(([^)#\s]+)", text):
        if "://" not in link:
            assert (path.parent / link).exists() or Path(link) in made, link


@pytest.mark.slow
def test_build_without_a_warning(results, tmp_path):
    shutil.copytree(DOCS, tmp_path / "docs", ignore=shutil.ignore_patterns("reference"))
    shutil.copy(ROOT / "CHANGELOG.md", tmp_path)
    words = ["-W", "--keep-going", "-b", "html", "docs", "build/docs"]
    # A proxy that nobody listens at: what wants the network fails.
    nowhere = dict.fromkeys(("http_proxy", "https_proxy", "all_proxy"), "http://127.0.0.1:9")
    done = subprocess.run(
        [sys.executable, "-m", "sphinx", *words],
        cwd=tmp_path,
        env={**os.environ, **nowhere},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr[-3000:]
    page = (tmp_path / "build/docs/reference/api.html").read_text(encoding="utf-8")
    assert "bondcell.evaluate" in page
