"""A real browser, and a report on a small study of every kind of scene, opened from disk."""

import os
import shutil
from pathlib import Path

import pytest

from bondcell.figures import draw_scene
from bondcell.figures.specimen import draw_specimen
from bondcell.jobs.analytic_batch import compute_analytic
from bondcell.jobs.batch_files import write_batch
from bondcell.jobs.batch_plan import plan
from bondcell.jobs.collect import collect, collect_convergence, collect_other_loads
from bondcell.jobs.convergence_run import run_convergence
from bondcell.jobs.reference_batch import compute_reference
from bondcell.jobs.relaxation_batch import compute_relaxation
from bondcell.report import write_report
from bondcell.results.accuracy import accuracy_of_loads
from bondcell.results.load_groups import read_loads
from bondcell.scenes.parsing import parse_scene
from bondcell.scenes.scene import Scene
from bondcell.scenes.study import build_study
from bondcell.specimen.files import collect_specimen
from bondcell.specimen.run import run_part
from bondcell.specimen.view import read_specimen
from bondcell.storage import write_dataset

CELL = {"radius_i": "7.5 mm", "young_i": "30 GPa", "poisson_i": 0.25, "young_m": "1.4 MPa"}
POINT = {**CELL, "gap": "0.5 mm", "poisson_m": 0.46}

SCENES = {
    "sweep": {
        "title": "A sweep <of> gap & moduli",
        "question": "Which model is good where?",
        "cell": CELL,
        "sweep": {
            "gap": ["0.1 mm", "0.5 mm", "2 mm"],
            "modulus_ratio": [1, 10, 100, 1e4],
            "poisson_m": [0, 0.46],
        },
        "models": ["fsi", "generatrix", "cementation", "surrogate"],
        "reference": {"bc": ["roller"], "tolerance": 1e-3},
    },
    "scattered": {
        "title": "Points that are no grid",
        "cell": {**CELL, "poisson_m": 0.3},
        "sweep": {"gap": ["0.5 mm", "2 mm"]},
        "design": {
            "kind": "sobol",
            "points": 8,
            "seed": 7,
            "ranges": {
                "modulus_ratio": {"start": 10, "stop": 1e4, "spacing": "log"},
                "poisson_m": {"start": 0, "stop": 0.4},
            },
        },
        "models": ["fsi", "generatrix"],
        "reference": {"tolerance": 1e-2},
    },
    "atlas_small": {
        "title": "Small atlas",
        "cell": CELL,
        "sweep": {
            "gap_ratio": [0.01, 0.1, 1],
            "modulus_ratio": [10, 100, "rigid"],
            "poisson_m": [0, 0.46, 0.5],
        },
        "models": ["fsi", "generatrix", "cementation", "film", "surrogate"],
        "reference": {"bc": "roller", "tolerance": 1e-3},
        "load": ["normal", "torsion"],
        "atlas": True,
    },
    "ladders": {
        "title": "Ladders",
        "cell": POINT,
        "models": ["fsi"],
        "convergence": {"cases": {"base": {}, "wide": {"gap": "3 mm"}}, "orders": [2, 3, 4]},
    },
    "lattices": {
        "title": "Lattices of a specimen",
        "specimen": {"lattices": ["lattice_paper", "lattice_fsi"], "loadings": ["horizontal"]},
    },
    "relaxing": {
        "title": "Relaxing bond",
        "cell": POINT,
        "sweep": {"poisson_m": [0.3, 0.46]},
        "models": ["fsi", "generatrix"],
        "reference": {"bc": ["roller"], "tolerance": 1e-3},
        "prony": {
            "series": {"two": {"weights": [0.6, 0.39], "times": ["1 ms", "10 s"]}},
            "conventions": ["constant_bulk", "constant_poisson"],
            "times": {"start": "1 us", "stop": "1e6 s", "points": 7},
        },
    },
    "corners": {
        "title": "Corners",
        "cell": CELL,
        "sweep": {"gap_ratio": [0.1, 1], "modulus_ratio": [1, "rigid"], "poisson_m": [0, 0.5]},
        "reference": {"bc": "roller", "tolerance": 1e-8},
        "stability": True,
    },
    "point": {"title": "One cell, one model", "cell": POINT, "models": ["fsi"]},
    "incompressible": {
        "title": "No value anywhere",
        "cell": POINT | {"poisson_m": 0.5},
        "sweep": {"gap": ["0.5 mm", "1 mm"]},
        "models": ["cementation"],
    },
}
"""Scenes of every kind; one without a reference, one without any value."""


def make_study(results: Path) -> list[Scene]:
    """Compute and draw all scenes.

    Parameters
    ----------
    results
        The folder that gets a folder for each scene.
    """
    scenes = [parse_scene(content, name=name) for name, content in SCENES.items()]
    for scene in scenes:
        folder = results / scene.name
        (folder / "figures").mkdir(parents=True)
        if scene.specimen is not None:
            _specimen(scene, folder)
        else:
            _cells(scene, folder)
    return scenes


