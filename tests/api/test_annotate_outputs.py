"""What `gnomon annotate` writes beside the level, and what it must never overwrite or lose."""

from __future__ import annotations

import json
import os
from pathlib import Path
from unittest.mock import Mock

import pytest

from renderers.registry import TECHNIQUES
from scenes.formats.registry import read_level
from scenes.scene import Light, LightKind
from selector.measuring import Bench
from tests.api.command import QUICK, answered, files, gnomon, nodes, succeeded
from tests.small_level import SPOT, named, small_level, small_scene

SIZE = ("--resolution", "96x64", "-o", "p.png")
NOWHERE = Light("Nowhere", LightKind.POINT, position=(0.0, 900.0, 0.0), range_m=1.0)


@pytest.fixture
def level(tmp_path: Path) -> Path:
    return small_level(tmp_path)


@pytest.fixture(autouse=True)
def _few_candidates(monkeypatch: pytest.MonkeyPatch) -> None:
    few = [{"map_size": size, "filter": "2x2", "focus": "light"} for size in (128, 512)]
    for known in TECHNIQUES:
        chosen = {"SM": few, "SV": [{}]}.get(known.label, [])
        monkeypatch.setattr(type(known), "candidates", lambda *_, chosen=chosen: chosen)


@pytest.fixture
def text_level(level: Path) -> Path:
    """A .gltf in a folder of its own, with a buffer beside it and an image outside."""
    source = level.read_bytes()
    length = int.from_bytes(source[12:16], "little")
    document = json.loads(source[20 : 20 + length])
    document["buffers"][0]["uri"] = "small.bin"
    document["images"] = [{"uri": "../wood.png"}]
    folder = level.parent / "level"
    folder.mkdir()
    (level.parent / "wood.png").write_bytes(b"png")
    (folder / "small.bin").write_bytes(source[28 + length :])
    (folder / "small.gltf").write_text(json.dumps(document))
    return folder / "small.gltf"


def test_a_gltf_takes_its_files_along(text_level: Path, tmp_path: Path) -> None:
    folder = tmp_path / "out"
    folder.mkdir()
    result = gnomon("annotate", text_level, *QUICK, "-o", folder / "new.gltf")
    assert result.exit_code == 0, result.stderr
    assert files(folder) == {"new.gltf", "small.bin"}
    assert read_level(folder / "new.gltf").scene.digest == small_scene().digest
    # It lies as deep as the level's own folder, so that the image is found from there too.
    assert "taken along" not in result.stderr


def test_files_that_are_not_taken_along_are_named(text_level: Path, tmp_path: Path) -> None:
    (tmp_path / "far/out").mkdir(parents=True)
    output = tmp_path / "far/out/new.gltf"
    made = succeeded("annotate", text_level, *QUICK, "--light", "Sun", "-o", output, width=200)
    cleared = succeeded("annotate", text_level, "--clear", "-o", output.with_stem("cleared"), width=200)
    for result in (made, cleared):
        assert "warning: " in result.stderr
        assert "which are not taken along: ../wood.png." in result.stderr


