"""The report: self-contained, accessible, and its sentences follow the data."""

import re
from html.parser import HTMLParser
from itertools import pairwise

import pandas as pd
import pytest
import xarray as xr

from bondcell.errors import DataError
from bondcell.evaluate import evaluate
from bondcell.figures import draw_scene
from bondcell.report import write_report
from bondcell.report.convergence_part import convergence_findings
from bondcell.report.front import headlines
from bondcell.report.sections import build_section
from bondcell.report.sweep_findings import sweep_findings
from bondcell.report.symbols import with_subscripts
from bondcell.results.accuracy import accuracy_table
from bondcell.scenes.parsing import parse_scene
from bondcell.scenes.study import build_study
from bondcell.status import Status
from bondcell.storage import write_dataset

CELL = {"radius_i": "7.5 mm", "gap": "0.5 mm", "young_i": "30 GPa", "poisson_i": 0.25}
SCENES = (
    parse_scene(
        {
            "title": "Figure <4> & more",
            "question": "How good is the model?",
            "cell": CELL,
            "sweep": {
                "modulus_ratio": {"start": 1, "stop": 1e6, "points": 25, "spacing": "log"},
                "poisson_m": [0, 0.46],
            },
            "models": ["fsi", "generatrix"],
            "reference": {},
        },
        name="figure4",
    ),
    parse_scene(
        {
            "title": "Ladders",
            "cell": CELL | {"young_m": "1.4 MPa", "poisson_m": 0.46},
            "models": ["fsi"],
            "convergence": {
                "cases": {"base": {}, "narrow_gap": {"gap": "7.5 um"}},
                "orders": [2, 3],
            },
        },
        name="ladders",
    ),
    parse_scene(
        {"title": "Absent", "cell": CELL | {"young_m": 1e6, "poisson_m": 0}, "models": ["fsi"]}
    ),
)


@pytest.fixture(scope="module")
def results(synthetic, tmp_path_factory):
    folder = tmp_path_factory.mktemp("results")
    origin = {"machine": "a test", "versions": '{"numpy": "2"}', "source_revision": "abc123"}
    figure4 = synthetic.figure4.assign_attrs(origin)
    write_dataset(
        figure4.assign_attrs(parameters=SCENES[0].given_json), folder / "figure4" / "study.nc"
    )
    accuracy_table(figure4).to_csv(folder / "figure4" / "accuracy.csv", index=False)
    point = synthetic.point.sel(model=["fsi"]).assign_attrs(
        origin | {"parameters": SCENES[1].given_json}
    )
    write_dataset(point, folder / "ladders" / "study.nc", {"convergence": synthetic.convergence})
    draw_scene(SCENES[0], figure4, None, folder / "figure4" / "figures")
    write_report(folder, folder / "report.html", SCENES)
    return folder


@pytest.fixture(scope="module")
def page(results):
    return (results / "report.html").read_text(encoding="utf-8")


class Outline(HTMLParser):
    """Tags with their attributes, in order; complains about tags that do not close."""

    VOID = frozenset({"meta", "img", "link", "br", "rect", "path", "line", "input", "circle"})

    def __init__(self, page: str) -> None:
        super().__init__()
        self.tags: list[tuple[str, dict[str, str | None]]] = []
        self.open: list[str] = []
        self.feed(page)

    def handle_starttag(self, tag, attrs):
        self.tags.append((tag, dict(attrs)))
        if tag not in self.VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag, attrs):
        self.tags.append((tag, dict(attrs)))

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def all(self, tag):
        return [attributes for name, attributes in self.tags if name == tag]


@pytest.fixture(scope="module")
def outline(page):
    found = Outline(page)
    assert not found.open
    return found


def text_of(page: str) -> str:
    hidden = r"<style>.*?</style>|<script.*?</script>|<[^>]+>"
    without = re.sub(hidden, "", page, flags=re.DOTALL)
    return re.sub(r"\s+", " ", without.replace("\u00a0", " "))


def test_self_contained(page, outline):
    for attribute in ("src", "href"):
        for tag, attributes in outline.tags:
            address = attributes.get(attribute) or ""
            assert not re.match(r"(https?:)?//", address), (tag, address)
    assert [link["href"] for link in outline.all("link")] == ["data:,"]
    styles = page[page.index("<style>") : page.index("</style>")]
    assert "@import" not in styles
    assert "url(" not in styles
    assert all(image["src"].startswith("data:image/") for image in outline.all("img"))