COMPUTE = {"analytic": compute_analytic, "fe": compute_reference}


def _cells(scene: Scene, folder: Path) -> None:
    study = build_study(scene)
    files: dict[str, list[Path]] = {"analytic": [], "fe": [], "relaxation": [], "convergence": []}

    def keep(kind, name, result):
        path = folder / "batches" / f"{name}.nc"
        write_batch(result, path, name)
        files[kind].append(path)

    for batch in plan(scene).new:
        kind = batch.name.partition("_")[0]
        if kind == "relaxation":
            keep(kind, batch.name, compute_relaxation(batch, scene.prony))
        else:
            keep(kind, batch.name, COMPUTE[kind](batch))
    if scene.convergence is not None:
        path = folder / "batches" / "convergence.nc"
        write_batch(run_convergence(scene), path, scene.convergence_digest)
        files["convergence"].append(path)
    points = scene, study, files["analytic"], files["fe"]
    groups = collect_other_loads(*points, files["relaxation"])
    groups |= collect_convergence(scene, files["convergence"])
    root = collect(*points, relaxation=files["relaxation"])
    write_dataset(root, folder / "study.nc", groups)
    loads = read_loads(folder / "study.nc")
    accuracy_of_loads(loads).to_csv(folder / "accuracy.csv", index=False)
    first, *others = loads.values()
    draw_scene(scene, first, groups.get("convergence"), folder / "figures", others)


def _specimen(scene: Scene, folder: Path) -> None:
    paths = []
    for part in scene.specimen.parts:
        for position, result in enumerate(run_part(scene, part)):
            if position == 0:
                paths.append(folder / "batches" / f"specimen_{part}.nc")
                write_batch(result, paths[-1], scene.specimen_digest)
    root, groups = collect_specimen(scene, paths)
    write_dataset(root, folder / "study.nc", groups)
    draw_specimen(read_specimen(folder / "study.nc"), folder / "figures")


PATIENCE = 120_000
"""Milliseconds that a busy machine may take for anything."""

NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")
FLAGS = (
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
)


def chromium_path() -> str | None:
    """A Chromium on the path, else the one that Playwright downloaded, else None."""
    found = next((path for name in NAMES if (path := shutil.which(name))), None)
    if found is None:
        from playwright.sync_api import sync_playwright

        with sync_playwright() as playwright:
            own = playwright.chromium.executable_path
        found = own if Path(own).is_file() else None
    return found


@pytest.fixture(scope="session")
def browser():
    path = chromium_path()
    if path is None:
        pytest.skip(
            "THE REPORT WAS NOT TRIED IN A BROWSER: there is no Chromium. Install it "
            "(Debian: apt-get install chromium; else: playwright install chromium) and repeat."
        )
    from playwright.sync_api import sync_playwright

    as_root = ("--no-sandbox",) if os.geteuid() == 0 else ()
    with sync_playwright() as playwright:
        chromium = playwright.chromium.launch(executable_path=path, args=[*FLAGS, *as_root])
        yield chromium
        chromium.close()


@pytest.fixture(scope="session")
def report(browser, tmp_path_factory):
    """The report's path; nothing is computed where there is no browser."""
    results = tmp_path_factory.mktemp("results")
    scenes = make_study(results)
    return write_report(results, results / "report.html", scenes).path


class Visit:
    """The report in a window, with everything that the browser had to say."""

    def __init__(self, browser, path: Path, width: int, **options) -> None:
        height = 900 if width > 600 else 844
        self.page = browser.new_page(viewport={"width": width, "height": height}, **options)
        self.page.set_default_timeout(PATIENCE)
        self.said: list[str] = []
        self.requests: list[str] = []
        self.page.on("console", lambda message: self.said.append(message.text))
        self.page.on("pageerror", lambda error: self.said.append(str(error)))
        self.page.on("request", lambda request: self.requests.append(request.url))
        self.page.goto(path.as_uri())

    def wait(self) -> None:
        self.page.wait_for_function("document.documentElement.dataset.figures === 'drawn'")

    def unfold(self) -> None:
        self.page.evaluate("document.querySelectorAll('details').forEach((d) => (d.open = true))")


@pytest.fixture(scope="session", params=[1280, 390], ids=["wide", "phone"])
def visit(request, browser, report):
    """A visit at each width; tests look, those that change something use `fresh`."""
    seen = Visit(browser, report, request.param)
    seen.wait()
    yield seen
    seen.page.close()


@pytest.fixture
def fresh(browser, report):
    seen = Visit(browser, report, 1280)
    seen.wait()
    yield seen.page
    assert not seen.said
    seen.page.close()


@pytest.fixture
def open_report(browser, report):
    """Opens the report with options of one's own."""
    pages = []

    def opened(width: int = 1280, path: Path = report, **options) -> Visit:
        seen = Visit(browser, path, width, **options)
        pages.append(seen.page)
        return seen

    yield opened
    for page in pages:
        page.close()
