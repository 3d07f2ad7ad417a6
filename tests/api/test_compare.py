"""What `gnomon compare` writes: a page that stands alone, shows everything, and trusts no name."""

from __future__ import annotations

import html
import json
import re
import signal
from collections.abc import Iterator
from dataclasses import dataclass, replace
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import pytest

from api import comparing
from renderers.registry import TECHNIQUES
from scenes.scene import Light, LightKind, Scene
from tests.api.command import answered, files, gnomon, running, succeeded, wait_for_line
from tests.small_level import CAMERA, POINT, SPOT, SUN, named, small_level, small_scene
from tests.solids import floor

SIZE = ("--resolution", "96x64", "--rounds", 1)
QUICK = (*SIZE, "--light", "Torch", "-t", "SV")
VOID = {"meta", "input", "img", "br", "link", "hr"}
LINKING = {"src", "href", "srcset", "data", "action", "poster", "formaction", "xlink:href"}
NOWHERE = Light("Nowhere", LightKind.POINT, position=(0.0, 900.0, 0.0), range_m=1.0)
HOSTILE = (
    '<script>alert("light")</script>',
    "</style><img src=x onerror=alert(1)>",
    "光源 مصباح лампа 'quoted' & co",
    "L" * 300,
)


class Page(HTMLParser):
    """A page as a browser would read it; what does not balance fails."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.tags: list[tuple[str, dict[str, str]]] = []
        self.text = ""
        self._open: list[str] = []
        self.feed(text)
        self.close()
        assert self._open == [], "all that is opened is closed"

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append((tag, {name: value or "" for name, value in attrs}))
        if tag not in VOID:
            self._open.append(tag)

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append((tag, {name: value or "" for name, value in attrs}))

    def handle_endtag(self, tag: str) -> None:
        assert self._open, f"</{tag}> closes nothing"
        assert self._open.pop() == tag

    def handle_data(self, data: str) -> None:
        if not {"style", "script"} & set(self._open):
            self.text += data

    def all(self, tag: str, **wanted: str) -> list[dict[str, str]]:
        return [
            attributes
            for name, attributes in self.tags
            if name == tag and all(value in attributes.get(key, "").split() for key, value in wanted.items())
        ]

    def keys(self, tag: str) -> list[str]:
        return [attributes["data-key"] for attributes in self.all(tag) if "data-key" in attributes]


@dataclass(frozen=True)
class Made:
    text: str
    page: Page
    record: dict[str, Any]
    size: int


@pytest.fixture(scope="module", autouse=True)
def _one_candidate_each() -> Iterator[None]:
    with pytest.MonkeyPatch.context() as patch:
        for method in {type(known) for known in TECHNIQUES}:
            known_ones = method.candidates
            patch.setattr(method, "candidates", lambda *a, known_ones=known_ones: known_ones(*a)[:1])
        yield


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Made:
    folder = tmp_path_factory.mktemp("page")
    level = small_level(folder)
    before = level.read_bytes()
    record = answered("compare", level, *SIZE)
    output = folder / "small.compare.html"
    assert record["output"] == str(output)
    assert files(folder) == {"small.glb", "small.compare.html"}
    assert level.read_bytes() == before
    text = output.read_text(encoding="utf-8")
    return Made(text, Page(text), record, output.stat().st_size)


@pytest.fixture
def level(tmp_path: Path) -> Path:
    return small_level(tmp_path)


def page_of(path: Path) -> Page:
    return Page(path.read_text(encoding="utf-8"))


def test_the_page_stands_alone(made: Made) -> None:
    for _, attributes in made.page.tags:
        for name in LINKING & set(attributes):
            assert attributes[name].startswith(("#", "data:image/webp;base64,")), attributes
    assert set(re.findall(r"url\((.{5})", made.text)) == {"data:"}
    assert not re.search(r"https?:|@import|@font-face", made.text)
    (policy,) = [one["content"] for one in made.page.all("meta") if "http-equiv" in one]
    assert "default-src 'none'" in policy


def test_links_lead_somewhere_and_ids_are_used_once(made: Made) -> None:
    ids = [attributes["id"] for _, attributes in made.page.tags if "id" in attributes]
    assert len(ids) == len(set(ids))
    links = {one["href"][1:] for tag in ("a", "use") for one in made.page.all(tag)}
    assert links
    assert links <= set(ids)


def test_every_light_has_every_candidate_in_table_plot_and_pictures(made: Made) -> None:
    assert [light["name"] for light in made.record["lights"]] == ["Lamp", "Torch", "Sun"]
    for index, light in enumerate(made.record["lights"]):
        assert light["name"] in made.page.text
        rows = [f"light-{index}-{place}" for place in range(len(light["candidates"]))]
        of_light = [key for key in made.page.keys("tr") if key.startswith(f"light-{index}-")]
        assert of_light == rows
        assert [key for key in made.page.keys("li") if key.startswith(f"light-{index}-")] == rows
        weighed = [row for row, one in zip(rows, light["candidates"], strict=True) if one["status"] == "ok"]
        dots = [key for key in made.page.keys("a") if key.startswith(f"light-{index}-")]
        assert sorted(dots) == sorted(weighed)
        for one in light["candidates"]:
            assert one["label"] in made.page.text
            assert html.escape(one["reason"]) in made.text
        assert light["reason"] in made.page.text
    assert {one["technique"] for one in made.record["lights"][0]["candidates"]} == {
        known.name for known in TECHNIQUES
    }


def test_the_choice_is_marked(made: Made) -> None:
    for index, light in enumerate(made.record["lights"]):
        place = next(
            place
            for place, one in enumerate(light["candidates"])
            if (one["technique"], one["settings"])
            == (light["chosen"]["technique"], light["chosen"]["settings"])
        )
        for tag in ("tr", "li", "a"):
            marked = [one["data-key"] for one in made.page.all(tag, **{"class": "chosen"})]
            assert [key for key in marked if key.startswith(f"light-{index}-")] == [f"light-{index}-{place}"]


def test_each_candidate_has_a_picture_and_an_error_map(made: Made) -> None:
    drawn = sum(
        len(one["views"]) for light in made.record["lights"] for one in light["measurement"]["candidates"]
    )
    assert drawn
    pictures = [one for one in made.page.all("img", **{"class": "over"}) if one.get("src")]
    assert len(pictures) == 2 * drawn
    assert all(one["alt"] for one in pictures)
    assert sum("Error map" in one["alt"] for one in pictures) == drawn


def test_the_foot_says_how_it_was_measured(made: Made) -> None:
    record = made.record
    for words in (record["digest"], record["device"]["renderer"], record["clock"], "96x64", "1 round"):
        assert words in made.page.text
    assert record["output_bytes"] == made.size


def test_the_page_is_read_without_script(made: Made) -> None:
    assert made.page.all("details", **{"class": "view"})[0].get("open") is not None
    assert len(made.page.all("script")) == 1


def test_the_json_holds_every_measurement(made: Made) -> None:
    lamp = made.record["lights"][0]
    assert lamp["measurement"]["light"]["name"] == "Lamp"
    good = [one for one in lamp["measurement"]["candidates"] if one["status"] == "ok"]
    assert good
    assert all(view["samples"] for one in good for view in one["views"])
    assert made.record["lights_left_out"] == 0
    assert json.dumps(made.record, allow_nan=False)


def test_names_from_a_level_stay_text(tmp_path: Path) -> None:
    lights = tuple(named(POINT, name) for name in HOSTILE)
    camera = replace(CAMERA, name='"><script>alert("camera")</script>')
    level = small_level(tmp_path, "<b>level</b>.glb".replace("/", "_"), small_scene(lights, (camera,)))
    succeeded("compare", level, *SIZE, "-t", "SV", "-o", tmp_path / "page.html")
    text = (tmp_path / "page.html").read_text(encoding="utf-8")
    page = Page(text)
    assert len(page.all("script")) == 1
    assert len(page.all("style")) == 1
    assert not page.all("img", src="x")
    for name in (*HOSTILE, camera.name, level.name):
        assert name in page.text
        assert html.escape(name) == name or name not in text


def test_what_turns_text_around_is_shown_and_not_obeyed(tmp_path: Path) -> None:
    level = small_level(tmp_path, scene=small_scene((named(POINT, "abc\u202edef\x1b[31m"),)))
    succeeded("compare", level, *SIZE, "-t", "SV")
    text = (tmp_path / "small.compare.html").read_text(encoding="utf-8")
    assert "\u202e" not in text
    assert "\x1b" not in text
    assert "abc\\u202edef\\x1b[31m" in Page(text).text


def test_the_first_lights_only_unless_others_are_asked_for(
    level: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(comparing, "MOST_LIGHTS", 1)
    result = succeeded("compare", level, *SIZE, "-t", "SV", width=200)
    assert "2 more lights left out" in result.stderr
    page = page_of(tmp_path / "small.compare.html")
    assert len(page.all("section", **{"class": "light"})) == 1
    assert "2 lights of this level are not on this page" in page.text
    record = answered("compare", level, *SIZE, "-t", "SV", "--light", "Sun", "--light", "Lamp")
    assert [light["name"] for light in record["lights"]] == ["Lamp", "Sun"]
    assert record["lights_left_out"] == 0


def test_the_terminal_says_what_was_written_and_how_large(level: Path, tmp_path: Path) -> None:
    result = succeeded("compare", level, *QUICK, "-o", tmp_path / "p.html", width=200)
    size = (tmp_path / "p.html").stat().st_size
    assert f"Wrote {tmp_path / 'p.html'}, {size / 1024:,.1f} KiB" in result.stdout
    assert "Torch: SV is the cheapest" in result.stdout


def test_the_limit_and_the_mobility_can_be_given(level: Path, tmp_path: Path) -> None:
    record = answered("compare", level, *QUICK, "--max-edge-error-px", 0.25, "--mobility", "static")
    assert record["max_edge_error_px"] == 0.25
    assert record["lights"][0]["mobility"] == "static"
    page = page_of(tmp_path / "small.compare.html")
    assert "0.25 px" in page.text
    assert "timed as a static light" in page.text


def test_flicker_is_shown_where_it_was_asked_for(level: Path, tmp_path: Path) -> None:
    record = answered("compare", level, *QUICK, "--flicker")
    assert record["lights"][0]["candidates"][0]["flicker"] == 0.0
    page = page_of(tmp_path / "small.compare.html")
    assert page.text.count("Flicker") == 2, "in the table's head and in the foot"
    succeeded("compare", level, *QUICK)
    assert page_of(tmp_path / "small.compare.html").text.count("Flicker") == 1


def test_a_light_without_an_answer_is_on_the_page_and_exit_6(tmp_path: Path) -> None:
    level = small_level(tmp_path, scene=small_scene((NOWHERE, SUN), ()))
    result = gnomon("compare", level, *SIZE, "-t", "SV")
    assert result.exit_code == 6
    page = page_of(tmp_path / "small.compare.html")
    assert "It strikes no surface within its reach" in page.text
    assert len(page.all("section", **{"class": "light"})) == 2


def test_a_light_without_a_shadow_edge_has_advice_and_no_plot(tmp_path: Path) -> None:
    level = small_level(tmp_path, scene=Scene("Bare", (floor(8.0),), (POINT,), (CAMERA,)))
    succeeded("compare", level, *SIZE, "-t", "SV", "-t", "SM")
    page = page_of(tmp_path / "small.compare.html")
    assert not page.all("figure", **{"class": "plot"})
    assert page.text.count("onsider switching") == 2, "in the table at the top and in the light's text"
    assert "exact" not in page.text.partition("How this was measured")[0]
    assert "1 light, drawn with every candidate of SV and SM, timed" in page.text


def test_an_earlier_page_is_replaced_and_nothing_else(level: Path, tmp_path: Path) -> None:
    output = tmp_path / "page.html"
    succeeded("compare", level, *QUICK, "-o", output)
    succeeded("compare", level, *QUICK, "-o", output, "--resolution", "80x64")
    assert "80x64" in page_of(output).text
    output.write_text("<!doctype html>\n<title>Somebody's homepage</title>\n")
    result = gnomon("compare", level, *QUICK, "-o", output)
    assert result.exit_code == 5
    assert "no page of Gnomon" in result.stderr
    assert "homepage" in output.read_text()


@pytest.mark.parametrize(
    ("arguments", "exit_code"),
    [
        (("-o", "missing/page.html"), 5),
        (("-o", "page.pdf"), 5),
        (("-o", "small.glb"), 5),
        (("-o", "."), 5),
        (("--light", "Moon"), 3),
        (("--camera", "Moon"), 3),
        (("--scene", "Moon"), 3),
        (("-t", "magic"), 2),
        (("--rounds", "0"), 2),
        (("--resolution", "1x1"), 2),
        (("--mobility", "sometimes"), 2),
        (("--device", "no such device"), 4),
    ],
)
def test_bad_input_writes_nothing(
    level: Path, monkeypatch: pytest.MonkeyPatch, arguments: tuple[str, ...], exit_code: int
) -> None:
    monkeypatch.chdir(level.parent)
    before = level.read_bytes()
    result = gnomon("compare", level.name, *arguments)
    assert result.exit_code == exit_code, result.stderr
    assert "Traceback" not in result.stderr
    assert files(level.parent) == {"small.glb"}
    assert level.read_bytes() == before


def test_a_page_never_takes_the_place_of_the_level(level: Path) -> None:
    disguised = level.with_name("disguised.html")
    disguised.symlink_to(level)
    before = level.read_bytes()
    result = gnomon("compare", level, *QUICK, "-o", disguised)
    assert result.exit_code == 5
    assert "would overwrite the level" in result.stderr
    assert level.read_bytes() == before


def test_a_level_without_triangles_is_exit_3(tmp_path: Path) -> None:
    level = small_level(tmp_path, scene=Scene("Empty", (), (SPOT,), (CAMERA,)))
    assert gnomon("compare", level).exit_code == 3
    assert files(tmp_path) == {"small.glb"}


def test_ctrl_c_leaves_nothing(level: Path, tmp_path: Path) -> None:
    with running("compare", level, "--rounds", 1000) as process:
        wait_for_line(process, "light 1 of 3")
        process.send_signal(signal.SIGINT)
        stdout, stderr = process.communicate(timeout=60)
    assert process.returncode == 130
    assert stdout == ""
    assert "interrupted: 0 of 3 lights were compared" in stderr
    assert "Traceback" not in stderr
    assert files(tmp_path) == {"small.glb"}