def test_accessible(outline):
    assert outline.all("html")[0]["lang"] == "en"
    assert "width=device-width" in outline.all("meta")[1]["content"]
    assert all(len(image["alt"]) > 20 for image in outline.all("img"))
    levels = [int(tag[1]) for tag, _ in outline.tags if re.fullmatch(r"h[1-6]", tag)]
    assert levels[0] == 1
    assert levels.count(1) == 1
    assert all(later - earlier <= 1 for earlier, later in pairwise(levels))
    names = [attributes["id"] for _, attributes in outline.tags if "id" in attributes]
    assert len(names) == len(set(names))
    anchors = {link["href"][1:] for link in outline.all("a") if link["href"].startswith("#")}
    assert anchors <= set(names)
    assert all("scope" in cell for cell in outline.all("th"))


def test_links_lead_to_files(results, outline):
    files = [link["href"] for link in outline.all("a") if not link["href"].startswith("#")]
    assert {"figure4/study.nc", "figure4/accuracy.csv", "ladders/study.nc"} <= set(files)
    assert all((results / name).is_file() for name in files)


def test_a_folder_of_results_is_enough(results, tmp_path):
    written = write_report(results, tmp_path / "elsewhere" / "page.html")
    assert written.scenes == ["figure4", "ladders"]
    page = written.path.read_text(encoding="utf-8")
    links = [link["href"] for link in Outline(page).all("a") if not link["href"].startswith("#")]
    assert links
    assert all((written.path.parent / link).is_file() for link in links)
    assert text_of(page).count(written.sentences[0].split(",")[0]) >= 1


def test_a_folder_without_results(tmp_path):
    with pytest.raises(DataError, match="a folder of results"):
        write_report(tmp_path, tmp_path / "page.html")
    assert not list(tmp_path.iterdir())


def test_a_table_of_points_needs_no_table(tmp_path):
    """The page made from results alone names the columns that the file has."""
    points = tmp_path / "points.csv"
    points.write_text("gap, young_m\n0.5 mm, 1 MPa\n1 mm, 2 MPa\n")
    given = {
        "title": "Rows",
        "cell": CELL | {"poisson_m": 0.3},
        "design": {"table": points.name},
        "models": ["fsi", "generatrix"],
    }
    scene = parse_scene(given, name="rows", tables=tmp_path)
    inputs = build_study(scene)
    study = xr.concat([evaluate(inputs, model) for model in scene.models], "model")
    study = study.assign_coords(model=list(scene.models)).assign_attrs(parameters=scene.given_json)
    write_dataset(study, tmp_path / "results" / "rows" / "study.nc")
    points.unlink()
    page = write_report(tmp_path / "results", tmp_path / "page.html").path.read_text("utf-8")
    assert re.search(r"2 of the table points\.csv: \w.* and \w", text_of(page))


def test_results_of_another_make_are_named(results, synthetic, tmp_path):
    lacking = synthetic.convergence.drop_vars("reference_error")
    point = synthetic.point.assign_attrs(parameters=SCENES[1].given_json)
    write_dataset(point, tmp_path / "ladders" / "study.nc", {"convergence": lacking})
    with pytest.raises(DataError, match=r"compute the scene again") as caught:
        write_report(tmp_path, tmp_path / "page.html")
    assert "ladders/study.nc" in str(caught.value)
    assert not (tmp_path / "page.html").exists()


def test_content(page):
    text = text_of(page)
    assert "Figure &lt;4&gt; &amp; more" in page
    assert "How good is the model?" in text
    assert "Without results so far: scene." in text
    assert "25 values from 1 to 106, logarithmic spacing" in text
    assert "a test" in text
    assert "abc123" in text
    assert "numpy 2" in text
    assert re.search(r"Page written \d{4}-\d\d-\d\d \d\d:\d\d UTC", text)


def test_poisson_finding_is_on_the_first_screen(page):
    text = text_of(page)
    first = text[: text.index("Contents")]
    assert "too soft, for it ignores Poisson's effect" in first.replace("&#39;", "'")
    assert "3.8 % → 48 %" in first
    assert "the paper puts this at 12" in first
    assert "depends on the Poisson's ratio of the matrix" in text.replace("&#39;", "'")


