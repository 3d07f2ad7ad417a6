"""The page as people use it: in a real browser, at a real service, with and without a mouse."""

from __future__ import annotations

import json
import re
from pathlib import Path
from urllib.parse import urlsplit

import pytest
from playwright.sync_api import Browser, BrowserContext, Download, FileChooser

from tests.api.command import nodes
from tests.api.service.browsing import CHROMIUM, Visit, open_level, served, small, visit
from tests.small_level import small_level

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(CHROMIUM is None, reason="there is no chromium here: apt-get install chromium"),
]

TOKEN = "a-token-for-the-tests-long-enough"  # noqa: S105  it opens nothing else


def contents(download: Download) -> bytes:
    return Path(download.path()).read_bytes()


def split_level(folder: Path, level: Path) -> tuple[Path, Path]:
    """The same level as a .gltf with its buffer in a file."""
    source = level.read_bytes()
    length = int.from_bytes(source[12:16], "little")
    document = json.loads(source[20 : 20 + length])
    document["buffers"][0]["uri"] = "parts/a%20buffer.bin"
    buffer = folder / "a buffer.bin"
    buffer.write_bytes(source[20 + length + 8 :])
    path = folder / "small.gltf"
    path.write_text(json.dumps(document))
    return path, buffer


def test_a_level_becomes_a_table_with_all_that_is_behind_each_light(at_page: Visit, level: Path) -> None:
    page = at_page.page
    open_level(at_page, level)
    assert page.locator(".opens").all_inner_texts() == ["Lamp", "Torch", "Sun"]
    assert all(re.match(r"(SM|PSM|LiSPSM|SV|Chan)\b", name) for name in at_page.techniques())
    assert page.locator("tr.predicted td.number .figure").count() == 9
    page.click("#expand")
    assert page.locator("tr.behind:visible").count() == 3
    first = page.locator("tr.behind").first
    assert first.locator(".plot .dot").count() > 5
    assert first.locator(".plot .dot.chosen").count() == 1
    assert "Runner-up" in first.inner_text()
    assert "What decided" in first.inner_text()
    assert first.get_by_text("unlike those that the model has learnt from").count() == 1
    assert page.locator("#status").text_content().startswith("Answers for 3 lights of small.glb")


def test_the_policy_and_the_mobility_are_the_users(at_page: Visit, level: Path) -> None:
    page = at_page.page
    open_level(at_page, level)
    for name in ("speed", "quality"):
        with page.expect_response(lambda one, name=name: f"policy={name}" in one.url and one.ok):
            page.locator("#policies label", has_text=name).click()
    with page.expect_response(lambda one: "mobility=static" in one.url and one.ok):
        page.locator("#mobilities label", has_text="static").click()
    page.wait_for_function(
        """() => [...document.querySelectorAll("th.light .under")]
          .every((one) => one.textContent.endsWith("static"))"""
    )
    page.locator("#policies label", has_text="own").click()
    with page.expect_response(lambda one: "max_edge_error_px=0.25" in one.url and one.ok):
        page.fill("#own", "0.25")


def test_a_level_of_several_files_is_sent_whole_and_a_missing_one_is_named(
    at_page: Visit, level: Path, tmp_path: Path
) -> None:
    page = at_page.page
    path, buffer = split_level(tmp_path, level)
    at_page.level(path)
    page.wait_for_selector("#problem:visible")
    assert "names 1 file that was not chosen with it: parts/a buffer.bin" in page.inner_text("#problem")
    open_level(at_page, path, buffer)
    assert page.locator("#problem:visible").count() == 0
    assert page.locator(".opens").all_inner_texts() == ["Lamp", "Torch", "Sun"]
    with page.expect_download() as waiting:
        page.click("#download")
    assert waiting.value.suggested_filename == "small.annotated.gltf"
    assert b"gnomon_technique" in contents(waiting.value)


