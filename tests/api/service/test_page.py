"""The page's files, read as text: they hold together, and need nothing from anywhere else."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from api.service.application import create_app
from api.service.routes_page import MEDIA_TYPES
from api.service.settings import Settings

ROOT = Path(__file__).parents[3]
PAGE = ROOT / "api" / "service" / "page"
INDEX = (PAGE / "index.html").read_text()
SCRIPTS = {path.name: path.read_text() for path in PAGE.glob("*.js")}
SHEETS = {path.name: path.read_text() for path in PAGE.glob("*.css")}
NAMESPACE = "http://www.w3.org/2000/svg"


def own_ids() -> set[str]:
    return set(re.findall(r'\bid="([\w-]+)"', INDEX))


def made_ids() -> set[str]:
    return {one for script in SCRIPTS.values() for one in re.findall(r'\bid: "([\w-]+)"', script)}


def test_every_file_is_one_that_the_service_hands_out() -> None:
    assert {path.suffix for path in PAGE.iterdir()} <= set(MEDIA_TYPES)


@pytest.mark.parametrize("name", [path.name for path in PAGE.iterdir() if path.suffix != ".glb"])
def test_no_file_names_another_place(name: str) -> None:
    text = (PAGE / name).read_text().replace(NAMESPACE, "")
    assert not re.search(r"https?:|[\"'(]//|@import|\burl\(", text)


def test_the_markup_has_no_script_style_or_handler_of_its_own() -> None:
    assert re.findall(r"<script[^>]*>", INDEX) == ['<script type="module" src="/page/page.js">']
    assert not re.search(r"<style|\sstyle=|\son\w+=", INDEX)


def test_the_scripts_set_no_markup_from_text() -> None:
    for script in SCRIPTS.values():
        assert not re.search(
            r"innerHTML|outerHTML|insertAdjacentHTML|document\.write|\beval\b|new Function", script
        )
        assert not re.search(r"[{,]\s*style:|setAttribute\(\"style\"", script)


def test_every_file_that_is_named_is_there_and_every_file_is_named() -> None:
    texts = (INDEX, *SCRIPTS.values())
    named = {one for text in texts for one in re.findall(r'["(]/page/([\w.]+)["?]', text)}
    named |= {one for script in SCRIPTS.values() for one in re.findall(r'from "\./([\w.]+)"', script)}
    assert named == {path.name for path in PAGE.iterdir()} - {"index.html"}


def test_what_a_script_takes_from_another_is_there() -> None:
    for script in SCRIPTS.values():
        for names, other in re.findall(r'import \{([^}]+)\} from "\./([\w.]+)"', script):
            exported = re.findall(r"export (?:async )?(?:function|const|class) (\w+)", SCRIPTS[other])
            assert {name.split()[0] for name in names.split(",")} <= set(exported)


def test_every_id_is_there_once_and_what_the_scripts_ask_for_exists() -> None:
    ids = re.findall(r'\bid="([\w-]+)"', INDEX)
    assert len(ids) == len(set(ids))
    asked = {one for script in SCRIPTS.values() for one in re.findall(r'\bat\("([\w-]+)"\)', script)}
    assert asked <= own_ids() | made_ids()
    references = re.findall(r'(?:aria-labelledby|for|href)="#?([\w-]+)"', INDEX)
    assert set(references) <= own_ids()


def test_every_class_of_the_markup_is_styled() -> None:
    sheets = " ".join(SHEETS.values())
    used = {name for names in re.findall(r'class="([^"]+)"', INDEX) for name in names.split()}
    assert {name for name in used if f".{name}" not in sheets} <= {"drop-name", "drop-more", "service"}


def test_every_path_that_is_asked_for_is_in_the_openapi(tmp_path: Path) -> None:
    known = set(create_app(Settings(state=tmp_path)).openapi()["paths"])
    called = {
        re.sub(r"\$\{[^}]+\}", "{job_id}", one)
        for script in SCRIPTS.values()
        for one in re.findall(r'["`](/(?:v1|healthz|readyz)[^"`?]*)["`]', script)
    }
    assert "/v1/jobs/{job_id}/events" in called
    assert called <= known


def test_the_example_is_the_repositorys_own() -> None:
    same = (PAGE / "street.glb").read_bytes() == (ROOT / "examples" / "street.glb").read_bytes()
    assert same, "copy examples/street.glb to api/service/page/"
