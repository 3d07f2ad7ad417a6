"""The page as people use it: in a real browser, at a real service, with and without a mouse."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from pathlib import Path
from urllib.parse import urlsplit

import pytest
from playwright.sync_api import Browser, BrowserContext, Download, FileChooser

from tests.api.command import nodes, succeeded
from tests.api.service.browsing import CHROMIUM, Visit, browser, served, visit
from tests.selector.learning_evidence import filled
from tests.small_level import small_level

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(CHROMIUM is None, reason="there is no chromium here: apt-get install chromium"),
]

TOKEN = "a-token-for-the-tests-long-enough"  # noqa: S105  it opens nothing else
SMALL = ("96", "64")


@pytest.fixture(scope="module")
def model(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("model") / "made.model"
    store = filled(path.with_name("made.sqlite"))
    succeeded("train", "--store", store, "--quick", "-o", path)
    return path


@pytest.fixture(scope="module")
def address(model: Path, tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    with served("--model", model, "--state", tmp_path_factory.mktemp("state")) as url:
        yield url


@pytest.fixture(scope="module")
def chromium() -> Iterator[Browser]:
    with browser() as opened:
        yield opened


@pytest.fixture
def context(chromium: Browser) -> Iterator[BrowserContext]:
    made = chromium.new_context(accept_downloads=True)
    yield made
    made.close()


@pytest.fixture
def at_page(context: BrowserContext, address: str) -> Iterator[Visit]:
    found = visit(context, address)
    yield found
    assert found.complaints == []
    assert found.hosts == {urlsplit(address).netloc}


@pytest.fixture(scope="module")
def level(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return small_level(tmp_path_factory.mktemp("level"))


def open_level(found: Visit, *paths: Path) -> None:
    found.level(*paths)
    found.page.wait_for_selector(".lights tbody")


def small(found: Visit) -> None:
    """Asks for few pixels, so that measuring takes seconds."""
    found.page.select_option("#resolution", "")
    for name, value in zip(("width", "height"), SMALL, strict=True):
        found.page.fill(f"#{name}", value)
    found.page.wait_for_function("() => document.getElementById('level-facts').textContent.includes('96x64')")


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
    for _ in range(12):
        page.keyboard.press("Tab")
        reached.append(
            page.evaluate(
                "document.activeElement.id || document.activeElement.name || document.activeElement.className"
            )
        )
        if reached[-1] == "opens":
            break
    assert reached[:4] == ["device", "measure", "download", "another"]
    assert reached[-1] == "opens"
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


@pytest.mark.parametrize("width", [320, 360, 400, 768, 1600])
def test_nothing_is_cut_off_at_any_width(chromium: Browser, address: str, level: Path, width: int) -> None:
    made = chromium.new_context(viewport={"width": width, "height": 800}, reduced_motion="reduce")
    found = visit(made, address)
    open_level(found, level)
    found.page.click("#expand")
    assert found.page.evaluate("document.documentElement.scrollWidth") <= width
    made.close()