def test_a_dropped_file_is_taken(at_page: Visit, level: Path) -> None:
    page = at_page.page
    script = """([bytes, name]) => {
      const transfer = new DataTransfer();
      transfer.items.add(new File([new Uint8Array(bytes)], name));
      dispatchEvent(new DragEvent("dragenter", {dataTransfer: transfer, cancelable: true}));
      if (document.getElementById("veil").hidden) throw new Error("nothing shows where to drop");
      const how = {dataTransfer: transfer, bubbles: true, cancelable: true};
      document.body.dispatchEvent(new DragEvent("drop", how));
    }"""
    page.evaluate(script, [list(level.read_bytes()), "dropped.glb"])
    page.wait_for_selector(".lights tbody")
    assert page.inner_text("#level-name") == "dropped.glb"
    assert page.locator("#veil:visible").count() == 0


def test_without_a_mouse(at_page: Visit) -> None:
    page = at_page.page
    # From the start: a chooser that opens before the browser has been told to catch it is lost.
    choosers: list[FileChooser] = []
    page.on("filechooser", lambda one: choosers.append(one))  # noqa: PLW0108  a builtin cannot be a handler
    page.keyboard.press("Tab")
    assert page.evaluate("document.activeElement.className") == "skip"
    for _ in range(3):
        page.keyboard.press("Tab")
    assert page.evaluate("document.activeElement.id") == "example"
    assert page.evaluate("getComputedStyle(document.activeElement).outlineStyle") == "solid"
    page.keyboard.press("Shift+Tab")
    assert page.evaluate("document.activeElement.id") == "drop"
    page.keyboard.press("Enter")
    while not choosers:
        page.wait_for_timeout(50)
    page.keyboard.press("Tab")
    page.keyboard.press("Enter")
    page.wait_for_selector(".lights tbody")
    assert page.evaluate("document.activeElement.id") == "level-name"
    reached = []
    for _ in range(20):
        page.keyboard.press("Tab")
        reached.append(
            page.evaluate(
                "document.activeElement.id || document.activeElement.name || document.activeElement.className"
            )
        )
        if reached[-1] == "opens":
            break
    assert reached[:4] == ["device", "measure", "download", "another"]
    assert reached[-6:] == [*["sort"] * 5, "opens"]
    page.keyboard.press("Enter")
    assert page.locator(".opens").first.get_attribute("aria-expanded") == "true"
    assert page.locator("tr.behind:visible").count() == 1
    page.keyboard.press("Space")
    assert page.locator("tr.behind:visible").count() == 0
    page.locator("input[name=policy][value=balanced]").focus()
    with page.expect_response(lambda one: "policy=quality" in one.url):
        page.keyboard.press("ArrowRight")


def test_a_job_runs_to_its_end_and_a_reload_comes_back_to_it(
    at_page: Visit, level: Path, context: BrowserContext, address: str
) -> None:
    page = at_page.page
    open_level(at_page, level)
    small(at_page)
    page.click("#measure")
    page.wait_for_selector("#job:visible")
    assert re.fullmatch(r"#job=[\w-]{22,}", page.evaluate("location.hash"))
    page.reload()
    page.wait_for_selector("#job[data-state=done]:visible")
    page.wait_for_selector("tr.measured")
    assert page.locator("tr.predicted").count() == page.locator("tr.measured").count() == 3
    assert page.locator(".jobs .badge").all_inner_texts() == ["done"]
    assert "came out as predicted for" in page.inner_text("#table-note")
    with page.expect_download() as waiting:
        page.click("#job-download")
    assert waiting.value.suggested_filename == "small.annotated.glb"
    found = nodes(Path(waiting.value.path()))
    assert {one["extras"]["gnomon_source"] for one in found.values()} == {"measured"}
    with page.expect_download() as waiting:
        page.click("#download")
    found = nodes(Path(waiting.value.path()))
    assert {one["extras"]["gnomon_source"] for one in found.values()} == {"predicted"}
    with context.expect_page() as opening:
        page.click("#job-report")
    report = opening.value
    report.wait_for_load_state()
    assert "small.glb" in report.title()
    # Another window, which has no level, shows what was measured.
    other = visit(context, address, page.evaluate("location.hash"))
    other.page.wait_for_selector("tr.measured")
    assert other.complaints == []


