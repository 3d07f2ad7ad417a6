from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

import scenes.level_output
from scenes.atomic_file import write_atomically
from scenes.errors import GnomonError, LevelError, OutputError
from scenes.formats.registry import format_of
from scenes.level_output import luggage, write_level
from scenes.light_annotation import LightAnnotation
from tests.scenes.gltf_samples import CORNERS, TETRAHEDRON, read, tetrahedron

FILES = {
    "mesh #1.bin": CORNERS.tobytes(),
    "parts/far/indices.bin": TETRAHEDRON.tobytes(),
    "parts/wood.png": b"png",
    "empty.jpg": b"",
}


@pytest.fixture
def level(tmp_path: Path) -> Path:
    """A .gltf with two buffers and images beside it, and things that it must not take along."""
    folder = tmp_path / "in"
    folder.mkdir()
    for name, content in {**FILES, "not named.bin": b"?"}.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_bytes(content)
    (tmp_path / "outside.png").write_bytes(b"png")
    made = tetrahedron()
    made["buffers"][0]["uri"] = "mesh%20%231.bin"
    made["buffers"][1]["uri"] = "./parts/../parts/far/indices.bin"
    made["images"] = [
        {"uri": "parts/wood.png"},
        {"uri": "parts/wood.png"},
        {"uri": "empty.jpg"},
        {"uri": "missing.png"},
        {"uri": "../outside.png"},
        {"uri": str(tmp_path / "outside.png")},
        {"uri": "https://example.com/wood.png"},
        {"uri": "data:image/png;base64,AAAA"},
        {"uri": "parts"},
        {"uri": "a%00b.png"},
        {"uri": "x" * 300},
        {"bufferView": 0},
    ]
    return read(folder, made).path


def written(level: Path, target: Path, data: bytes | None = None) -> tuple[Path, ...]:
    return write_level(level, target, level.read_bytes() if data is None else data, format_of(level))


def files_in(folder: Path) -> dict[str, bytes]:
    """Every file, link and empty folder below a folder, with its content."""
    return {
        str(path.relative_to(folder)): path.read_bytes() if path.is_file() else b""
        for path in folder.rglob("*")
        if not path.is_dir() or not any(path.iterdir())
    }