def findings(study):
    return sweep_findings(study, accuracy_table(study))


def said(study):
    return " ".join(finding.text for finding in findings(study))


def test_sentences_follow_the_data(synthetic):
    assert "depends on the Poisson's ratio" in said(synthetic.figure4)
    same = synthetic.figure4.copy(deep=True)
    at_zero = same["stiffness"].sel(model="fe", poisson_m=0.0)
    same["stiffness"].loc[{"model": "fe", "poisson_m": 0.46}] = at_zero
    assert "depends on" not in said(same)
    assert "off by 3.8 % in the median for a matrix with ν_m = 0 and by 3.8 %" in said(same)


def test_lower_bound_is_checked_not_claimed(synthetic):
    assert "nowhere above finite elements, at 50 points" in said(synthetic.figure4)
    wrong = synthetic.figure4.copy(deep=True)
    wrong["stiffness"].loc[{"model": "generatrix"}] *= 2
    finding = next(f for f in findings(wrong) if "should be a lower bound" in f.text)
    assert finding.key == "+94 %"


def test_particles_and_losses(synthetic):
    text = said(synthetic.figure4)
    assert "by FSI from E_i/E_m = 250 on" in text
    assert "by finite elements from E_i/E_m = 260 (ν_m = 0) and 490 (ν_m = 0.46) on" in text
    assert "there K_n is still 18 % (FSI) and 18 % to 29 % (finite elements) below" in text
    assert "cementation at 25 (diverges)" in text


def test_particles_have_no_headline_where_part_of_the_sweep_does_not_show_them(synthetic):
    """A sweep whose ratios end too early at one Poisson's ratio speaks for the other alone."""
    short = synthetic.figure4.copy(deep=True)
    short["stiffness"].loc[{"model": "fe", "poisson_m": 0.46}] *= short["modulus_ratio"]
    finding = next(f for f in findings(short) if "particles no longer matter" in f.text)
    assert "shows it at 3 of 4 combinations" in finding.text
    assert not finding.key
    full = next(f for f in findings(synthetic.figure4) if "no longer matter" in f.text)
    assert full.key
    assert "combinations" not in full.text


def test_what_lies_outside_a_range_or_a_tolerance_is_told(synthetic):
    assert "outside" not in said(synthetic.figure4)
    assert "are sure to 1e-7 (relative" in said(synthetic.figure4)
    study = synthetic.figure4.copy(deep=True)
    study["status"].loc[{"model": "slices", "poisson_m": 0.46}] = Status.outside_valid_range
    study["status"].loc[{"model": "fe", "modulus_ratio": 1}] = Status.tolerance_not_met
    text = said(study)
    assert "The slices model is outside its stated range at 25 of 50 points; inside, its" in text
    assert "At 2 points they miss the tolerance" in text


def test_nothing_is_said_of_nothing(synthetic):
    assert sweep_findings(synthetic.figure4[["gap"]], pd.DataFrame()) == []
    lone = synthetic.point.sel(model=["fsi"])
    assert findings(lone) == []
    pair = findings(synthetic.point)
    assert pair[0].text == "FSI, the paper's model, is too soft by 48 %."


def test_convergence_findings(synthetic):
    text = " ".join(finding.text for finding in convergence_findings(synthetic.convergence))
    assert (
        "Case base (roller): the structured mesh reaches 1e-6 with 600 unknowns in 250 ms" in text
    )
    assert "come within 3.9e-6 of its finest level with 24000 unknowns in 3.2 s" in text
    assert "at an observed order of 4 in h" in text
    assert "FSI, off by 48 % in 100 ns a point" in text


def test_one_headline_a_topic(results):
    sections = [build_section(scene, results) for scene in SCENES[:2]]
    shown = headlines(sections)
    topics = [finding.topic for _, finding in shown]
    assert topics == ["series model", "particles", "cost", "ranking"]
    assert build_section(SCENES[2], results) is None


def test_symbols_do_not_break_other_text():
    assert str(with_subscripts("gap_modulus, parallel_bond")) == "gap_modulus, parallel_bond"
    assert str(with_subscripts("<K_n>")) == "&lt;<i>K</i><sub>n</sub>&gt;"
    assert "5307ce6" in with_subscripts("5307ce6-dirty")