def test_a_job_can_be_cancelled(at_page: Visit) -> None:
    page = at_page.page
    page.click("#example")
    page.wait_for_selector(".lights tbody")
    page.click("#measure")
    page.click("#job-cancel")
    page.wait_for_selector("#job[data-state=cancelled]")
    assert page.inner_text("#job-name") == "Cancelled"
    page.click("#job-close")
    assert page.locator("#job:visible").count() == 0
    assert page.locator("tr.predicted").count() == 3


def test_what_is_wrong_is_said_in_the_services_words(at_page: Visit, level: Path, tmp_path: Path) -> None:
    page = at_page.page
    broken = tmp_path / "broken.glb"
    broken.write_bytes(level.read_bytes()[:400])
    at_page.level(broken)
    page.wait_for_selector("#problem:visible")
    assert "This GLB ends before the length that its header states." in page.inner_text("#problem-what")
    page.click("#problem-close")
    at_page.level(small_level(tmp_path, "one.glb"), small_level(tmp_path, "two.glb"))
    page.wait_for_selector("#problem:visible")
    assert page.inner_text("#problem-what") == "These are 2 levels: one.glb, two.glb."
    page.evaluate("location.hash = '#job=aaaaaaaaaaaaaaaaaaaaaaaa'")
    page.wait_for_function("() => document.getElementById('problem-what').textContent.includes('job')")
    page.wait_for_function("() => location.hash === ''")


def test_a_job_that_the_service_no_longer_has_leaves_the_page(at_page: Visit) -> None:
    page = at_page.page
    job = {"id": "a" * 24, "level": "gone.glb", "state": "done", "created": "2030-01-01T00:00:00Z"}
    page.evaluate(f"localStorage.setItem('gnomon.jobs', JSON.stringify([{json.dumps(job)}]))")
    page.reload()
    page.click(".jobs a:has-text('gone.glb')")
    page.wait_for_selector("#problem:visible")
    page.wait_for_function("() => document.querySelectorAll('.jobs li').length === 0")
    page.reload()
    page.wait_for_selector("body:not(.starting)")
    assert page.locator("#problem:visible").count() == 0


def test_a_name_is_text_whatever_it_holds(at_page: Visit, level: Path, tmp_path: Path) -> None:
    hostile = tmp_path / "<img src=x onerror=alert(1)>.glb"
    hostile.write_bytes(level.read_bytes())
    open_level(at_page, hostile)
    assert at_page.page.locator("#level-name img").count() == 0
    assert "<img" in at_page.page.inner_text("#level-name")


def test_a_service_that_went_away_is_waited_for(
    context: BrowserContext, model: Path, level: Path, tmp_path: Path
) -> None:
    state = ("--model", model, "--state", tmp_path)
    with served(*state) as url:
        found = visit(context, url)
        open_level(found, level)
    page, port = found.page, urlsplit(url).port
    page.locator("#policies label", has_text="quality").click()
    page.wait_for_selector("#away:visible")
    assert "Nothing is lost" in page.inner_text("#away")
    with served(*state, "--port", port):
        page.click("#away-now")
        page.wait_for_selector("#away", state="hidden")
        page.wait_for_function("() => document.getElementById('status').textContent.includes('0.5 pixels')")
    assert found.complaints == []


def test_a_token_is_asked_for_where_one_is_wanted(
    context: BrowserContext, model: Path, level: Path, tmp_path: Path
) -> None:
    with served("--model", model, "--state", tmp_path, GNOMON_TOKEN=TOKEN) as url:
        page = context.new_page()
        page.goto(url)
        for given in ("not this one", TOKEN):
            page.wait_for_selector("#token:visible")
            page.fill("#token-field", given)
            page.keyboard.press("Enter")
        page.wait_for_selector("body:not(.starting)")
        page.set_input_files("#files", str(level))
        page.wait_for_selector(".lights tbody")


@pytest.mark.parametrize("width", [320, 360, 400, 768, 1600])
def test_nothing_is_cut_off_at_any_width(chromium: Browser, address: str, level: Path, width: int) -> None:
    made = chromium.new_context(viewport={"width": width, "height": 800}, reduced_motion="reduce")
    found = visit(made, address)
    open_level(found, level)
    found.page.click("#expand")
    assert found.page.evaluate("document.documentElement.scrollWidth") <= width
    made.close()