def test_a_level_takes_the_files_it_names_along(level: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    out.mkdir()
    data = format_of(level).annotate(level.read_bytes(), {0: LightAnnotation({"gnomon_technique": "SM"}, {})})
    made = written(level, out / "annotated.gltf", data)
    assert files_in(out) == {**FILES, "annotated.gltf": data}
    assert made == (*(out / name for name in sorted(FILES)), out / "annotated.gltf")
    before, after = format_of(level).read(level), format_of(level).read(out / "annotated.gltf")
    assert after.scene.digest == before.scene.digest


@pytest.mark.parametrize("target", ["level.gltf", "other.gltf", "../in/other.gltf"])
def test_beside_the_original_only_the_level_is_written(level: Path, target: str) -> None:
    before = files_in(level.parent)
    data = level.read_bytes() + b"\n"
    assert written(level, level.parent / target, data) == (level.parent / target,)
    assert files_in(level.parent) == {**before, Path(target).name: data}


def test_a_glb_goes_alone_even_where_it_names_files(level: Path, tmp_path: Path) -> None:
    text = level.read_bytes()
    text += b" " * (-len(text) % 4)
    head = b"glTF" + b"".join(n.to_bytes(4, "little") for n in (2, 20 + len(text), len(text)))
    glb = level.with_suffix(".glb")
    glb.write_bytes(head + b"JSON" + text)
    (tmp_path / "out").mkdir()
    assert written(glb, tmp_path / "out/level.glb") == (tmp_path / "out/level.glb",)
    assert list(files_in(tmp_path / "out")) == ["level.glb"]


def test_what_is_there_already_with_the_same_content_is_left_alone(level: Path, tmp_path: Path) -> None:
    out = tmp_path / "out"
    out.mkdir()
    written(level, out / "level.gltf")
    stamps = {name: (out / name).stat().st_ino for name in FILES}
    (out / "parts/wood.png").unlink()
    assert written(level, out / "level.gltf") == (out / "parts/wood.png", out / "level.gltf")
    assert {name: (out / name).stat().st_ino for name in FILES if name != "parts/wood.png"}.items() < (
        stamps.items()
    )


def different_file(out: Path) -> None:
    (out / "parts").mkdir()
    (out / "parts/wood.png").write_bytes(b"PNG")


def longer_file(out: Path) -> None:
    (out / "empty.jpg").write_bytes(b"mine")


def folder_of_that_name(out: Path) -> None:
    (out / "empty.jpg").mkdir()


def link_to_nowhere(out: Path) -> None:
    (out / "empty.jpg").symlink_to("nowhere")


def file_in_place_of_a_folder(out: Path) -> None:
    (out / "parts").write_bytes(b"mine")


@pytest.mark.parametrize(
    ("prepare", "said"),
    [
        (different_file, "different file of this name"),
        (longer_file, "different file of this name"),
        (folder_of_that_name, "different file of this name"),
        (link_to_nowhere, "different file of this name"),
        (file_in_place_of_a_folder, "needs a folder of this name"),
    ],
)
def test_nothing_of_the_users_is_overwritten(level: Path, tmp_path: Path, prepare: Any, said: str) -> None:
    out = tmp_path / "out"
    out.mkdir()
    prepare(out)
    before = files_in(out)
    for do in (luggage, write_level):
        with pytest.raises(OutputError) as caught:
            do(level, out / "level.gltf", level.read_bytes(), format_of(level))
        assert said in str(caught.value)
        assert str(out) in caught.value.where
        assert caught.value.remedy
        assert files_in(out) == before


@pytest.mark.parametrize(
    ("target", "left_behind"),
    [
        ("in/other.gltf", []),
        ("out/level.gltf", []),
        ("out/deep/level.gltf", ["../outside.png"]),
        ("level.gltf", ["../outside.png"]),
    ],
)
def test_files_outside_the_folder_are_named_where_they_are_not_found(
    level: Path, tmp_path: Path, target: str, left_behind: list[str]
) -> None:
    found = luggage(level, tmp_path / target, level.read_bytes(), format_of(level))
    assert list(map(str, found.left_behind)) == left_behind
    assert {str(name) for name in found.missing} == (set() if target.startswith("in/") else set(FILES))


@pytest.mark.parametrize("failing", range(len(FILES) + 1))
def test_a_failure_leaves_nothing_behind(
    level: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, failing: int
) -> None:
    out = tmp_path / "out"
    out.mkdir()
    (out / "level.gltf").write_bytes(b"an earlier one")
    calls = iter(range(len(FILES) + 1))

    def full_disk(path: Path, data: bytes) -> None:
        if next(calls) == failing:
            raise OutputError("The disk is full.", where=str(path))
        write_atomically(path, data)

    monkeypatch.setattr(scenes.level_output, "write_atomically", full_disk)
    with pytest.raises(OutputError, match="disk is full"):
        written(level, out / "level.gltf")
    assert files_in(out) == {"level.gltf": b"an earlier one"}


def test_the_folder_itself_is_not_made(level: Path, tmp_path: Path) -> None:
    with pytest.raises(OutputError, match="folder does not exist"):
        written(level, tmp_path / "nowhere/level.gltf")
    assert not (tmp_path / "nowhere").exists()


@pytest.mark.parametrize("name", ["in/mesh #1.bin", "out/empty.jpg"])
def test_a_level_does_not_overwrite_its_own_files(level: Path, tmp_path: Path, name: str) -> None:
    (tmp_path / "out").mkdir()
    before = files_in(tmp_path)
    with pytest.raises(OutputError, match="overwrite a file that it names itself"):
        written(level, tmp_path / name)
    assert files_in(tmp_path) == before


def test_a_file_that_vanishes_before_it_is_copied(
    level: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    out = tmp_path / "out"
    out.mkdir()
    named = format_of(level).companions(level.read_bytes(), level)
    monkeypatch.setattr(format_of(level), "companions", lambda _source, _path: named)
    (level.parent / "parts/wood.png").unlink()
    with pytest.raises(LevelError, match="cannot be read") as caught:
        written(level, out / "level.gltf")
    assert caught.value.where == str(level.parent / "parts/wood.png")
    assert files_in(out) == {}


@pytest.mark.parametrize(
    "tables",
    [{"buffers": 5}, {"images": {}}, {"asset": {"version": "1.0"}}],
    ids=["buffers", "images", "version"],
)
def test_a_broken_level_is_refused(level: Path, tables: Any) -> None:
    broken = json.dumps({**json.loads(level.read_bytes()), **tables}).encode()
    with pytest.raises(GnomonError):
        written(level, level.parent / "other.gltf", broken)
    assert not (level.parent / "other.gltf").exists()


def test_odd_entries_name_nothing(level: Path) -> None:
    odd = {
        **json.loads(level.read_bytes()),
        "buffers": [7, {"uri": 7}, None],
        "images": [{"uri": "empty.jpg"}],
    }
    assert format_of(level).companions(json.dumps(odd).encode(), level) == (Path("empty.jpg"),)
