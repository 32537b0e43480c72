"""The report as a reader has it: drawn, offline, usable by mouse, by keyboard and on a phone."""

import re

from axe_playwright_python.sync_playwright import Axe

SWEEP = "#sweep_explorer"
CHIEF = "#atlas_small_explorer"
FSI, FILM = "#0072b2", "#882255"


def lines(page, figure: str, colour: str | None = None) -> list[str]:
    """Outlines of a figure's curves, of one colour if it is given."""
    strokes = f'[d][stroke="{colour}"]' if colour else "[d]"
    return page.eval_on_selector_all(
        f"{figure} .plot .mark-line path{strokes}", "all => all.map((path) => path.outerHTML)"
    )


def settle(page) -> None:
    """Wait until no figure is being drawn."""
    page.wait_for_function("!document.querySelector('.interactive[data-state=drawing]')")


def texts(page, selector: str) -> list[str]:
    return page.eval_on_selector_all(selector, "all => all.map((each) => each.textContent)")


def test_quiet_and_offline(visit, report):
    assert visit.said == []
    outside = [url for url in visit.requests if not url.startswith("data:")]
    assert outside == [report.as_uri()]


def test_every_figure_is_drawn(visit):
    page = visit.page
    states = page.eval_on_selector_all(
        ".interactive", "all => all.map((each) => [each.id, each.dataset.state])"
    )
    assert {"cost", "sweep_explorer", "ladders_ladders", "relaxing_explorer"} <= {
        name for name, _ in states
    }
    assert all(state == "drawn" for _, state in states)
    for name, _ in states:
        box = page.locator(f"#{name} .plot svg").bounding_box()
        assert box["width"] > 250
        assert box["height"] > 150
        drawn = "path => path.getBBox().width + path.getBBox().height > 0"
        marks = page.eval_on_selector_all(
            f"#{name} .mark-symbol path, #{name} .mark-line path",
            f"all => all.filter({drawn}).length",
        )
        assert marks > 0, name


def test_every_picture_is_there(visit):
    visit.unfold()
    page = visit.page
    for image in page.locator("img").all():
        image.scroll_into_view_if_needed()
    page.wait_for_function("[...document.images].every((i) => i.complete && i.naturalWidth > 0)")
    assert page.locator("img").count() > 3


def test_no_scrolling_sideways(visit):
    visit.unfold()
    width = visit.page.viewport_size["width"]
    assert visit.page.evaluate("document.documentElement.scrollWidth") <= width


def test_accessible(visit):
    visit.unfold()
    found = Axe().run(visit.page).response["violations"]
    grave = [
        (each["id"], [node["html"][:200] for node in each["nodes"][:3]])
        for each in found
        if each["impact"] in ("serious", "critical")
    ]
    assert grave == []


def test_answers_stand_on_the_first_screen(fresh):
    for selector in ("h1", ".headlines", ".sentences", f"{CHIEF} .plot"):
        box = fresh.locator(selector).bounding_box()
        assert box["y"] + box["height"] <= 900, selector


def test_sliders_move_the_curves(fresh):
    slider = fresh.locator(f"{SWEEP} input[data-control=poisson_m]")
    said = fresh.locator(f"{SWEEP} .slider:has([data-control=poisson_m]) output")
    before = lines(fresh, SWEEP, FSI)
    assert len(before) == 1
    assert said.text_content() == "0.46"
    slider.focus()
    fresh.keyboard.press("ArrowLeft")
    settle(fresh)
    assert said.text_content() == "0"
    assert slider.get_attribute("aria-valuetext") == "0"
    after = lines(fresh, SWEEP, FSI)
    assert len(after) == 1
    assert after != before
    fresh.keyboard.press("ArrowRight")
    settle(fresh)
    assert lines(fresh, SWEEP, FSI) == before


