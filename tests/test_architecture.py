"""The rules of CONTRIBUTING.md that a machine can keep. The import rule is import-linter's."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
PACKAGES = ("api", "selector", "renderers", "features", "models", "scenes")
FOLDERS = (*PACKAGES, "tests", "docs", "examples", "plugins", ".ci")
BUILT = {"__pycache__", "node_modules", "out"}
TEXT = {".py", ".glsl", ".md", ".toml", ".json", ".mjs", ".js", ".html", ".css", ".lock", ".cfg", ".gd", ""}
MOST_LINES = 500
NAMELESS = {"util", "utils", "helper", "helpers", "common", "base", "manager", "managers", "misc"}
# In two pieces each, so that this file passes its own test.
MACHINE_PATHS = re.compile("(?<![\\w.])/(" + "|".join(["work", "tm" + "p", "roo" + "t", "hom" + "e"]) + ")/")
LINK = re.compile(r"\]\(([^)#\s]+)[^)]*\)")


def files(*suffixes: str, within: tuple[str, ...] = FOLDERS) -> Iterator[Path]:
    for folder in within:
        for path in sorted((ROOT / folder).rglob("*")):
            if path.is_file() and path.suffix in suffixes and not BUILT & set(path.relative_to(ROOT).parts):
                yield path


def pages() -> list[Path]:
    return [*sorted(ROOT.glob("*.md")), *files(".md")]


def test_no_module_is_longer_than_a_reader_has_patience() -> None:
    lengths = {path: len(path.read_text().splitlines()) for path in files(".py", ".glsl")}
    assert lengths
    assert {path.relative_to(ROOT).as_posix(): n for path, n in lengths.items() if n > MOST_LINES} == {}


def test_every_module_is_named_after_what_it_holds() -> None:
    assert [path for path in files(".py", ".glsl") if {path.stem, path.parent.name} & NAMELESS] == []


def test_packages_export_nothing_by_the_back_door() -> None:
    # Blender looks for an extension's register() in its __init__.py, and nowhere else.
    extension = ROOT / "plugins/blender/extension/__init__.py"
    full = [path for path in files(".py") if path.name == "__init__.py" and path.read_bytes()]
    assert full == [extension]


def test_every_folder_with_modules_is_a_package() -> None:
    folders = {path.parent for path in files(".py", within=PACKAGES)}
    assert [folder for folder in folders if not (folder / "__init__.py").is_file()] == []


def test_one_module_makes_gl_contexts() -> None:
    makers = [
        path.relative_to(ROOT).as_posix()
        for path in files(".py", within=PACKAGES)
        if re.search(r"create_(standalone_)?context", path.read_text())
    ]
    assert makers == ["renderers/context.py"]


@pytest.mark.parametrize("page", pages(), ids=lambda page: page.relative_to(ROOT).as_posix())
def test_links_between_pages_lead_somewhere(page: Path) -> None:
    links = [link for link in LINK.findall(page.read_text()) if "://" not in link]
    assert [link for link in links if not (page.parent / link).exists()] == []


def test_every_page_is_linked_from_another() -> None:
    linked = {
        (page.parent / link).resolve()
        for page in pages()
        for link in LINK.findall(page.read_text())
        if "://" not in link
    }
    assert [page for page in files(".md", within=("docs",)) if page not in linked] == []


def test_no_file_knows_the_machine_it_was_written_on() -> None:
    top = [path for path in ROOT.iterdir() if path.is_file() and path.suffix in TEXT]
    texts = {path: path.read_text() for path in (*top, *files(*TEXT))}
    assert texts
    assert [path for path, text in texts.items() if MACHINE_PATHS.search(text)] == []


def test_locks_name_no_registry() -> None:
    lock = (ROOT / "tests/validator/package-lock.json").read_text()
    assert '"resolved"' not in lock
