from __future__ import annotations

from pathlib import Path

import pytest

from scenes.errors import LevelError
from scenes.formats.registry import (
    PlacedFormat,
    annotated_suffix,
    format_of,
    level_formats,
    load_formats,
    read_level,
)

# A format module that does nothing, as text.
NAMED = "NAME = 'USD'\nSUFFIXES = {}\n"
READS = "def read(path, scene_name=None): ...\n"
WRITES = "def annotate(source, annotations): ...\ndef clear(source): ...\ndef companions(source, path): ...\n"
KNOWS = "def read_annotations(source): ...\n"
LAYERED = "def is_layer(source): ...\n"


def test_the_registry_knows_gltf_and_refuses_other_suffixes(tmp_path: Path) -> None:
    assert level_formats()[".glb"] is level_formats()[".gltf"]
    for name in ("level.blend", "level"):
        (tmp_path / name).write_bytes(b"?")
        with pytest.raises(LevelError, match=r"Known are .*\.glb, \.gltf"):
            read_level(tmp_path / name)


@pytest.mark.parametrize(
    ("text", "error"),
    [
        ("import there_is_no_such_module", ModuleNotFoundError),
        ("NAME = 'x'", TypeError),
        (NAMED.format("('.usda',)") + READS, TypeError),
        (NAMED.format("('.usda',)") + WRITES, TypeError),
        (NAMED.format("('.usda',)") + READS + WRITES, TypeError),
        (NAMED.format("('.usda', '.usda')") + READS + WRITES + KNOWS, TypeError),
        (NAMED.format("('.usda',)") + READS + WRITES + KNOWS + "LAYER_SUFFIX = '.usda'\n", TypeError),
        (
            NAMED.format("('.usda',)") + READS + WRITES + KNOWS + "LAYER_SUFFIX = '.usd'\n" + LAYERED,
            TypeError,
        ),
    ],
)
def test_a_broken_format_module_fails_loudly(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, text: str, error: type[Exception]
) -> None:
    folder = tmp_path / f"formats_{abs(hash(text))}"
    folder.mkdir()
    (folder / "__init__.py").write_text("")
    (folder / "broken.py").write_text(text)
    monkeypatch.syspath_prepend(tmp_path)
    with pytest.raises(error):
        load_formats([str(folder)], folder.name)


def test_a_new_module_in_the_folder_is_a_format(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    folder = tmp_path / "formats_of_tomorrow"
    folder.mkdir()
    (folder / "__init__.py").write_text("")
    (folder / "usd.py").write_text(NAMED.format("('.usda',)") + READS + WRITES + KNOWS)
    monkeypatch.syspath_prepend(tmp_path)
    assert [found.NAME for found in load_formats([str(folder)], folder.name).values()] == ["USD"]


def test_a_layered_format_is_told_where_the_level_is(tmp_path: Path) -> None:
    placed = format_of(tmp_path / "yard.usdc")
    assert isinstance(placed, PlacedFormat)
    assert (placed.NAME, placed.LAYER_SUFFIX) == ("USD", ".usda")
    assert annotated_suffix(tmp_path / "yard.usdc") == ".usda"
    assert annotated_suffix(tmp_path / "yard.GLB") == ".GLB"
    assert annotated_suffix(tmp_path / "yard.blend") == ".blend"
    assert not isinstance(format_of(tmp_path / "yard.glb"), PlacedFormat)
    with pytest.raises(LevelError) as caught:
        placed.clear(b"#usda 1.0\n")
    assert str(tmp_path / "yard.usdc") in caught.value.where