def test_every_slider_of_every_figure_does_something(fresh):
    for slider in fresh.locator(".interactive input[type=range]:enabled").all():
        figure = slider.evaluate("input => input.closest('.interactive').id")
        place = f"#{figure} .plot .mark-symbol"
        before = fresh.locator(place).last.inner_html()
        at = slider.input_value()
        slider.fill("0" if at != "0" else "1")
        settle(fresh)
        assert fresh.locator(place).last.inner_html() != before, slider.get_attribute("id")
        slider.fill(at)


def test_switches_hide_curves(fresh):
    box = fresh.locator(f"{SWEEP} input[data-switch][value=fsi]")
    others = len(lines(fresh, SWEEP))
    box.focus()
    fresh.keyboard.press("Space")
    settle(fresh)
    assert lines(fresh, SWEEP, FSI) == []
    assert len(lines(fresh, SWEEP)) == others - 1
    fresh.click(f"{SWEEP} [data-all=off]")
    settle(fresh)
    assert lines(fresh, SWEEP) == []
    fresh.click(f"{SWEEP} [data-all=on]")
    settle(fresh)
    assert len(lines(fresh, SWEEP)) == others


def test_menus_choose_what_is_drawn(fresh):
    titles = f"{CHIEF} .plot .role-axis-title text"
    assert any("modulus ratio" in text for text in texts(fresh, titles))
    fresh.select_option(f"{CHIEF} [data-control=across]", label="relative gap Lg/Rᵢ")
    settle(fresh)
    assert any("relative gap" in text for text in texts(fresh, titles))
    assert fresh.locator(f"{CHIEF} [data-control=gap_ratio]").is_disabled()
    assert fresh.locator(f"{CHIEF} [data-control=modulus_ratio]").is_enabled()
    normal = lines(fresh, CHIEF, FILM)
    fresh.select_option(f"{CHIEF} [data-control=load]", label="torsion")
    settle(fresh)
    assert lines(fresh, CHIEF, FILM) != normal
    assert lines(fresh, CHIEF, FSI) == []  # it knows no torsion
    fresh.select_option(f"{CHIEF} [data-control=upward]", index=2)
    settle(fresh)
    assert any("stiffness K [N/m or N m/rad]" in text for text in texts(fresh, titles))


def test_logarithms_can_be_switched_off(fresh):
    labels = f"{SWEEP} .plot .role-axis-label text"
    before = texts(fresh, labels)
    fresh.uncheck(f"{SWEEP} [data-control=log_x]")
    settle(fresh)
    assert texts(fresh, labels) != before
    # Poisson's ratio begins at zero: no logarithm is offered.
    fresh.select_option(f"{SWEEP} [data-control=across]", index=2)
    settle(fresh)
    assert fresh.locator(f"{SWEEP} [data-control=log_x]").is_disabled()


def test_a_point_says_value_error_and_time(fresh):
    fresh.locator(f"{CHIEF} .plot .mark-symbol path").first.hover(force=True)
    fresh.wait_for_selector("#vg-tooltip-element.visible")
    said = fresh.text_content("#vg-tooltip-element")
    for word in ("model", "K", "N/m", "error", "%", "time a point", "flag"):
        assert word in said, said


def test_rigid_particles_have_a_place(fresh):
    assert "rigid" in texts(fresh, f"{CHIEF} .plot .role-axis-label text")


def test_points_of_a_design_lie_over_any_of_their_parameters(fresh):
    figure = "#scattered_explorer"
    marks = f"{figure} .plot .mark-symbol path"
    assert lines(fresh, figure) == []  # neighbours along x do not belong together
    assert fresh.locator(marks).count() >= 16
    places = "all => all.map((path) => path.getAttribute('transform'))"
    before = fresh.locator(marks).evaluate_all(places)
    menu = f"{figure} [data-control=across]"
    for label in ("modulus ratio", "Poisson's ratio of the matrix", "gap"):
        option = fresh.locator(f"{menu} option", has_text=label).first.text_content()
        fresh.select_option(menu, label=option)
        settle(fresh)
        titles = texts(fresh, f"{figure} .plot .role-axis-title text")
        assert any(label in title for title in titles)
    assert fresh.locator(marks).evaluate_all(places) != before


