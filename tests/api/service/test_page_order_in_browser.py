"""Many lights on the page: sorted by a column, and searched; in a real browser."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest
from playwright.sync_api import Locator

from selector.recommendation import SHORT_EDGE_PX
from tests.api.service.browsing import CHROMIUM, Visit, open_level
from tests.small_level import POINT, SPOT, SUN, small_level, small_scene

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(CHROMIUM is None, reason="there is no chromium here: apt-get install chromium"),
]
COUNT = 12


@pytest.fixture
def many(at_page: Visit, tmp_path: Path) -> Visit:
    lights = tuple(
        replace((SPOT, POINT, SUN)[index % 3], name=f"Light {COUNT - index}") for index in range(COUNT)
    )
    open_level(at_page, small_level(tmp_path, "many.glb", small_scene(lights)))
    return at_page


def names(found: Visit) -> list[str]:
    return found.page.locator("tbody:not([hidden]) .opens").all_inner_texts()


def figures(found: Visit, label: str) -> list[float]:
    cells = found.page.locator(f'tbody:not([hidden]) td[data-label="{label}"] .figure')
    return [float(text.split()[0]) for text in cells.all_inner_texts()]


def header(found: Visit, name: str) -> Locator:
    return found.page.locator(f'.lights > thead [data-column="{name}"]')


def test_a_column_sorts_one_way_then_the_other_then_not_at_all(many: Visit) -> None:
    as_in_level = [f"Light {number}" for number in range(COUNT, 0, -1)]
    assert names(many) == as_in_level
    header(many, "Light").locator("button").click()
    assert names(many) == as_in_level[::-1]
    assert header(many, "Light").get_attribute("aria-sort") == "ascending"
    assert many.page.inner_text("#status") == "Sorted by light, ascending."
    header(many, "Light").locator("button").press("Enter")
    assert names(many) == as_in_level
    assert header(many, "Light").get_attribute("aria-sort") == "descending"
    header(many, "Light").locator("button").click()
    assert header(many, "Light").get_attribute("aria-sort") is None
    assert many.page.inner_text("#status") == "Sorted as in the level."


def test_what_is_looked_for_stands_on_top(many: Visit) -> None:
    header(many, "Shadow time").locator("button").click()
    times = figures(many, "Shadow time")
    assert len(set(times)) > 1
    assert times == sorted(times, reverse=True)
    header(many, "Confidence").locator("button").click()
    sure = figures(many, "Confidence")
    assert sure == sorted(sure)
    assert header(many, "Shadow time").get_attribute("aria-sort") is None


def test_the_order_outlives_another_policy_but_no_other_level(many: Visit, tmp_path: Path) -> None:
    page = many.page
    header(many, "Light").locator("button").click()
    page.locator("#policies label").first.click()
    page.wait_for_selector("body:not(.asking)")
    assert names(many)[0] == "Light 1"
    many.level(small_level(tmp_path, "other.glb"))
    page.wait_for_selector("#level-name:has-text('other.glb')")
    assert page.locator("[aria-sort]").count() == 0
    # Three lights need no search.
    assert page.locator("#search:visible").count() == 0


def test_lights_are_found_by_what_is_said_of_them(many: Visit) -> None:
    page = many.page
    page.fill("#find", "spot")
    assert len(names(many)) == COUNT // 3
    assert page.inner_text("#found") == f"{COUNT // 3} of {COUNT} lights"
    page.fill("#find", "light 12")
    assert names(many) == ["Light 12"]
    page.click("#expand")
    assert page.locator("tbody.open").count() == 1
    page.fill("#find", "nothing like it")
    assert names(many) == []
    page.fill("#find", "")
    assert len(names(many)) == COUNT
    assert page.inner_text("#found") == ""
    assert many.complaints == []


def test_all_that_are_shown_are_opened_and_closed(many: Visit) -> None:
    page = many.page
    page.fill("#find", "spot")
    page.click("#expand")
    assert page.locator("tbody.open").count() == COUNT // 3
    page.fill("#find", "point")
    assert page.inner_text("#expand") == "Open all"
    page.click("#expand")
    assert page.locator("tbody.open:visible").count() == COUNT // 3
    page.click("#expand")
    assert page.locator("tbody.open:visible").count() == 0
    page.fill("#find", "")
    assert page.locator("tbody.open").count() == COUNT // 3


def test_what_stands_in_the_table_is_found(many: Visit) -> None:
    page = many.page
    titles = page.locator("tr.predicted .use .under").all_inner_texts()
    page.fill("#find", titles[0].lower())
    assert len(names(many)) == titles.count(titles[0])
    offs = page.locator('tr.predicted td[data-label="Edge off"] .figure').all_inner_texts()
    page.fill("#find", "exact")
    assert len(names(many)) == offs.count("exact")
    page.fill("#find", "point dynamic")
    assert len(names(many)) == COUNT // 3


def test_a_column_head_keeps_the_keyboard_and_rows_light_up_once(many: Visit) -> None:
    page = many.page
    header(many, "Light").locator("button").focus()
    page.keyboard.press("Enter")
    # Another policy is answered while the head has the keyboard.
    page.evaluate("document.querySelector('#policies input').click()")
    page.wait_for_selector("#level-facts")
    page.wait_for_selector("body:not(.asking)")
    assert page.evaluate("document.activeElement.className") == "sort"
    page.evaluate("document.querySelector('tbody').classList.add('changed')")
    page.wait_for_selector("tbody.changed", state="detached")


SCRIPT = """async () => {
  const { lightsOf } = await import("/page/answers.js");
  const { offWords } = await import("/page/words.js");
  const settings = {};
  const candidate = (label, wrong_share) => (
    { label, settings, wrong_share, edge_error_px: null, shadow_ms: 1, status: "ok", reason: "" });
  const light = (node, ...candidates) => (
    { node, name: "L", kind: "spot", chosen: candidates[0], runner_up: null, candidates });
  const lights = [light(1, candidate("SV", 0), candidate("SM", 0.056)),
    light(2, candidate("SV", 0), candidate("SM", 0))];
  const found = lightsOf(null, { resolution: [160, 100], max_edge_error_px: 1.5, lights });
  return found.map((one) => one.measured.candidates.map((each) => [offWords(each), each.off]));
}"""


def test_too_little_of_an_edge_is_told_from_none(many: Visit) -> None:
    # The stand-in is that of selector/recommendation.py: so many wrong pixels count as one pixel of edge.
    short = pytest.approx(0.056 * 160 * 100 / SHORT_EDGE_PX)
    assert many.page.evaluate(SCRIPT) == [
        [["none wrong", 0], ["5.6 % wrong", short]],
        [["no edge", 0], ["no edge", 0]],
    ]