def test_other_files_in_the_way_are_found_before_anything_is_measured(
    text_level: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(Bench, "measure", Mock(side_effect=AssertionError("it was measured")))
    folder = tmp_path / "out"
    folder.mkdir()
    (folder / "small.bin").write_bytes(b"somebody's work")
    result = gnomon("annotate", text_level, *QUICK, "-o", folder / "new.gltf", width=200)
    assert result.exit_code == 5
    assert "A different file of this name is there" in result.stderr
    assert "measured" not in result.stderr
    assert files(folder) == {"small.bin"}


@pytest.mark.parametrize("name", ["small.bin", "../wood.png", "small.gltf", "notes.json"])
def test_measurements_overwrite_nothing_but_measurements(
    text_level: Path, name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    (text_level.parent / "notes.json").write_text('{"level": "a", "digest": "b"}')
    monkeypatch.setattr(Bench, "measure", Mock(side_effect=AssertionError("it was measured")))
    path = text_level.parent / name
    before = path.read_bytes()
    result = gnomon("annotate", text_level, *QUICK, "--measurements", path)
    assert result.exit_code == 5
    assert "overwri" in result.stderr
    assert path.read_bytes() == before


def test_earlier_measurements_are_replaced(level: Path, tmp_path: Path) -> None:
    path = tmp_path / "raw.json"
    for light in ("Sun", "Lamp"):
        succeeded("annotate", level, *QUICK, "--light", light, "--measurements", path)
    assert [one["light"]["name"] for one in json.loads(path.read_text())["lights"]] == ["Lamp"]


def test_a_name_that_is_no_utf_8_costs_nothing(level: Path, tmp_path: Path) -> None:
    odd = level.rename(os.fsdecode(os.fsencode(tmp_path) + b"/odd\xff.glb"))
    options = (*QUICK, "--light", "Sun", "--measurements", tmp_path / "raw.json")
    record = answered("annotate", odd, *options)
    assert record["level"].endswith("odd\N{REPLACEMENT CHARACTER}.glb")
    assert json.loads((tmp_path / "raw.json").read_text())["level"] == record["level"]


@pytest.mark.parametrize(
    "place", ["picture_folder.contact_sheet", "picture_folder.mean_flip", "annotating._measurements_file"]
)
def test_a_bug_in_an_extra_costs_no_level(
    level: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, place: str
) -> None:
    monkeypatch.setattr(f"api.{place}", Mock(side_effect=ZeroDivisionError("a bug")))
    extras = ("--pictures", tmp_path / "pictures", "--measurements", tmp_path / "raw.json")
    result = gnomon("annotate", level, *QUICK, *extras, width=200)
    assert result.exit_code == 5
    assert "ZeroDivisionError: a bug" in result.stderr
    assert len(nodes(tmp_path / "small.annotated.glb")) == 3


@pytest.mark.parametrize("option", ["-o", "--measurements"])
def test_pipes_and_circles_of_links_are_found_first(
    level: Path, tmp_path: Path, option: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(Bench, "measure", Mock(side_effect=AssertionError("it was measured")))
    os.mkfifo(tmp_path / "pipe.glb")
    (tmp_path / "circle.glb").symlink_to("circle.glb")
    for name, words in (("pipe.glb", "a device or a pipe"), ("circle.glb", "run in a circle")):
        result = gnomon("annotate", level, *QUICK, option, tmp_path / name, width=300)
        assert result.exit_code == 5
        assert words in result.stderr


def test_a_name_forges_no_message(tmp_path: Path) -> None:
    level = small_level(tmp_path, scene=small_scene((named(SPOT, "a\nerror: fake\u202e"), NOWHERE)))
    for command in (("annotate", level, *QUICK), ("inspect", level), ("annotate", level, "--light", "x")):
        result = gnomon(*command, width=300)
        lines = (result.stdout + result.stderr).splitlines()
        assert not any(line.startswith("error: fake") for line in lines)
        assert "a\\x0aerror: fake\\u202e" in result.stdout + result.stderr
    assert gnomon("inspect", level, "--json").stdout.isascii()


@pytest.mark.parametrize(
    ("arguments", "code"),
    [
        (("--light", "9" * 5000), 3),
        (("--light", "node:" + "9" * 5000), 3),
        (("--device", "9" * 5000), 2),
        (("--device", ""), 2),
        (("--resolution", "4097x64"), 2),
    ],
    ids=["light", "node", "device", "no device", "resolution"],
)
def test_absurd_values_are_refused_in_few_words(level: Path, arguments: tuple[str, ...], code: int) -> None:
    result = gnomon("annotate", level, *arguments)
    assert result.exit_code == code
    assert "bug" not in result.stderr
    assert len(result.stderr) < 1000