def test_tables_sort_by_value(fresh):
    table = fresh.locator("section[aria-labelledby=ladders] table").first
    headings = table.locator("thead th").all_text_contents()
    column = headings.index("total time")
    button = table.locator("thead th button").nth(column)
    cells = f"all => all.map((row) => Number(row.cells[{column}].dataset.value))"
    button.focus()
    fresh.keyboard.press("Enter")
    assert table.locator("thead th").nth(column).get_attribute("aria-sort") == "ascending"
    rising = table.locator("tbody tr").evaluate_all(cells)
    assert rising == sorted(rising)
    assert len(set(rising)) > 2
    button.click()
    assert table.locator("thead th").nth(column).get_attribute("aria-sort") == "descending"
    assert table.locator("tbody tr").evaluate_all(cells) == sorted(rising, reverse=True)
    assert table.locator("[aria-sort]").count() == 1


def test_every_table_can_be_sorted(fresh):
    fresh.evaluate("document.querySelectorAll('details').forEach((d) => (d.open = true))")
    rows = "all => all.map((row) => row.textContent)"
    tables = fresh.locator("table:has(th button)").all()
    assert len(tables) > 8
    for table in tables:
        before = table.locator("tbody tr").evaluate_all(rows)
        table.locator("th button").evaluate_all("all => all.forEach((button) => button.click())")
        assert sorted(table.locator("tbody tr").evaluate_all(rows)) == sorted(before)


def test_keyboard_reaches_the_findings(fresh):
    fresh.keyboard.press("Tab")
    assert fresh.evaluate("document.activeElement.className") == "skip"
    fresh.keyboard.press("Enter")
    assert fresh.url.endswith("#main")


def test_print_shows_everything_but_controls(fresh, tmp_path):
    path = tmp_path / "report.pdf"
    fresh.emulate_media(media="print")
    fresh.evaluate("dispatchEvent(new Event('beforeprint'))")
    assert fresh.locator("details:not([open])").count() == 0
    assert not fresh.locator(f"{SWEEP} input").first.is_visible()
    # What they are set to is part of the figure.
    assert fresh.locator(f"{SWEEP} .slider:has([data-control=poisson_m]) output").is_visible()
    assert not fresh.locator(f"{SWEEP} .slider:has([data-control=modulus_ratio])").is_visible()
    assert fresh.locator(f"{SWEEP} .plot svg").is_visible()
    fresh.evaluate("dispatchEvent(new Event('afterprint'))")
    assert fresh.locator("details:not([open])").count() > 0
    content = fresh.pdf(path=path, format="A4", print_background=True)
    assert content.startswith(b"%PDF")
    assert len(re.findall(rb"/Type\s*/Page\b", content)) >= 5


def test_without_scripts_the_words_are_there(open_report):
    page = open_report(java_script_enabled=False).page
    assert page.locator(".sentences p").count() == 3
    assert page.locator("noscript .notice, .interactive .notice").first.is_visible()
    assert page.locator("table").first.is_visible()


def test_a_figure_that_fails_says_so_and_leaves_the_others(open_report, report, tmp_path):
    broken = tmp_path / "broken.html"
    page = report.read_text(encoding="utf-8")
    broken.write_text(page.replace('"mark":{"type":"line"', '"mark":{"type":"nonsense"', 1))
    seen = open_report(path=broken)
    seen.wait()
    states = seen.page.eval_on_selector_all(
        ".interactive", "all => all.map((each) => each.dataset.state)"
    )
    assert states.count("failed") == 1
    assert "cannot be drawn" in seen.page.text_content(".interactive[data-state=failed] .plot")


def test_scenes_without_values_have_their_say(fresh):
    text = fresh.text_content("section[aria-labelledby=incompressible]")
    assert "diverges" in text
    assert "FSI (paper)" in fresh.text_content("section[aria-labelledby=point]")
