"""The page while it waits, beside jobs, and where what was asked cannot be answered; in a real browser."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from playwright.sync_api import BrowserContext

from tests.api.service.browsing import CHROMIUM, SMALL, Visit, open_level, small, visit
from tests.small_level import small_level

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(CHROMIUM is None, reason="there is no chromium here: apt-get install chromium"),
]


def held(found: Visit) -> None:
    """From now on the service is never asked about a level: as if it read for long."""
    found.page.route("**/v1/levels?*", lambda _: None)


def let_go(found: Visit) -> None:
    found.page.unroute("**/v1/levels?*")


def job_of(context: BrowserContext, address: str, level: Path, **options: str) -> str:
    """A job that another has started."""
    query = "&".join(f"{name}={value}" for name, value in options.items())
    headers = {"Content-Type": "model/gltf-binary"}
    answer = context.request.post(f"{address}/v1/jobs?{query}", data=level.read_bytes(), headers=headers)
    assert answer.status == 202
    return str(answer.json()["id"])


def test_a_level_that_is_read_is_named_and_can_be_cancelled(
    at_page: Visit, level: Path, tmp_path: Path
) -> None:
    page = at_page.page
    held(at_page)
    at_page.level(level)
    page.wait_for_function(
        "() => /^Reading small.glb, [2-9] s$/.test(document.querySelector('#reading strong').textContent)"
    )
    assert page.locator("#drop:visible").count() == 0
    page.click("#reading-cancel")
    page.wait_for_selector("#drop:visible")
    assert page.locator("#reading:visible").count() == page.locator("#problem:visible").count() == 0
    let_go(at_page)
    open_level(at_page, level)
    held(at_page)
    at_page.level(small_level(tmp_path, "second.glb"))
    page.wait_for_selector("#reading:visible:has-text('Reading second.glb')")
    assert page.inner_text("#level-name") == "small.glb"
    page.click("#reading-cancel")
    page.wait_for_selector("#reading", state="hidden")
    assert page.inner_text("#level-name") == "small.glb"
    assert page.locator("tr.predicted").count() == 3
    assert page.locator("input[name=policy][value=quality]").is_enabled()
    let_go(at_page)
    at_page.level(small_level(tmp_path, "second.glb"))
    page.wait_for_selector("#level-name:has-text('second.glb')")


def test_a_question_that_is_cancelled_puts_the_controls_back(at_page: Visit, level: Path) -> None:
    page = at_page.page
    open_level(at_page, level)
    held(at_page)
    page.locator("#policies label", has_text="speed").click()
    page.click("#reading-cancel")
    assert page.locator("input[name=policy][value=balanced]").is_checked()
    assert "Edges may be off by" in page.inner_text("#policies")


def test_the_facts_name_the_device_and_what_all_lights_take(at_page: Visit, level: Path) -> None:
    page = at_page.page
    open_level(at_page, level)
    facts = page.inner_text("#level-facts")
    assert re.search(r"3 lights · glTF 2.0 · seen at 640x360\s+·? ?times of \S", facts)
    page.click("#device")
    assert "gnomon serve --model" in page.inner_text("#level-facts")
    assert re.search(r"\w+ for \d lights?.*ms if all are drawn", page.inner_text("#level-summary"), re.DOTALL)
    page.click("#expand")
    behind = page.locator("tr.behind").first.inner_text()
    assert "What decided" in behind
    assert "log2" not in behind


def test_a_close_call_says_what_it_means_and_settings_what_they_are(at_page: Visit, level: Path) -> None:
    page = at_page.page
    open_level(at_page, level)
    for call in page.locator("tr.predicted .hint").all():
        assert "may well be better" in str(call.get_attribute("title"))
    page.click("#expand")
    page.locator(".picture summary").first.click()
    title = page.locator(".candidates th[title]", has_text="SM").first.get_attribute("title")
    assert re.search(r"a map of \d+ x \d+ texels, (not filtered|filtered over \d x \d texels)", str(title))
    for row in page.locator(".candidates tr:has(th:text-is('SV'))").all():
        assert row.locator(".number").nth(2).text_content() == "exact"


def test_what_was_asked_otherwise_is_not_compared(
    at_page: Visit, level: Path, context: BrowserContext, address: str
) -> None:
    page = at_page.page
    open_level(at_page, level)
    small(at_page)
    job = job_of(context, address, level, name="small.glb", resolution="x".join(SMALL), rounds="1")
    page.evaluate(f"location.hash = '#job={job}'")
    page.wait_for_selector("tr.measured")
    assert "came out as predicted for" in page.inner_text("#table-note")
    assert page.locator("tr.measured .badge", has_text=re.compile("as predicted|other")).count() == 3
    page.locator("#policies label", has_text="quality").click()
    page.wait_for_selector("#table-note:has-text('Not compared')")
    note = page.inner_text("#table-note")
    assert note == (
        "Not compared: measured for edges off by at most 1.5 px, predicted for edges off by at most 0.5 px."
    )
    assert page.locator("tr.measured .badge", has_text=re.compile("as predicted|other")).count() == 0


@pytest.mark.parametrize("value", ["", "-1", "10001"])
def test_an_own_limit_that_cannot_be_asked_is_refused_in_words(
    at_page: Visit, level: Path, value: str
) -> None:
    page = at_page.page
    open_level(at_page, level)
    page.locator("#policies label", has_text="own").click()
    page.wait_for_function("() => document.getElementById('status').textContent.includes('1 pixels')")
    asked: list[str] = []
    page.on("request", lambda one: asked.append(one.url) if one.method == "POST" else None)
    page.fill("#own", value)
    assert page.inner_text("#own-problem") == "0 to 10,000 pixels"
    assert page.locator("#lights.stale").count() == 1
    assert "asked before" in page.inner_text("#table-note")
    for one in ("#measure", "#download"):
        page.click(one)
        assert page.evaluate("document.activeElement.id") == "own"
    page.wait_for_timeout(500)
    assert asked == []
    page.fill("#own", "2")
    page.wait_for_selector("#lights:not(.stale)")
    assert page.inner_text("#own-problem") == ""


def test_a_size_that_cannot_be_asked_is_refused_in_words(at_page: Visit, level: Path) -> None:
    page = at_page.page
    open_level(at_page, level)
    page.select_option("#resolution", "")
    page.fill("#width", "5")
    assert page.inner_text("#size-problem") == "16 to 4096 pixels"
    assert page.locator("#lights.stale").count() == 1
    page.fill("#width", "96")
    page.wait_for_selector("#lights:not(.stale)")
    assert page.locator("#size-problem:visible").count() == 0


def test_a_job_is_complete_in_a_tab_without_its_level(
    context: BrowserContext, address: str, level: Path
) -> None:
    busy = job_of(context, address, level, name="busy.glb", rounds="100")
    job = job_of(context, address, level, name="small.glb", rounds="100")
    found = visit(context, address, f"#job={job}")
    page = found.page
    page.wait_for_selector("#job[data-state=queued]:visible")
    # The page is ready although the job has not ended.
    assert page.inner_text("#level-kicker") == "Waiting for its turn"
    assert page.inner_text("#level-facts") == "3 lights · seen at 640x360"
    assert page.locator("#expand:visible").count() == page.locator("#lights:visible").count() == 0
    assert page.inner_text("#table-note").startswith("This level is not open here.")
    page.click("#job-cancel")
    page.wait_for_selector("#job[data-state=cancelled]")
    assert page.inner_text("#level-kicker") == "Cancelled"
    assert page.inner_text("#recent-name") == "Jobs started here"
    with page.expect_file_chooser() as choosing:
        page.click("#job-again")
    choosing.value.set_files(str(level))
    page.wait_for_selector("tr.predicted")
    assert page.locator("#job:visible").count() == 0
    assert page.locator("#measure:visible").count() == 1
    context.request.delete(f"{address}/v1/jobs/{busy}")
    assert found.complaints == []


def test_back_and_forward_stay_within_the_page(at_page: Visit, level: Path, tmp_path: Path) -> None:
    page = at_page.page
    open_level(at_page, level)
    page.go_back()
    page.wait_for_selector("#drop:visible")
    page.go_forward()
    page.wait_for_selector("#level-name:has-text('small.glb')")
    at_page.level(small_level(tmp_path, "second.glb"))
    page.wait_for_selector("#level-name:has-text('second.glb')")
    page.go_back()
    page.wait_for_selector("#level-name:has-text('small.glb')")
    small(at_page)
    page.click("#measure")
    page.wait_for_selector("#job:visible")
    assert page.evaluate("location.hash").startswith("#job=")
    page.go_back()
    page.wait_for_selector("#job", state="hidden")
    assert page.evaluate("location.hash") == ""
    assert page.locator("tr.predicted").count() == 3
    page.go_forward()
    page.wait_for_selector("#job:visible")
    page.reload()
    page.wait_for_selector("#job:visible")
    page.wait_for_selector("tr.predicted")
    page.go_back()
    page.wait_for_selector("#job", state="hidden")
    page.wait_for_selector("tr.predicted")
    assert page.inner_text("#level-name") == "small.glb"
    page.go_back()
    page.wait_for_selector("#drop:visible")
    page.click("#example")
    page.wait_for_selector("#level-name:has-text('street.glb')")
    page.click("#home")
    page.wait_for_selector("#drop:visible")
    page.go_back()
    page.wait_for_selector("#level-name:has-text('street.glb')")
    page.evaluate("document.querySelector('.skip').click()")
    page.wait_for_function("() => location.hash === ''")
    assert page.locator("tr.predicted:visible").count() == 3


def test_a_level_of_another_format_is_sent_to_the_command_line(at_page: Visit, tmp_path: Path) -> None:
    page = at_page.page
    for name in ("dm4.map", "kitchen.usda", "yard.obj"):
        other = tmp_path / name
        other.write_text("# a level")
        at_page.level(other)
        page.wait_for_selector(f"#problem-what:has-text('{name}')")
        said = f"This page reads glTF; for {name} run: gnomon recommend {name}"
        assert page.inner_text("#problem-what") == said
        assert page.locator("#problem-again:visible").count() == 0
    page.route("**/v1/levels?*", lambda route: route.fulfill(status=503, json={"detail": "Busy."}))
    page.click("#example")
    page.wait_for_selector("#problem-again:visible")


def test_long_names_break_at_what_parts_their_words(at_page: Visit, tmp_path: Path) -> None:
    page = at_page.page
    open_level(at_page, small_level(tmp_path, "a_very_long-name.of.a.level.glb"))
    assert page.locator("#level-name wbr").count() == 7
    assert page.text_content("#level-name") == "a_very_long-name.of.a.level.glb"
